// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// One photograph with its features and residuals, two with their matches, a point and who sees it.
import { button, el } from "./dom";
import { titleOf } from "./list";
import { Camera, Edge, ImageFact, Match, Observation, Source } from "./source";
import { Picked } from "./stage";

const WIDTH = 320;
const STRETCH = 20; // residuals are drawn so many times as long
const FIRST_PAIRS = 30; // listed before one asks for all
const STATES: Record<string, string> = { holds: "holds", open: "open", implausible: "set aside as weak", apart: "look-alike, kept apart", contradicts: "contradicts the model" };
const NO_PICTURES = "Pictures are not in this file: psfm view without --output shows them.";

export class Details {
  readonly element = el("section", { class: "panel", "aria-label": "Details" });
  onChoose: (image: number) => void = () => {};
  onPair: (a: number, b: number) => void = () => {};
  private shownImage: number | null = null; // the one whose partners are listed
  private asked = 0; // what comes for something that one has left since is not shown
  constructor(private readonly source: Source, private readonly factOf: (image: number) => ImageFact | undefined, private readonly edges: () => Edge[],
              private readonly cameraOf: (image: number) => Camera | undefined) {
    this.element.append(el("p", { class: "quiet" }, "Choose a photograph in the list, a camera or a point. A photograph's details name those that it matches; each of them opens the matches of the two."));
  }
  private name(image: number): string {
    const fact = this.factOf(image);
    return fact ? titleOf(fact) : `image ${image}`;
  }
  private start(...content: Node[]): () => boolean {
    const asked = ++this.asked;
    this.shownImage = null;
    this.element.replaceChildren(...content);
    this.element.scrollTop = 0;
    return () => asked === this.asked;
  }
  /** Fetches, or says why there is nothing. */
  private async fetched<T>(what: Promise<T>, isAsked: () => boolean, place: HTMLElement): Promise<T | null> {
    try {
      const data = await what;
      return isAsked() ? data : null;
    } catch (error) {
      if (isAsked()) place.append(el("p", { class: "notice", role: "status" }, `Nothing more is shown: ${(error as Error).message}.`));
      throw error;
    }
  }

  async image(fact: ImageFact): Promise<void> {
    const lines = [fact.state === "placed" ? `placed in cluster ${fact.cluster}, part ${fact.part}` : `${fact.state}: ${fact.words}`];
    if (fact.advice) lines.push(fact.advice);
    if (fact.since && fact.since.version > 0) lines.push(`so since version ${fact.since.version} (${fact.since.images} photographs)`);
    if (fact.state === "placed") lines.push(`${fact.inliers} features in the model, ${fact.error_px?.toFixed(3)} px off in the mean`);
    const more = el("div", {}), isAsked = this.start(el("h2", {}, titleOf(fact)), ...lines.map((line) => el("p", {}, line)), more);
    if (fact.id === undefined) return;
    const id = fact.id, picture = this.picture(id);
    this.element.append(this.partners(id));
    this.shownImage = id;
    if (!this.source.live) { more.append(el("p", { class: "quiet" }, NO_PICTURES)); return; }
    if (picture) more.append(picture.frame);
    const observations = fact.state === "placed" ? await this.fetched(this.source.observations(id), isAsked, more) : null;
    if (!observations || !picture) return;
    drawObservations(picture, observations);
    more.append(el("p", { class: "quiet" }, `Each stroke is a feature's residual, ${STRETCH} times as long.`));
  }
  /** Pairs have come. */
  refresh(): void {
    const before = this.element.querySelector(".partners");
    if (this.shownImage === null || !before) return;
    const after = this.partners(this.shownImage);
    if (after.textContent !== before.textContent) before.replaceWith(after);
  }
  /** The photographs that one matches, the most matches first: each opens the two of them. */
  private partners(image: number): HTMLElement {
    const pairs = this.edges().filter(([a, b]) => a === image || b === image).map(([a, b, matches, state]) => ({ other: a === image ? b : a, matches, state }))
      .sort((one, two) => two.matches - one.matches);
    const list = el("ul", { class: "names" }), box = el("section", { class: "partners", "aria-label": "Photographs that it matches" }, el("h2", {}, pairs.length === 0 ? "Matches no other photograph" : `Matches ${pairs.length} photographs`), list);
    const row = (pair: { other: number; matches: number; state: string }): HTMLElement => el("li", {},
      button(this.name(pair.other), () => this.onPair(image, pair.other), { class: "link" }), el("span", { class: "quiet" }, ` ${pair.matches} matches, ${STATES[pair.state] ?? pair.state}`));
    list.append(...pairs.slice(0, FIRST_PAIRS).map(row));
    if (pairs.length > FIRST_PAIRS) {
      const all = button(`All ${pairs.length}`, () => { list.append(...pairs.slice(FIRST_PAIRS).map(row)); all.remove(); });
      box.append(all);
    }
    return box;
  }

  async pair(a: number, b: number): Promise<void> {
    const one = (image: number): HTMLElement => button(this.name(image), () => this.onChoose(image), { class: "link" });
    const isAsked = this.start(el("h2", {}, one(a), " and ", one(b)));
    const edge = this.edges().find(([first, second]) => first === a && second === b);
    if (!this.source.live && !edge) { this.element.append(el("p", {}, "These two do not match.")); return; }
    if (!this.source.live && edge) { this.element.append(el("p", {}, `${edge[2]} matches fit one geometry`), el("p", { class: "quiet" }, NO_PICTURES)); return; }
    const matches = await this.fetched(this.source.matches(a, b), isAsked, this.element);
    if (!matches) return;
    const first = this.picture(a), second = this.picture(b);
    this.element.append(el("p", {}, `${matches.length} matches fit one geometry`));
    if (!first || !second) return;
    this.element.append(first.frame, second.frame);
    drawMatches(first, second, matches);
  }

  async point(picked: Picked): Promise<void> {
    const isAsked = this.start(el("h2", {}, "Point"), el("p", { class: "quiet" }, picked.position.map((v) => v.toFixed(3)).join(", ")));
    const images = await this.fetched(this.source.seenBy(picked.cluster, picked.slot), isAsked, this.element);
    if (!images) return;
    this.element.append(el("p", {}, `seen by ${images.length} photographs`),
      el("ul", { class: "names" }, ...images.map((image) => el("li", {}, button(this.name(image), () => this.onChoose(image), { class: "link" })))));
  }

  private picture(image: number): Picture | null {
    const camera = this.cameraOf(image);
    if (!camera) return null;
    const height = Math.round(WIDTH * camera.height / camera.width);
    const canvas = el("canvas", { width: String(2 * WIDTH), height: String(2 * height), role: "img", "aria-label": `Features of ${this.name(image)}` });
    const frame = el("div", { class: "picture" });
    const thumbnail = this.source.thumbnail(image);
    if (thumbnail) frame.append(el("img", { src: thumbnail, alt: "" }));
    frame.append(canvas);
    return { frame, context: canvas.getContext("2d")!, scale: 2 * WIDTH / camera.width };
  }
}

interface Picture { frame: HTMLElement; context: CanvasRenderingContext2D; scale: number }

function drawObservations(picture: Picture, observations: Observation[]): void {
  const { context: c, scale } = picture;
  c.strokeStyle = "#ffd24a";
  c.fillStyle = "#7fe0a8";
  c.lineWidth = 1.5;
  for (const o of observations) {
    c.fillRect(o.x * scale - 1.5, o.y * scale - 1.5, 3, 3);
    c.beginPath();
    c.moveTo(o.x * scale, o.y * scale);
    c.lineTo((o.x + STRETCH * o.dx) * scale, (o.y + STRETCH * o.dy) * scale);
    c.stroke();
  }
}
function drawMatches(first: Picture, second: Picture, matches: Match[]): void {
  matches.forEach((m, i) => {
    const colour = `hsl(${(i * 137.5) % 360} 80% 60%)`;
    for (const [picture, x, y] of [[first, m.x1, m.y1], [second, m.x2, m.y2]] as [Picture, number, number][]) {
      picture.context.fillStyle = colour;
      picture.context.beginPath();
      picture.context.arc(x * picture.scale, y * picture.scale, 3.5, 0, 7);
      picture.context.fill();
    }
  });
}
