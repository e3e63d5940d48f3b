// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The viewer's page, put together.
import { Details } from "./details";
import { button, el, select, toggle } from "./dom";
import { ImageList, titleOf } from "./list";
import { ColourMode, LEGENDS } from "./points";
import { Camera, FileSource, ImageFact, ServerError, ServerSource, Session, Source } from "./source";
import { Stage, rendererOf } from "./stage";
import { Timeline } from "./timeline";
import { Live } from "./live";
import { NO_LINK, signIn } from "./login";
import { Model, worldPoses } from "./wire";

export class Viewer {
  readonly model = new Model();
  session!: Session;
  stage!: Stage;
  list!: ImageList;
  details!: Details;
  timeline!: Timeline;
  selected: number[] = [];
  private readonly events = el("ol", { class: "events" });
  private readonly hints = el("ul", { class: "hints" });
  private readonly summary = el("p", { class: "summary", role: "status" });
  private readonly notice = el("p", { class: "notice", role: "status" });
  private live: Live | null = null;
  private readonly weak = el("ul", { class: "weak", tabindex: "0", "aria-label": "Models that are weak" });
  private readonly tip = el("div", { class: "tip", hidden: "" });
  private tabs: [HTMLButtonElement, HTMLElement][] = [];

  constructor(readonly source: Source, private readonly root: HTMLElement) {}

  async start(): Promise<void> {
    const coming = Promise.all([this.source.session(), this.source.scene()]);
    const canvas = el("canvas", { class: "stage", tabindex: "0", role: "application", "aria-label": "The model. Drag to turn, right drag to shift, wheel to zoom, F to see all, arrow keys to turn." });
    const renderer = rendererOf(canvas);
    const [session, scene] = await coming;
    this.session = session;
    if (scene.length > 0) this.model.apply(scene);
    this.details = new Details(this.source, (image) => this.factOf(image), () => this.session.edges, (image) => this.cameraOf(image));
    this.list = new ImageList(session.image_list, (fact, how) => this.choose(fact, how));
    const side = this.side(), tools = this.tools();
    this.root.replaceChildren(el("main", { class: "stagebox" }, canvas, this.tip, tools), side);
    this.stage = new Stage(canvas, renderer, this.model, new Map(session.cameras.map((c) => [c.id, c])), session.edges, session.up,
      (image) => this.factOf(image)?.user ?? 0, session.in_metres);
    this.timeline = new Timeline(this.source, this.stage);
    this.root.firstElementChild!.append(this.timeline.element);
    const bar = this.timeline.element;
    this.stage.bars = () => [tools.offsetTop + tools.offsetHeight, canvas.clientHeight - bar.offsetTop];
    this.stage.frusta.thumbnail = (image) => this.live?.isThere === false ? null : this.source.thumbnail(image);
    this.stage.frusta.showPictures = this.source.live;
    this.details.onChoose = (image) => this.chooseImage(image);
    this.details.onPair = (a, b) => this.pair(a, b);
    this.stage.refresh();
    this.stage.fit();
    this.tell();
    this.listen(canvas);
    if (!(this.source instanceof ServerSource)) return;
    this.live = new Live(this, this.source);
    this.live.start();
    const maySend = session.me !== undefined && session.me.role !== "look";
    if (maySend) side.querySelector("h1")!.after(el("a", { class: "send", href: "/capture" }, "Send photographs"));
  }
  /** By its number, which is mostly where it stands in the list. */
  factOf(image: number): ImageFact | undefined {
    const list = this.session.image_list;
    return list[image]?.id === image ? list[image] : list.find((fact) => fact.id === image);
  }

  private cameraOf(image: number): Camera | undefined {
    const pose = worldPoses(this.model).find((p) => p.image === image);
    return this.session.cameras.find((c) => c.id === pose?.camera) ?? this.session.cameras[0];
  }

  private tools(): HTMLElement {
    const box = el("div", { class: "tools" }), legend = el("output", { class: "quiet" });
    box.append(select("Colour", [["colour", "photographs"], ["error", "error"], ["track", "track length"], ["cluster", "cluster"], ["user", "user"]],
      (mode) => { this.stage.mode = mode as ColourMode; legend.textContent = LEGENDS[this.stage.mode]; this.stage.draw(); }), legend,
      toggle("cameras", true, (on) => this.stage.setLayers(on, this.stage.showEdges)),
      toggle("view graph", false, (on) => this.stage.setLayers(this.stage.showCameras, on)),
      this.source.live ? toggle("pictures", true, (on) => { this.stage.frusta.showPictures = on; this.stage.draw(); }) : "",
      button("Larger", () => this.size(1.4)), button("Smaller", () => this.size(1 / 1.4)), button("Fit", () => this.stage.fit()));
    return box;
  }
  private size(factor: number): void {
    this.stage.pointSize = Math.min(12, Math.max(1, this.stage.sizeOfPoints() * factor));
    this.stage.draw();
  }

  private side(): HTMLElement {
    const about = el("section", { class: "panel", "aria-label": "About" }, el("h2", {}, "About"),
      el("p", {}, "Points: one drag turns, two fingers or the right button shift, the wheel or a pinch zooms. F sees all, Escape lets go."),
      el("p", {}, "Photographs: a click, a tap or Enter in the list, or a click at a camera's tip, shows one with its features. Below them are those that it matches: each opens the two with their matches. So does a click with Ctrl, Cmd or Shift at a second camera, or at a second row of the list."),
      ...(this.source.live ? [el("p", {}, "Pictures: cameras that are near or chosen hold their photographs.")] : []),
      el("p", {}, "View graph: blue pairs hold, grey ones are open, orange ones were set aside as weak, violet ones are look-alikes kept apart, red ones contradict the model."),
      el("h2", {}, "Licence of three.js, which draws the model"), el("pre", {}, this.session.licence));
    const panels: [string, HTMLElement][] = [["Photographs", this.list.element], ["Details", this.details.element],
      ["Events", el("section", { class: "panel", "aria-label": "Events" }, this.hints, this.events)], ["About", about]];
    const bar = el("div", { class: "tabs", role: "tablist" });
    this.tabs = panels.map(([name, panel]) => {
      panel.id = `panel-${name.toLowerCase()}`;
      panel.setAttribute("role", "tabpanel");
      const tab = button(name, () => this.show(name), { role: "tab", "aria-controls": panel.id });
      bar.append(tab);
      return [tab, panel];
    });
    const side = el("aside", { class: "side" }, el("h1", {}, this.session.name), this.notice, this.summary, this.weak, bar, ...panels.map(([, panel]) => panel));
    this.show("Photographs");
    return side;
  }
  show(name: string): void {
    for (const [tab, panel] of this.tabs) {
      const on = tab.textContent === name;
      tab.setAttribute("aria-selected", String(on));
      panel.hidden = !on;
    }
  }

  /** Counts, weak models, events and hints in words. */
  tell(): void {
    const c = this.session.counts;
    this.summary.textContent = `${c.placed} of ${c.images} photographs placed, ${c.waiting} waiting, ${c.rejected} rejected; ` +
      `${c.effective_clusters} ${c.effective_clusters === 1 ? "part" : "parts"}, version ${c.version}`;
    this.weak.replaceChildren(...this.session.weak_models.flatMap((model) => model.words).map((line) => el("li", {}, line)));
    this.weak.hidden = this.session.weak_models.length === 0;
    this.events.replaceChildren(...this.session.events.slice(-200).reverse().map((e) => el("li", {}, el("b", {}, e.event), ` at photograph ${e.image}: ${e.text}`)));
    if (this.session.events.length === 0) this.events.replaceChildren(el("li", { class: "quiet" }, "Parts that join, split or are made anew are told here. So far there were none."));
    this.hints.replaceChildren(...this.session.hints.map((h) => el("li", {}, button(h.text, () => this.chooseImage(h.image), { class: "link" }))));
  }

  chooseImage(image: number): void {
    const fact = this.factOf(image);
    if (fact) this.choose(fact);
  }
  choose(fact: ImageFact, how: "open" | "pair" | "stay" = "open"): void {
    if (how === "pair" && fact.id !== undefined && this.selected.length > 0 && this.selected[0] !== fact.id) { this.pair(this.selected[0], fact.id); return; }
    this.selected = fact.id === undefined ? [] : [fact.id];
    this.list.mark(fact.id ?? null);
    this.stage.mark(null);
    this.stage.select(this.selected);
    if (fact.state === "placed" && fact.id !== undefined) this.stage.fit([fact.id]);
    if (how !== "stay") this.show("Details");
    void this.details.image(fact).catch((error: Error) => this.fail(error));
  }
  /** Two photographs with their matches; the first stays chosen. */
  pair(first: number, second: number): void {
    this.selected = [first, second];
    this.list.mark(first);
    this.stage.mark(null);
    this.stage.select(this.selected);
    this.show("Details");
    void this.details.pair(Math.min(first, second), Math.max(first, second)).catch((error: Error) => this.fail(error));
  }
  private clicked(x: number, y: number, second: boolean): void {
    const image = this.stage.pickCamera(x, y);
    if (image !== null && second && this.selected.length > 0 && this.selected[0] !== image) { this.pair(this.selected[0], image); return; }
    if (image !== null) { this.chooseImage(image); return; }
    const point = this.stage.pickPoint(x, y);
    if (!point) { this.let(); return; }
    this.stage.mark(point.position, this.model.clusters.get(point.cluster)?.part ?? 0);
    this.show("Details");
    void this.source.seenBy(point.cluster, point.slot).then((images) => { this.selected = images; this.stage.select(images); }, () => {}); // the details say why not
    void this.details.point(point).catch((error: Error) => this.fail(error));
  }
  private let(): void {
    this.selected = [];
    this.stage.select([]);
    this.stage.mark(null);
    this.list.mark(null);
  }
  /** A line that stays until it is another; none: all is well. */
  say(words: string): void { if (this.notice.textContent !== words) this.notice.textContent = words; }
  /** What the details do not show they say themselves; that nothing answers is for the stream of events to see. */
  fail(error: Error): void { this.live?.failed(error); }

  private listen(canvas: HTMLCanvasElement): void {
    let down: { x: number; y: number } | null = null;
    canvas.addEventListener("pointerdown", (e) => { down = { x: e.offsetX, y: e.offsetY }; });
    canvas.addEventListener("pointerup", (e) => {
      if (down && Math.hypot(e.offsetX - down.x, e.offsetY - down.y) < 5) this.clicked(e.offsetX, e.offsetY, e.ctrlKey || e.metaKey || e.shiftKey);
      down = null;
    });
    canvas.addEventListener("pointermove", (e) => {
      if (e.buttons !== 0) { this.tip.hidden = true; return; }
      const image = this.stage.pickCamera(e.offsetX, e.offsetY);
      this.hover(image, e.offsetX, e.offsetY);
    });
    canvas.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    canvas.addEventListener("keydown", (e) => this.key(e));
  }
  private hover(image: number | null, x: number, y: number): void {
    this.tip.hidden = image === null;
    if (image === null) return;
    const fact = this.factOf(image), thumbnail = this.source.thumbnail(image);
    this.tip.replaceChildren(fact ? titleOf(fact) : String(image));
    if (thumbnail) this.tip.append(el("img", { src: thumbnail, alt: "" }));
    const room = this.tip.parentElement!, w = this.tip.offsetWidth + 14, h = Math.max(this.tip.offsetHeight, thumbnail ? 140 : 0) + 14;
    this.tip.style.left = `${x + w > room.clientWidth ? Math.max(0, x - w) : x + 14}px`;
    this.tip.style.top = `${y + h > room.clientHeight ? Math.max(0, y - h) : y + 14}px`;
  }
  private key(e: KeyboardEvent): void {
    const turn = (dx: number, dy: number): void => { this.stage.turn(dx, dy); e.preventDefault(); };
    if (e.key === "f" || e.key === "F") this.stage.fit();
    else if (e.key === "Escape") this.let();
    else if (e.key === "+" || e.key === "=") this.stage.zoom(0.8);
    else if (e.key === "-") this.stage.zoom(1.25);
    else if (e.key === "ArrowLeft") turn(-0.1, 0);
    else if (e.key === "ArrowRight") turn(0.1, 0);
    else if (e.key === "ArrowUp") turn(0, -0.1);
    else if (e.key === "ArrowDown") turn(0, 0.1);
  }
}

async function main(): Promise<void> {
  const root = document.getElementById("app")!;
  const source = document.getElementById("scene") ? new FileSource() : new ServerSource();
  const viewer = new Viewer(source, root);
  (window as unknown as { psfm: Viewer }).psfm = viewer; // for tests, and for who is curious
  try {
    if (source.live) {
      window.addEventListener("hashchange", () => { if (location.hash) location.reload(); }); // another link, opened in this page
      await signIn();
    }
    await viewer.start();
    document.documentElement.dataset.state = "ready";
  } catch (error) {
    const wantsLink = error instanceof ServerError && error.status === 401;
    root.replaceChildren(el("p", { class: "failed", role: "alert" }, wantsLink ? NO_LINK : `This page cannot show the session: ${(error as Error).message}`));
    document.documentElement.dataset.state = "failed";
    throw error;
  }
}
void main();
