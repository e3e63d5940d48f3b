// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Where a page has its session from: the file that it is itself, or a server.
import { Quat, Reader, Vec3, gunzip } from "./wire";

export interface ImageFact {
  id?: number; name: string; state: "placed" | "waiting" | "rejected";
  reason: string; words: string; advice: string;
  since?: { version: number; images: number };
  cluster?: number; part?: number; inliers?: number; error_px?: number;
  user?: number; title?: string; mine?: boolean; sha256?: string;
}
export interface Camera { id: number; width: number; height: number; focal: number }
export interface SessionEvent { image: number; event: string; text: string }
export interface Version { version: number; images: number; placed: number; parts: number; resets: number }
/** A model that is not to be trusted far, and a line for each reason. */
export interface WeakModel { cluster: number; images: number; reasons: string[]; words: string[] }
export type Edge = [number, number, number, string]; // images, matches, what became of it
export interface Hint { text: string; image: number; kind: string }
export interface Session {
  name: string;
  counts: { images: number; placed: number; waiting: number; rejected: number; clusters: number; effective_clusters: number; version: number };
  image_list: ImageFact[];
  cameras: Camera[];
  weak_models: WeakModel[];
  events: SessionEvent[];
  versions: Version[];
  edges: Edge[];
  hints: Hint[];
  users?: string[];
  me?: { name: string; role: string };
  in_metres: boolean;
  up: Vec3;
  licence: string;
}
/** Feature of an image that is in the model: pixels, residual in pixels, and the point. */
export interface Observation { x: number; y: number; dx: number; dy: number; cluster: number; slot: number }
export interface Match { x1: number; y1: number; x2: number; y2: number }

/** Poses of all versions, each as what has changed since the one before. The last is the session's latest. */
export class Replay {
  /** Photographs that had come when each was placed first. */
  readonly placedAt = new Map<number, number>();
  readonly versions: { images: number; changes: { image: number; q: Quat; centre: Vec3 }[]; gone: number[] }[] = [];
  constructor(bytes: Uint8Array) {
    if (bytes.length === 0) return;
    const r = new Reader(bytes);
    const origin = r.floats(3), step = r.f32() / 65535;
    for (let n = r.u32(); n > 0; --n) {
      const images = r.leb();
      const changes = Array.from({ length: r.leb() }, () => {
        const image = r.leb();
        const centre = [0, 1, 2].map((axis) => origin[axis] + r.u16() * step) as Vec3;
        const q = [r.i16() / 32767, r.i16() / 32767, r.i16() / 32767, r.i16() / 32767] as Quat;
        return { image, q, centre };
      });
      const gone = Array.from({ length: r.leb() }, () => r.leb());
      for (const { image } of changes) if (!this.placedAt.has(image)) this.placedAt.set(image, images);
      this.versions.push({ images, changes, gone });
    }
  }
  at(version: number): Map<number, { q: Quat; centre: Vec3 }> {
    const poses = new Map<number, { q: Quat; centre: Vec3 }>();
    for (let v = 0; v <= version && v < this.versions.length; ++v) {
      for (const change of this.versions[v].changes) poses.set(change.image, change);
      for (const image of this.versions[v].gone) poses.delete(image);
    }
    return poses;
  }
}

export interface Source {
  readonly live: boolean;
  session(): Promise<Session>;
  scene(): Promise<Uint8Array>;
  replay(): Promise<Replay>;
  seenBy(cluster: number, slot: number): Promise<number[]>;
  observations(image: number): Promise<Observation[] | null>;
  matches(a: number, b: number): Promise<Match[] | null>;
  thumbnail(image: number): string | null;
}

/** A page that holds its session: compressed and as base64 in elements of its own. */
export class FileSource implements Source {
  readonly live = false;
  private tracks: Promise<Map<number, Uint32Array[]>> | undefined;
  private async block(id: string): Promise<Uint8Array> {
    const text = document.getElementById(id)?.textContent?.trim() ?? "";
    if (text === "") return new Uint8Array(0);
    return gunzip(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
  }
  async session(): Promise<Session> { return JSON.parse(new TextDecoder().decode(await this.block("session"))); }
  scene(): Promise<Uint8Array> { return this.block("scene"); }
  async replay(): Promise<Replay> { return new Replay(await this.block("replay")); }
  async seenBy(cluster: number, slot: number): Promise<number[]> {
    this.tracks ??= this.block("tracks").then(readTracks);
    return Array.from((await this.tracks).get(cluster)?.[slot] ?? []);
  }
  async observations(): Promise<Observation[] | null> { return null; }
  async matches(): Promise<Match[] | null> { return null; }
  thumbnail(): string | null { return null; }
}

/** By cluster and slot: the images that see the point. */
function readTracks(bytes: Uint8Array): Map<number, Uint32Array[]> {
  const all = new Map<number, Uint32Array[]>();
  const r = new Reader(bytes);
  while (r.at < bytes.length) {
    const cluster = r.leb(), slots = r.leb();
    all.set(cluster, Array.from({ length: slots }, () => r.ascending(r.leb())));
  }
  return all;
}

export const NO_ANSWER = "the server does not answer";
export class ServerError extends Error {
  constructor(readonly status: number, message: string) { super(message); }
}

export class ServerSource implements Source {
  readonly live = true;
  constructor(readonly base = "/api/v1") {}
  private async get(path: string): Promise<Response> {
    const answer = await fetch(this.base + path, { credentials: "same-origin" }).catch(() => { throw new ServerError(0, NO_ANSWER); });
    if (!answer.ok) {
      const problem = await answer.json().catch(() => ({})) as { detail?: string; title?: string };
      throw new ServerError(answer.status, problem.detail ?? problem.title ?? `the server said ${answer.status}`);
    }
    return answer;
  }
  private async json<T>(path: string): Promise<T> { return await (await this.get(path)).json() as T; }
  session(): Promise<Session> { return this.json("/session"); }
  async scene(): Promise<Uint8Array> { return new Uint8Array(await (await this.get("/scene")).arrayBuffer()); }
  /** What has changed since change `after`; null: too long ago, the scene has to be fetched anew. */
  async changes(after: number): Promise<Uint8Array[] | null> {
    try {
      const bytes = new Uint8Array(await (await this.get(`/scene/changes?after=${after}`)).arrayBuffer());
      const changes: Uint8Array[] = [];
      const r = new Reader(bytes);
      while (r.at < bytes.length) {
        const length = r.u32();
        changes.push(bytes.subarray(r.at, r.at + length));
        r.at += length;
      }
      return changes;
    } catch (error) {
      if (error instanceof ServerError && error.status === 410) return null;
      throw error;
    }
  }
  async replay(): Promise<Replay> { return new Replay(new Uint8Array(await (await this.get("/replay")).arrayBuffer())); }
  async seenBy(cluster: number, slot: number): Promise<number[]> {
    return (await this.json<{ images: number[] }>(`/points/${cluster}/${slot}`)).images;
  }
  async observations(image: number): Promise<Observation[] | null> {
    return (await this.json<{ observations: Observation[] }>(`/images/${image}`)).observations;
  }
  async matches(a: number, b: number): Promise<Match[] | null> {
    return (await this.json<{ matches: Match[] }>(`/pairs/${a}/${b}`)).matches;
  }
  thumbnail(image: number): string { return `${this.base}/images/${image}/thumbnail`; }
}
