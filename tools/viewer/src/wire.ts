// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Changes to a model as docs/serve.md has them ("Changes"); written by tools/serve/shown_scene.cpp.

export class Reader {
  private readonly view: DataView;
  at = 0;
  constructor(readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }
  u8(): number { return this.view.getUint8(this.at++); }
  u16(): number { const v = this.view.getUint16(this.at, true); this.at += 2; return v; }
  i16(): number { const v = this.view.getInt16(this.at, true); this.at += 2; return v; }
  u32(): number { const v = this.view.getUint32(this.at, true); this.at += 4; return v; }
  f32(): number { const v = this.view.getFloat32(this.at, true); this.at += 4; return v; }
  leb(): number {
    let value = 0, scale = 1;
    for (;;) {
      const byte = this.u8();
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
      scale *= 128;
    }
  }
  floats(n: number): number[] { return Array.from({ length: n }, () => this.f32()); }
  ascending(n: number): Uint32Array {
    const values = new Uint32Array(n);
    let before = 0;
    for (let i = 0; i < n; ++i) values[i] = before += this.leb();
    return values;
  }
  /** Low bytes, then high bytes, of differences. */
  plane(n: number): Uint16Array {
    const values = new Uint16Array(n);
    const low = this.at, high = this.at + n;
    let before = 0;
    for (let i = 0; i < n; ++i) {
      before = (before + this.bytes[low + i] + (this.bytes[high + i] << 8)) & 0xffff;
      values[i] = before;
    }
    this.at += 2 * n;
    return values;
  }
}

export type Vec3 = [number, number, number];
export type Quat = [number, number, number, number]; // x y z w
export interface Sim3 { scale: number; q: Quat; t: Vec3 }
export interface Pose { camera: number; q: Quat; centre: Vec3 } // camera from the cluster's shown frame

export function rotate(q: Quat, v: Vec3): Vec3 {
  const [x, y, z, w] = q;
  const tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
  return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}
export function conjugate(q: Quat): Quat { return [-q[0], -q[1], -q[2], q[3]]; }
export function times(a: Quat, b: Quat): Quat {
  return [a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
}
export function moved(s: Sim3, v: Vec3): Vec3 {
  const r = rotate(s.q, v);
  return [s.scale * r[0] + s.t[0], s.scale * r[1] + s.t[1], s.scale * r[2] + s.t[2]];
}

/** Points and cameras of a cluster in its own shown frame; points by slot. */
export class Cluster {
  place: Sim3 = { scale: 1, q: [0, 0, 0, 1], t: [0, 0, 0] };
  part = 0;
  slots = 0; // used so far; a slot is never used again
  positions = new Float32Array(0);
  colours = new Uint8Array(0);
  errors = new Uint8Array(0);
  tracks = new Uint8Array(0);
  born = new Uint32Array(0); // NOWHERE: not there
  firsts = new Uint32Array(0); // image of the first observation
  readonly poses = new Map<number, Pose>();
  changed: Uint32Array[] = []; // slots that changed since who draws them has taken these lists
  constructor(readonly id: number) {}

  grow(slots: number): void {
    if (slots > this.born.length) {
      const room = Math.max(slots, 2 * this.born.length, 1024);
      this.positions = widened(this.positions, 3 * room);
      this.colours = widened(this.colours, 3 * room);
      this.errors = widened(this.errors, room);
      this.tracks = widened(this.tracks, room);
      this.firsts = widened(this.firsts, room);
      const before = this.born.length;
      this.born = widened(this.born, room);
      this.born.fill(NOWHERE, before);
    }
    this.slots = Math.max(this.slots, slots);
  }
  get count(): number {
    let n = 0;
    for (let i = 0; i < this.slots; ++i) if (this.born[i] !== NOWHERE) ++n;
    return n;
  }
}
export const NOWHERE = 0xffffffff;

function widened<T extends Float32Array | Uint8Array | Uint32Array>(array: T, length: number): T {
  const wide = new (array.constructor as new (n: number) => T)(length);
  wide.set(array as never);
  return wide;
}

export class Model {
  readonly clusters = new Map<number, Cluster>();
  number = 0;
  version = 0;
  images = 0;

  /** Takes account of one change, or of a snapshot on an empty model. @return clusters that it touched */
  apply(bytes: Uint8Array): Set<number> {
    const r = new Reader(bytes);
    if (String.fromCharCode(r.u8(), r.u8(), r.u8(), r.u8()) !== "PSC1") throw new Error("no change of a model");
    this.number = r.u32();
    this.version = r.u32() + r.u32() * 4294967296;
    this.images = r.u32();
    const touched = new Set<number>();
    while (r.at < bytes.length) {
      const id = r.u32(), kind = r.u8(), length = r.u32(), end = r.at + length;
      touched.add(id);
      let cluster = this.clusters.get(id);
      if (!cluster) this.clusters.set(id, cluster = new Cluster(id));
      switch (kind) {
        case 1: place(cluster, r); break;
        case 2: put(cluster, r); break;
        case 3: move(cluster, r); break;
        case 4: drop(cluster, r.ascending(r.u32())); break;
        case 5: poses(cluster, r); break;
        case 6: touched.add(this.handOver(cluster, r)); break;
        case 7: this.clusters.delete(id); break;
        case 8: for (let n = r.u32(); n > 0; --n) cluster.poses.delete(r.u32()); break;
        default: break; // of a newer server
      }
      r.at = end;
    }
    return touched;
  }

  private handOver(from: Cluster, r: Reader): number {
    const id = r.u32(), target = similarity(r), first = r.u32(), slots = r.ascending(r.u32());
    let to = this.clusters.get(id);
    if (!to) this.clusters.set(id, to = new Cluster(id));
    to.grow(first + slots.length);
    slots.forEach((slot, i) => {
      const at = first + i;
      const p = moved(target, [from.positions[3 * slot], from.positions[3 * slot + 1], from.positions[3 * slot + 2]]);
      to.positions.set(p, 3 * at);
      to.colours.set(from.colours.subarray(3 * slot, 3 * slot + 3), 3 * at);
      to.errors[at] = from.errors[slot];
      to.tracks[at] = from.tracks[slot];
      to.born[at] = from.born[slot];
      to.firsts[at] = from.firsts[slot];
    });
    drop(from, slots);
    to.changed.push(slots.map((_, i) => first + i));
    for (let n = r.u32(); n > 0; --n) {
      const image = r.u32(), pose = from.poses.get(image);
      if (!pose) continue;
      from.poses.delete(image);
      to.poses.set(image, { camera: pose.camera, q: times(pose.q, conjugate(target.q)), centre: moved(target, pose.centre) });
    }
    return id;
  }
}

function similarity(r: Reader): Sim3 {
  return { scale: r.f32(), q: r.floats(4) as Quat, t: r.floats(3) as Vec3 };
}
function place(cluster: Cluster, r: Reader): void {
  cluster.place = similarity(r);
  cluster.part = r.u32();
}
function readPositions(cluster: Cluster, slots: Uint32Array, r: Reader): void {
  const origin = r.floats(3), step = r.f32() / 65535;
  for (let axis = 0; axis < 3; ++axis) {
    const plane = r.plane(slots.length);
    for (let i = 0; i < slots.length; ++i) cluster.positions[3 * slots[i] + axis] = origin[axis] + plane[i] * step;
  }
  cluster.changed.push(slots);
}
function put(cluster: Cluster, r: Reader): void {
  const n = r.u32(), slots = r.ascending(n);
  if (n > 0) cluster.grow(slots[n - 1] + 1);
  readPositions(cluster, slots, r);
  for (let c = 0; c < 3; ++c) for (let i = 0; i < n; ++i) cluster.colours[3 * slots[i] + c] = r.u8();
  for (let i = 0; i < n; ++i) cluster.errors[slots[i]] = r.u8();
  for (let i = 0; i < n; ++i) cluster.tracks[slots[i]] = r.u8();
  for (let i = 0; i < n; ++i) cluster.born[slots[i]] = r.leb();
  for (let i = 0; i < n; ++i) cluster.firsts[slots[i]] = r.leb();
}
function move(cluster: Cluster, r: Reader): void {
  const n = r.u32();
  readPositions(cluster, r.ascending(n), r);
}
function drop(cluster: Cluster, slots: Uint32Array): void {
  for (const slot of slots) cluster.born[slot] = NOWHERE;
  cluster.changed.push(slots);
}
function poses(cluster: Cluster, r: Reader): void {
  for (let n = r.u32(); n > 0; --n) {
    const image = r.u32(), camera = r.u32();
    cluster.poses.set(image, { camera, q: r.floats(4) as Quat, centre: r.floats(3) as Vec3 });
  }
}

/** A camera in the world. */
export interface WorldPose { image: number; camera: number; cluster: number; part: number; q: Quat; centre: Vec3 }
export function worldPoses(model: Model): WorldPose[] {
  const all: WorldPose[] = [];
  for (const cluster of model.clusters.values()) {
    for (const [image, pose] of cluster.poses) {
      all.push({ image, camera: pose.camera, cluster: cluster.id, part: cluster.part,
        q: times(pose.q, conjugate(cluster.place.q)), centre: moved(cluster.place, pose.centre) });
    }
  }
  return all.sort((a, b) => a.image - b.image);
}

export async function gunzip(bytes: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([bytes as BlobPart]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
