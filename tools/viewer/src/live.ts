// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Follows a running session: one stream of events, and the changes that they announce.
import { EventLine } from "./events";
import { ImageFact, ServerError, ServerSource, Session } from "./source";
import type { Viewer } from "./viewer";

const UNKNOWN_MS = 1000, SEEN_MS = 5000, QUIET_MS = 3000;

export class Live {
  private readonly line: EventLine;
  private busy = false;
  private again = false;
  private wanted = 0; // number of the last change that was announced
  private listIsOld = false;
  private fetched = 0; // when everything but the model was fetched last [ms]
  private timer = 0;

  constructor(private readonly viewer: Viewer, private readonly source: ServerSource) {
    const { session } = viewer;
    const on = <T>(act: (data: T) => void) => (data: string): void => act(JSON.parse(data) as T);
    this.line = new EventLine(`${source.base}/events`, `${source.base}/session`, {
      hello: () => void this.all(), // also when the page was hidden for a while
      reset: () => void this.all(),
      image: on<ImageFact>((image) => this.image(image)),
      version: on<Session["counts"] & Pick<Session, "weak_models"> & { change: number }>((version) => {
        viewer.session.counts = version;
        viewer.session.weak_models = version.weak_models;
        this.wanted = version.change;
        viewer.tell();
        void this.catchUp().then(() => this.later());
      }),
      event: on<Session["events"][0]>((event) => { viewer.session.events.push(event); viewer.tell(); }),
      hint: on<Session["hints"]>((hints) => { viewer.session.hints = hints; viewer.tell(); }),
    }, (state) => {
      viewer.say(state === "there" ? "" : state === "gone" ? "the server does not answer; trying again"
        : session.me ? "this link has been taken back or has run out; ask for a new one" : "the server wants a link now; ask for one");
      if (state === "there") void this.all();
    });
  }
  start(): void { this.line.open(); }
  get isThere(): boolean { return this.line.state === "there"; }
  /** @return whether a request failed for want of an answer, or of a link: that is told once it is known which */
  failed(error: Error): boolean {
    const isLine = error instanceof ServerError && (error.status === 0 || error.status === 401);
    if (isLine && error.status === 401) this.line.refuse(); else if (isLine) void this.line.ask();
    return isLine;
  }

  private image(image: ImageFact): void {
    const list = this.viewer.session.image_list;
    const at = image.id !== undefined ? list.findIndex((known) => known.id === image.id) : list.findIndex((known) => known.name === image.name);
    if (at >= 0) list[at] = image;
    else {
      // Accepted ones stand before the rejected, by number.
      const before = image.id === undefined ? -1 : list.findIndex((known) => known.id === undefined || known.id > image.id!);
      if (before < 0) list.push(image); else list.splice(before, 0, image);
    }
    if (this.listIsOld) return;
    this.listIsOld = true;
    setTimeout(() => { this.listIsOld = false; this.viewer.list.update(list); }, 50); // many come at once
  }
  /** What events do not tell (edges, cameras, the direction up) is fetched once nothing comes; sooner where it is seen. */
  private later(): void {
    const { model, stage } = this.viewer, age = performance.now() - this.fetched;
    const isUnknown = [...model.clusters.values()].some((c) => [...c.poses.values()].some((pose) => !stage.cameras.has(pose.camera)));
    clearTimeout(this.timer);
    if ((isUnknown && age > UNKNOWN_MS) || (stage.showEdges && age > SEEN_MS)) void this.all();
    else this.timer = window.setTimeout(() => void this.all(), isUnknown ? UNKNOWN_MS : QUIET_MS);
  }
  /** Everything anew: states, edges and cameras; the model by its changes, where these are kept. */
  private async all(): Promise<void> {
    this.fetched = performance.now();
    try {
      const session = await this.source.session();
      this.viewer.session = session;
      this.viewer.list.update(session.image_list);
      this.viewer.stage.setFrame(session.cameras, session.up, session.in_metres);
      this.viewer.stage.setEdges(session.edges);
      this.viewer.details.refresh();
      this.viewer.tell();
      this.wanted = Infinity;
      this.viewer.say("");
      this.viewer.stage.frusta.tryAgain();
      await this.catchUp();
    } catch (error) {
      if (!this.failed(error as Error)) this.viewer.say((error as Error).message);
    }
  }
  /** One at a time; what comes meanwhile is taken along by the next. */
  private async catchUp(): Promise<void> {
    if (this.busy) { this.again = true; return; }
    this.busy = true;
    try {
      do {
        this.again = false;
        if (this.wanted > this.viewer.model.number) await this.once();
      } while (this.again);
    } catch (error) {
      if (!this.failed(error as Error)) this.viewer.say((error as Error).message);
    } finally {
      this.busy = false;
    }
  }
  private async once(): Promise<void> {
    const { model, stage } = this.viewer;
    const changes = await this.source.changes(model.number), wasEmpty = model.clusters.size === 0;
    if (changes === null) {
      model.clusters.clear();
      model.apply(await this.source.scene());
    } else {
      for (const change of changes) model.apply(change);
    }
    this.wanted = Math.min(this.wanted, model.number);
    if (changes?.length === 0) return;
    stage.follow();
    if (wasEmpty && model.clusters.size > 0) stage.fit();
    this.viewer.timeline.forget();
  }
}
