// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// One photograph with its features and residuals, two with their matches, a point and who sees it.
import { button, el } from "./dom";
import { titleOf } from "./list";
import { Camera, ImageFact, Match, Observation, Source } from "./source";
import { Picked } from "./stage";

const WIDTH = 320;
const STRETCH = 20; // residuals are drawn so many times as long

export class Details {
  readonly element = el("section", { class: "panel", "aria-label": "Details" });
  onChoose: (image: number) => void = () => {};
  constructor(private readonly source: Source, private readonly facts: () => ImageFact[], private readonly cameraOf: (image: number) => Camera | undefined) {
    this.element.append(el("p", { class: "quiet" }, "Click a photograph in the list, a camera or a point. Hold Ctrl (or Cmd) and click a second camera for the matches of the two."));
  }
  private name(image: number): string {
    const fact = this.facts()[image];
    return fact ? titleOf(fact) : `image ${image}`;
  }

  async image(fact: ImageFact): Promise<void> {
    const lines = [fact.state === "placed" ? `placed in cluster ${fact.cluster}, part ${fact.part}` : `${fact.state}: ${fact.words}`];
    if (fact.advice) lines.push(fact.advice);
    if (fact.since && fact.since.version > 0) lines.push(`so since version ${fact.since.version} (${fact.since.images} photographs)`);
    if (fact.state === "placed") lines.push(`${fact.inliers} features in the model, ${fact.error_px?.toFixed(3)} px off in the mean`);
    this.element.replaceChildren(el("h2", {}, titleOf(fact)), ...lines.map((line) => el("p", {}, line)));
    if (fact.id === undefined) return;
    const id = fact.id, observations = fact.state === "placed" ? await this.source.observations(id) : null;
    const picture = this.picture(id);
    if (picture) this.element.append(picture.frame);
    if (!observations || !picture) return;
    drawObservations(picture, observations);
    this.element.append(el("p", { class: "quiet" }, `Each stroke is a feature's residual, ${STRETCH} times as long.`));
  }

  async pair(a: number, b: number): Promise<void> {
    this.element.replaceChildren(el("h2", {}, `${this.name(a)} and ${this.name(b)}`));
    const matches = await this.source.matches(a, b), first = this.picture(a), second = this.picture(b);
    if (!matches) { this.element.append(el("p", {}, "A page in one file has no matches; psfm view without --output has.")); return; }
    this.element.append(el("p", {}, `${matches.length} matches fit one geometry`));
    if (!first || !second) return;
    this.element.append(first.frame, second.frame);
    drawMatches(first, second, matches);
  }

  async point(picked: Picked): Promise<void> {
    const images = await this.source.seenBy(picked.cluster, picked.slot);
    this.element.replaceChildren(el("h2", {}, "Point"), el("p", {}, `seen by ${images.length} photographs`),
      el("p", { class: "quiet" }, picked.position.map((v) => v.toFixed(3)).join(", ")),
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
