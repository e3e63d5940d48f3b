// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The page for phones: take or choose photographs, see what becomes of each, and where more are wanted.
import { el } from "./dom";
import { signIn } from "./login";
import { Hint } from "./source";
import { Uploads } from "./upload";

interface Mine { sha256: string; name: string; title?: string; state: string; words: string; advice: string }

class Capture {
  private readonly uploads = new Uploads(() => this.show());
  private mine: Mine[] = [];
  private hints: Hint[] = [];
  private readonly rows = el("ul", { class: "sent", "aria-label": "Your photographs" });
  private readonly where = el("ul", { class: "hints" });
  private readonly summary = el("p", { class: "summary", role: "status" });

  async start(root: HTMLElement): Promise<void> {
    await signIn();
    const take = el("input", { type: "file", accept: "image/*", capture: "environment", id: "take", class: "hiddeninput" });
    const choose = el("input", { type: "file", multiple: "", id: "choose", class: "hiddeninput" });
    for (const input of [take, choose]) {
      input.addEventListener("change", () => { void this.uploads.add([...(input.files ?? [])]); input.value = ""; });
    }
    root.className = "capture";
    root.replaceChildren(el("main", {}, el("h1", {}, "Send photographs"), el("div", { class: "buttons" }, take, el("label", { for: "take", class: "big" }, "Take a photograph"),
      choose, el("label", { for: "choose", class: "big" }, "Choose files")), this.summary,
      el("h2", {}, "Where more are wanted"), this.where, el("h2", {}, "Your photographs"), this.rows, el("p", {}, el("a", { href: "/" }, "See the model"))));
    await this.uploads.restore();
    await this.look();
    this.follow();
    document.addEventListener("visibilitychange", () => { if (!document.hidden) { void this.uploads.run(); void this.look(); } });
    document.documentElement.dataset.state = "ready";
  }
  private async look(): Promise<void> {
    const answer = await fetch("/api/v1/photographs", { credentials: "same-origin" });
    if (answer.status === 401) throw new Error("this page wants the link that you were given");
    if (answer.status === 403) throw new Error("your link is for looking; ask for one to send");
    if (!answer.ok) return;
    this.mine = (await answer.json() as { photographs: Mine[] }).photographs;
    const session = await fetch("/api/v1/session", { credentials: "same-origin" });
    if (session.ok) this.hints = (await session.json() as { hints: Hint[] }).hints;
    this.show();
  }
  private follow(): void {
    const stream = new EventSource("/api/v1/events");
    stream.addEventListener("image", (event) => {
      const image = JSON.parse((event as MessageEvent<string>).data) as Mine;
      const known = this.mine.find((one) => one.sha256 === image.sha256);
      if (known) Object.assign(known, { state: image.state, words: image.words, advice: image.advice });
      else if (this.uploads.all.some((one) => one.sha256 === image.sha256)) this.mine.push({ ...image, name: image.title ?? image.name });
      this.show();
    });
    stream.addEventListener("hint", (event) => { this.hints = JSON.parse((event as MessageEvent<string>).data) as Hint[]; this.show(); });
    stream.addEventListener("reset", () => void this.look());
  }
  private show(): void {
    const known = new Map(this.mine.map((one) => [one.sha256, one]));
    const own = this.uploads.all.map((one) => known.get(one.sha256 ?? "") ?? { name: one.name, state: one.state, words: one.words, advice: "", sha256: one.sha256 ?? "" });
    const listed = new Set(own.map((one) => one.sha256));
    const all = [...own, ...this.mine.filter((one) => !listed.has(one.sha256)).reverse()];
    const count = (state: string): number => all.filter((one) => one.state === state).length;
    this.summary.textContent = `${all.length} photographs: ${count("placed")} placed, ${count("waiting")} waiting, ${this.uploads.all.filter((one) => one.state === "queued" || one.state === "sending").length} to be sent`;
    this.rows.replaceChildren(...all.slice(0, 200).map((one) => el("li", { class: one.state }, el("span", { class: "dot", "aria-hidden": "true" }), el("b", {}, one.name), ` ${one.state}`,
      el("span", { class: "what" }, one.state === "placed" ? "" : [one.words, one.advice].filter((text) => text).join(" – ")))));
    this.where.replaceChildren(...(this.hints.length > 0 ? this.hints.map((hint) => el("li", {}, hint.text)) : [el("li", {}, "nowhere in particular: every photograph that overlaps others helps")]));
  }
}

const root = document.getElementById("app")!;
new Capture().start(root).catch((error: Error) => {
  root.replaceChildren(el("p", { class: "failed", role: "alert" }, error.message));
  document.documentElement.dataset.state = "failed";
});
