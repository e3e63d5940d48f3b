// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The stream of events, opened again whenever it breaks, and whether there is a server that answers.

const AGAIN_MS = 2000;
const REFUSED_MS = 60000; // a link that is none any more may be one again, but an address that tries many is slowed down
const SLOWED_MS = 10000; // it is

/** there; gone: no answer; refused: the link is none any more */
export type LineState = "there" | "gone" | "refused";

export class EventLine {
  private stream: EventSource | null = null;
  private timer = 0;
  private asking = false;
  state: LineState = "there";

  constructor(private readonly url: string, private readonly probe: string, private readonly acts: Record<string, (data: string) => void>,
              private readonly told: (state: LineState) => void) {
    // None when hidden: browsers have few connections for one host.
    document.addEventListener("visibilitychange", () => { if (document.hidden) this.close(); else this.again(); });
    window.addEventListener("offline", () => void this.ask());
    window.addEventListener("online", () => this.again());
    window.addEventListener("storage", (event) => { if (event.key === SIGNED_IN) this.again(); }); // a link was opened beside this page
  }
  open(): void {
    this.close();
    if (document.hidden) return;
    const stream = this.stream = new EventSource(this.url);
    for (const [kind, act] of Object.entries(this.acts)) stream.addEventListener(kind, (event) => act((event as MessageEvent<string>).data));
    stream.addEventListener("open", () => this.tell("there"));
    stream.addEventListener("error", () => { this.close(); void this.ask(); }); // by itself it would not say what is the matter
  }
  /** A request failed for want of an answer: is there a server, and does it still take the link? */
  async ask(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    const answer = await fetch(this.probe, { method: "HEAD", credentials: "same-origin" }).catch(() => null), before = this.state;
    this.asking = false;
    if (answer?.status === 401) { this.refuse(); return; }
    if (answer?.status === 429) { this.later(() => void this.ask(), SLOWED_MS); return; }
    this.tell(answer?.ok ? "there" : "gone");
    if (this.state === "gone") this.later(() => void this.ask(), AGAIN_MS);
    else if (!this.stream) this.later(() => this.open(), before === "there" ? AGAIN_MS : 0);
  }
  /** The server has said that the link is none any more. */
  refuse(): void {
    this.close();
    this.tell("refused");
    this.later(() => void this.ask(), REFUSED_MS);
  }
  private again(): void { if (this.state === "refused") void this.ask(); else this.open(); }
  private later(act: () => void, wait_ms: number): void {
    clearTimeout(this.timer);
    if (!document.hidden) this.timer = window.setTimeout(act, wait_ms);
  }
  private tell(state: LineState): void {
    if (state === this.state) return;
    this.state = state;
    this.told(state);
  }
  close(): void {
    clearTimeout(this.timer);
    this.stream?.close();
    this.stream = null;
  }
}

/** Tells the other pages of this browser that a link has been opened. */
export const SIGNED_IN = "psfm-signed-in";
