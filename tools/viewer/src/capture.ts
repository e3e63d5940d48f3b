// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The page for phones: take or choose photographs, see what becomes of each, and where more are wanted.
import { button, el } from "./dom";
import { EventLine } from "./events";
import { NO_LINK, signIn } from "./login";
import { Hint } from "./source";
import { Outgoing, Uploads } from "./upload";

const MOST_ROWS = 200;

interface Mine { sha256: string; name: string; title?: string; state: string; words: string; advice: string }
interface Row { name: string; state: string; words: string; advice: string; outgoing?: Outgoing }

class Capture {
  private readonly uploads = new Uploads(() => this.changed());
  private mine: Mine[] = [];
  private hints: Hint[] = [];
  private wasIn = false; // a link was good on this page
  private away = 0; // the status with which the link was turned away, if it was
  private readonly notice = el("p", { class: "notice", role: "alert", hidden: "" });
  private readonly rows = el("ul", { class: "sent", "aria-label": "Your photographs" });
  private readonly where = el("ul", { class: "hints" });
  private readonly summary = el("p", { class: "summary", role: "status" });
  private readonly line = new EventLine("/api/v1/events", "/api/v1/session", {
    hello: () => void this.goOn(),
    reset: () => void this.goOn(),
    image: (data) => this.image(JSON.parse(data) as Mine),
    hint: (data) => { this.hints = JSON.parse(data) as Hint[]; this.show(); },
  }, (state) => {
    if (state === "there") void this.goOn();
    else if (state === "refused") this.turnedAway(401);
    else this.say("the server does not answer; trying again");
  });

  async start(root: HTMLElement): Promise<void> {
    const take = el("input", { type: "file", accept: "image/*", capture: "environment", id: "take", class: "hiddeninput" });
    const choose = el("input", { type: "file", multiple: "", id: "choose", class: "hiddeninput" });
    for (const input of [take, choose]) {
      input.addEventListener("change", () => { void this.uploads.add([...(input.files ?? [])]); input.value = ""; });
    }
    root.className = "capture";
    root.replaceChildren(el("main", {}, el("h1", {}, "Send photographs"), this.notice, el("div", { class: "buttons" }, take, el("label", { for: "take", class: "big" }, "Take a photograph"),
      choose, el("label", { for: "choose", class: "big" }, "Choose files")), this.summary,
      el("h2", {}, "Where more are wanted"), this.where, el("h2", {}, "Your photographs"), this.rows, el("p", {}, el("a", { href: "/" }, "See the model"))));
    await this.uploads.restore();
    window.addEventListener("hashchange", () => void this.enter()); // a new link, opened in this page
    document.addEventListener("visibilitychange", () => { if (!document.hidden) void this.goOn(); });
    await this.enter();
  }
  /** With the link in the address, or with one that was opened before. */
  private async enter(): Promise<void> {
    try {
      await signIn();
    } catch (error) {
      this.fail((error as Error).message);
      return;
    }
    if (await this.goOn()) this.line.open();
  }
  /** Everything anew; what is kept here is sent if the link may. @return whether there is anything to follow */
  private async goOn(): Promise<boolean> {
    const answer = await fetch("/api/v1/photographs", { credentials: "same-origin" }).catch(() => null);
    if (!answer) { this.say("the server does not answer; trying again"); return true; }
    if (answer.status === 401 || answer.status === 403) { this.turnedAway(answer.status); return answer.status === 403; }
    if (answer.status === 404) { this.useless(); return false; }
    if (!answer.ok) return true;
    this.mine = (await answer.json() as { photographs: Mine[] }).photographs;
    this.wasIn = true;
    this.away = 0;
    this.say("");
    document.documentElement.dataset.state = "ready";
    void this.uploads.run();
    const session = await fetch("/api/v1/session", { credentials: "same-origin" }).catch(() => null);
    if (session?.ok) this.hints = (await session.json() as { hints: Hint[] }).hints;
    this.show();
    return true;
  }
  private useless(): void {
    this.line.close();
    this.rows.closest("main")!.replaceChildren(el("h1", {}, "Send photographs"), this.notice, el("p", {}, el("a", { href: "/" }, "See the model")));
    this.fail("this server takes no photographs: it shows a session; psfm serve takes them");
  }
  private changed(): void {
    if (this.uploads.turnedAway || this.away) this.turnedAway(this.uploads.turnedAway || this.away); // how many are kept
    else this.show();
  }
  private turnedAway(status: number): void {
    const isNew = this.away !== status;
    this.away = status;
    if (isNew && status === 401) this.line.refuse();
    const { left } = this.uploads;
    const why = status === 403 ? "your link is for looking; ask for one to send" : this.wasIn ? "this link has been taken back or has run out" : NO_LINK;
    this.fail(left === 0 ? why : `${why}; your ${left} ${left === 1 ? "photograph is" : "photographs are"} kept here: open a new link`);
  }
  private fail(words: string): void {
    document.documentElement.dataset.state = "failed";
    this.say(words);
  }
  private say(words: string): void {
    if (this.notice.textContent !== words) this.notice.textContent = words;
    this.notice.hidden = words === "";
    this.show();
  }
  private image(image: Mine): void {
    const known = this.mine.find((one) => one.sha256 === image.sha256);
    if (known) Object.assign(known, { state: image.state, words: image.words, advice: image.advice });
    else if (this.uploads.all.some((one) => one.sha256 === image.sha256)) this.mine.push({ ...image, name: image.title ?? image.name });
    this.show();
  }
  private show(): void {
    const known = new Set(this.mine.map((one) => one.sha256));
    // Newest first: what is under way, then what the server has, in the order in which it came there.
    const here: Row[] = this.uploads.all.filter((one) => one.state === "refused" || !known.has(one.sha256 ?? ""))
      .map((one) => ({ name: one.name, state: one.state, words: one.words, advice: "", outgoing: one }));
    const all = [...here.reverse(), ...this.mine.slice().reverse()];
    const count = (...states: string[]): number => all.filter((one) => states.includes(one.state)).length, refused = count("refused");
    this.summary.textContent = `${all.length - refused} photographs: ${count("placed")} placed, ${count("waiting")} waiting, ${this.uploads.left} to be sent` +
      (refused === 0 ? "" : `; ${refused} ${refused === 1 ? "file" : "files"} refused`);
    this.rows.replaceChildren(...all.slice(0, MOST_ROWS).map((one) => this.row(one)));
    this.where.replaceChildren(...(this.hints.length > 0 ? this.hints.map((hint) => el("li", {}, hint.text)) : [el("li", {}, "nowhere in particular: every photograph that overlaps others helps")]));
  }
  private async takeBack(one: Mine): Promise<void> {
    if (!window.confirm(`Delete ${one.name}? The model will do without it.`)) return;
    const answer = await fetch(`/api/v1/photographs/${one.sha256}`, { method: "DELETE", credentials: "same-origin" }).catch(() => null);
    if (!answer?.ok && answer?.status !== 404) {
      this.say(answer ? ((await answer.json()) as { detail?: string }).detail ?? "it could not be deleted" : "the server does not answer; try again");
      return;
    }
    this.mine = this.mine.filter((other) => other.sha256 !== one.sha256);
    this.uploads.all = this.uploads.all.filter((other) => other.sha256 !== one.sha256);
    this.show();
  }
  private row(one: Row): HTMLElement {
    const { outgoing } = one;
    return el("li", { class: one.state }, el("span", { class: "dot", "aria-hidden": "true" }), el("b", {}, one.name), ` ${one.state}`,
      one.state === "refused" && outgoing ? button("Dismiss", () => void this.uploads.dismiss(outgoing), { class: "dismiss", "aria-label": `Dismiss ${one.name}` }) : null,
      outgoing ? null : button("Delete", () => void this.takeBack(one as Mine), { class: "dismiss", "aria-label": `Delete ${one.name}` }),
      el("span", { class: "what" }, one.state === "placed" ? "" : [one.words, one.advice].filter((text) => text).join(" – ")));
  }
}

const root = document.getElementById("app")!;
new Capture().start(root).catch((error: Error) => {
  root.replaceChildren(el("p", { class: "failed", role: "alert" }, error.message));
  document.documentElement.dataset.state = "failed";
});
