// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// How many of the points a frame draws: all, or as many as it has time for.

const FIRST_POINTS = 50000; // of the first picture: the others follow it
const MOVING_MS = 26; // of a frame while one moves; the browser needs some for the rest of it
const CHANGING_MS = 100; // the same while changes come, some twice a second
const MOVED_MS = 250, CHANGED_MS = 5000; // so long after the last time it is over
const LEAST_POINTS = 4000; // so many show the shape of a model of any size

export class DetailLevel {
  private moved = 0; // until when [ms]
  private changed = 0;
  private points = 0;
  share = 0; // of the points; 0: none ever was drawn

  get isMoving(): boolean { return performance.now() < this.moved; }
  move(): void { this.moved = performance.now() + MOVED_MS; }
  change(): void { this.changed = performance.now() + CHANGED_MS; }

  /** Before a frame of a model of so many points. @return how long it may take [ms] */
  begin(points: number): number {
    const now = performance.now(), budget = now < this.moved ? MOVING_MS : now < this.changed ? CHANGING_MS : Infinity;
    this.points = points;
    if (this.share === 0 && points > 0) this.share = Math.min(1, FIRST_POINTS / points);
    else if (budget === Infinity) this.share = Math.min(1, this.share * 2);
    return budget;
  }
  /** After it. @return when another one is to follow, that draws what this one has left out [ms]; null: none */
  end(budget: number, took: number): number | null {
    if (this.share === 0) return null;
    if (budget === Infinity) return this.share < 1 ? 0 : null;
    const fits = Math.min(1.5, Math.max(0.3, budget / Math.max(took, 1)));
    this.share = Math.min(1, Math.max(LEAST_POINTS / this.points, this.share * fits));
    return Math.max(0, Math.max(this.moved, this.changed) - performance.now()) + 10;
  }
}
