// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The session version by version: points appear when two photographs have seen them, cameras stand where they stood.
import { button, el } from "./dom";
import { Replay, Source } from "./source";
import { Stage } from "./stage";

const STEP_MS = 120;

export class Timeline {
  readonly element = el("div", { class: "timeline", role: "group", "aria-label": "Time line" });
  private readonly slider = el("input", { type: "range", min: "0", "aria-label": "Version" });
  private readonly text = el("output", {});
  private readonly play: HTMLButtonElement;
  private replay: Replay | null = null;
  private timer = 0;

  constructor(private readonly source: Source, private readonly stage: Stage) {
    this.play = button("Play", () => void this.toggle());
    this.slider.addEventListener("input", () => void this.slide());
    this.element.append(this.play, this.slider, this.text, button("Now", () => this.now()));
    this.text.textContent = "now";
    this.slider.max = "1000"; // until the versions are known, only the share counts
    this.slider.value = "1000";
  }
  private async load(): Promise<Replay> {
    if (this.replay) return this.replay;
    this.replay = await this.source.replay();
    this.slider.max = String(Math.max(0, this.replay.versions.length - 1));
    this.slider.value = this.slider.max;
    return this.replay;
  }
  private async slide(): Promise<void> {
    const share = Number(this.slider.value) / Math.max(1, Number(this.slider.max));
    this.stop();
    try {
      const replay = await this.load();
      await this.go(Math.round(share * (replay.versions.length - 1)));
    } catch (error) {
      this.text.textContent = `no replay: ${(error as Error).message}`;
    }
  }
  /** Versions have come: they are fetched when one asks. */
  forget(): void { if (this.stage.time === null) this.replay = null; }
  async go(version: number): Promise<void> {
    const replay = await this.load();
    if (replay.versions.length === 0) { this.text.textContent = "no version is kept (--history none)"; return; }
    const at = Math.min(version, replay.versions.length - 1);
    const poses = replay.at(at);
    this.stage.setReplay(replay.versions[at].images, poses, replay.placedAt);
    this.slider.value = String(at);
    this.text.textContent = `after ${replay.versions[at].images} photographs: ${poses.size} placed`;
  }
  private now(): void {
    this.stop();
    this.stage.setReplay(null, null);
    this.slider.value = this.slider.max;
    this.text.textContent = "now";
  }
  private stop(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.play.textContent = "Play";
  }
  private async toggle(): Promise<void> {
    if (this.timer) { this.stop(); return; }
    const replay = await this.load().catch((error: Error) => { this.text.textContent = `no replay: ${error.message}`; return null; });
    if (!replay) return;
    let at = Number(this.slider.value);
    if (at >= replay.versions.length - 1) at = -1;
    this.play.textContent = "Pause";
    this.timer = window.setInterval(() => {
      if (++at >= replay.versions.length) { this.now(); return; }
      void this.go(at);
    }, STEP_MS);
  }
}
