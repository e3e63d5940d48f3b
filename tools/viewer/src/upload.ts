// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Photographs on their way to the server: kept in the browser until they are acknowledged, sent one after the other,
// gone on with where a line broke off. Of what is refused the name and the reason stay until one has seen them.
import { sha256 } from "./sha256";

export interface Outgoing { id: number; name: string; blob: Blob; sha256?: string; sent: number; state: "queued" | "sending" | "sent" | "refused"; words: string }

const API = "/api/v1";
const CHUNK = 1 << 20; // a line that breaks loses at most so much
const DATABASE = "psfm", STORE = "outgoing";

function database(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(DATABASE, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(STORE, { keyPath: "id", autoIncrement: true });
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
function done<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

const KEPT = "is kept here until a link is opened that may send";

export class Uploads {
  all: Outgoing[] = [];
  private running = false;
  /** The status with which the server turned the link away: 401 or 403; nothing is sent until one runs it again. */
  turnedAway = 0;
  constructor(private readonly changed: () => void) {}
  /** Photographs that are still to be sent. */
  get left(): number { return this.all.filter((entry) => entry.state === "queued" || entry.state === "sending").length; }

  /** What an earlier visit left. */
  async restore(): Promise<void> {
    const db = await database();
    for (const entry of await done(db.transaction(STORE).objectStore(STORE).getAll()) as { id: number; name: string; blob?: Blob; words?: string }[]) {
      this.all.push({ id: entry.id, name: entry.name, blob: entry.blob ?? new Blob(), sent: 0, state: entry.blob ? "queued" : "refused",
        words: entry.words ?? "waits to be sent" });
    }
    this.changed();
  }
  async add(files: Iterable<File>): Promise<void> {
    const db = await database();
    for (const file of files) {
      const id = await done(db.transaction(STORE, "readwrite").objectStore(STORE).add({ name: file.name, blob: file })) as number;
      this.all.push({ id, name: file.name, blob: file, sent: 0, state: "queued", words: "waits to be sent" });
    }
    this.changed();
    if (!this.turnedAway) void this.run();
  }
  /** What was refused, and seen. */
  async dismiss(entry: Outgoing): Promise<void> {
    this.all = this.all.filter((one) => one !== entry);
    this.changed();
    await this.forget(entry);
  }
  private async forget(entry: Outgoing): Promise<void> {
    const db = await database();
    await done(db.transaction(STORE, "readwrite").objectStore(STORE).delete(entry.id));
  }

  /** Sends what is queued, in order. Goes on by itself after failures, a little later each time. */
  async run(): Promise<void> {
    if (this.running) return;
    this.running = true;
    this.turnedAway = 0;
    let pause = 1;
    for (;;) {
      const next = this.all.find((entry) => entry.state === "queued" || entry.state === "sending");
      if (!next) break;
      const wait: number = await this.send(next).catch((error: Error) => { next.words = `the line broke off (${error.message})`; return -1; });
      if (wait === 0) { pause = 1; this.changed(); continue; }
      this.changed();
      if (this.turnedAway) break;
      await new Promise((resolve) => setTimeout(resolve, 1000 * (wait > 0 ? wait : pause)));
      if (wait < 0) pause = Math.min(30, 2 * pause);
    }
    this.running = false;
  }

  /** @return 0: over with, one way or the other; more: seconds to wait */
  private async send(entry: Outgoing): Promise<number> {
    entry.state = "sending";
    entry.sha256 ??= sha256(new Uint8Array(await entry.blob.arrayBuffer()));
    const url = `${API}/photographs/${entry.sha256}`;
    const head = await fetch(url, { method: "HEAD", credentials: "same-origin" });
    if (head.status === 401 || head.status === 403) return this.keep(entry, head.status);
    let at = Number(head.headers.get("Upload-Offset") ?? 0);
    const length = head.headers.get("Upload-Length");
    if (head.ok && length !== null && length === head.headers.get("Upload-Offset")) return this.over(entry, "sent", "is there");
    for (;;) {
      entry.words = `is being sent, ${Math.round(100 * at / entry.blob.size)} %`;
      entry.sent = at;
      this.changed();
      const answer = await fetch(`${url}?name=${encodeURIComponent(entry.name)}`, { method: "PATCH", credentials: "same-origin",
        headers: { "Content-Type": "application/offset+octet-stream", "Upload-Offset": String(at), "Upload-Length": String(entry.blob.size) },
        body: entry.blob.slice(at, at + CHUNK) });
      if (answer.status === 201 || answer.status === 200) return this.over(entry, "sent", "is there");
      if (answer.status === 204) { at = Number(answer.headers.get("Upload-Offset")); continue; }
      if (answer.status === 409) { at = Number(answer.headers.get("Upload-Offset") ?? 0); continue; }
      if (answer.status === 401 || answer.status === 403) return this.keep(entry, answer.status);
      const said = await answer.json().catch(() => ({})) as { detail?: string };
      entry.words = said.detail ?? `the server said ${answer.status}`;
      if (answer.status === 429 || answer.status === 423 || answer.status === 503 || answer.status === 507)
        return Math.max(1, Number(answer.headers.get("Retry-After") ?? 10));
      return this.over(entry, "refused", entry.words);
    }
  }
  private keep(entry: Outgoing, status: number): number {
    entry.state = "queued";
    entry.words = KEPT;
    this.turnedAway = status;
    return -1;
  }
  private async over(entry: Outgoing, state: "sent" | "refused", words: string): Promise<number> {
    entry.state = state;
    entry.words = words;
    if (state === "sent") { await this.forget(entry); return 0; }
    const db = await database();
    await done(db.transaction(STORE, "readwrite").objectStore(STORE).put({ id: entry.id, name: entry.name, words }));
    entry.blob = new Blob();
    return 0;
  }
}
