// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The list of photographs: state, reason and advice, searched by name. Only rows in sight are elements.
import { el, select } from "./dom";
import { ImageFact } from "./source";

const ROW_PX = 44;

export function titleOf(fact: ImageFact): string { return fact.title ?? fact.name; }

export class ImageList {
  readonly element = el("section", { class: "panel", "aria-label": "Photographs" });
  private readonly search = el("input", { type: "search", placeholder: "Search by name", "aria-label": "Search photographs by name" });
  private readonly count = el("p", { class: "quiet", role: "status" });
  private readonly box = el("div", { class: "rows", tabindex: "0", role: "listbox", "aria-label": "Photographs" });
  private readonly space = el("div", { class: "space", role: "presentation" });
  private shown: ImageFact[] = [];
  private state = "";
  private chosen: number | null = null;
  private current: ImageFact | null = null; // where the keys are: rejected ones have no number

  constructor(private facts: ImageFact[], private readonly choose: (fact: ImageFact, how: "open" | "pair" | "stay") => void) {
    this.search.addEventListener("input", () => this.filter());
    this.box.addEventListener("scroll", () => this.fill());
    this.box.addEventListener("keydown", (event) => this.key(event));
    this.box.append(this.space);
    this.element.append(el("div", { class: "bar" }, this.search, select("State", [["", "all"], ["placed", "placed"], ["waiting", "waiting"], ["rejected", "rejected"]],
      (state) => { this.state = state; this.filter(); })), this.count, this.box);
    new ResizeObserver(() => this.fill()).observe(this.box);
    this.filter();
  }
  update(facts: ImageFact[]): void { this.facts = facts; this.filter(); }
  mark(image: number | null): void {
    this.chosen = image;
    if (image !== null) this.current = null;
    this.fill();
  }

  private filter(): void {
    const words = this.search.value.toLowerCase();
    this.shown = this.facts.filter((f) => (this.state === "" || f.state === this.state) && titleOf(f).toLowerCase().includes(words));
    this.count.textContent = `${this.shown.length} of ${this.facts.length} photographs`;
    this.space.style.height = `${this.shown.length * ROW_PX}px`;
    this.fill();
  }
  private fill(): void {
    const first = Math.max(0, Math.floor(this.box.scrollTop / ROW_PX) - 3);
    const last = Math.min(this.shown.length, first + Math.ceil((this.box.clientHeight || 600) / ROW_PX) + 6);
    this.space.replaceChildren(...this.shown.slice(first, last).map((fact, i) => this.row(fact, first + i)));
  }
  private row(fact: ImageFact, at: number): HTMLElement {
    const what = fact.state === "placed" ? `${fact.inliers} points, ${fact.error_px?.toFixed(2)} px, cluster ${fact.cluster}`
      : fact.advice ? `${fact.words} – ${fact.advice}` : fact.words;
    const row = el("div", { class: `row ${fact.state}`, role: "option", "aria-selected": String(fact === this.current || (fact.id !== undefined && fact.id === this.chosen)), title: what },
      el("span", { class: "name" }, el("span", { class: "dot", "aria-hidden": "true" }), titleOf(fact), " ", el("span", { class: "state" }, fact.state)), el("span", { class: "what" }, what));
    row.style.top = `${at * ROW_PX}px`;
    row.addEventListener("click", (event) => {
      this.current = fact.id === undefined ? fact : null;
      this.choose(fact, event.ctrlKey || event.metaKey || event.shiftKey ? "pair" : "open");
    });
    return row;
  }
  private key(event: KeyboardEvent): void {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0, isOpening = event.key === "Enter";
    if ((step === 0 && !isOpening) || this.shown.length === 0) return;
    event.preventDefault();
    const at = this.shown.findIndex((f) => f === this.current || (f.id !== undefined && f.id === this.chosen));
    if (isOpening) { if (at >= 0) this.choose(this.shown[at], "open"); return; }
    const next = Math.min(this.shown.length - 1, Math.max(0, at + step));
    if (next * ROW_PX < this.box.scrollTop || (next + 1) * ROW_PX > this.box.scrollTop + this.box.clientHeight) this.box.scrollTop = next * ROW_PX;
    this.current = this.shown[next];
    this.choose(this.current, "stay");
  }
}
