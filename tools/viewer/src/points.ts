// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The points of one cluster on the graphics card. They lie there in order of their slots, so that a change is
// uploaded where it is, since few of many change at a time; an index names them in a random order, of which as many are drawn as there is time for.
import * as THREE from "three";
import { Cluster, NOWHERE } from "./wire";

export type ColourMode = "colour" | "error" | "track" | "cluster" | "user";
const MODES: ColourMode[] = ["colour", "error", "track", "cluster", "user"];
/** What the colours mean; the figures are the shader's. */
export const LEGENDS: Record<ColourMode, string> = { colour: "", error: "blue 0, red 2 px and more", track: "blue 2, red 32 photographs and more",
  cluster: "a colour a cluster", user: "a colour a user" };

const VERTEX = `
attribute vec4 paint; attribute float track; attribute float born; attribute float user;
uniform float size; uniform float time; uniform int mode; uniform vec3 own; varying vec3 shade;
vec3 ramp(float t) { // blue, green, yellow, red: all of them light enough for a dark ground
  t = 3.0 * clamp(t, 0.0, 1.0);
  vec3 green = vec3(0.35, 0.85, 0.62), yellow = vec3(0.97, 0.85, 0.32);
  return t < 1.0 ? mix(vec3(0.34, 0.58, 0.98), green, t) : t < 2.0 ? mix(green, yellow, t - 1.0) : mix(yellow, vec3(0.96, 0.32, 0.25), t - 2.0);
}
vec3 hue(float n) { return 0.55 + 0.45 * cos(6.2831 * (n * 0.618 + vec3(0.0, 0.33, 0.67))); }
void main() {
  if (born > time) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); gl_PointSize = 0.0; return; }
  vec3 colour = paint.rgb;
  // Features without a colour (imported ones) are black, which would be nothing on a dark ground.
  shade = mode == 0 ? (colour == vec3(0.0) ? vec3(0.75, 0.79, 0.83) : colour) : mode == 1 ? ramp(paint.a * 255.0 * 0.02 / 2.0) : mode == 2 ? ramp(log2(track * 255.0 / 2.0 + 0.001) / 4.0) : mode == 3 ? own : hue(user);
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * at;
  gl_PointSize = size;
}`;
const FRAGMENT = `varying vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }`;
// Times in the card's floats, which tell them apart: now is later than what no version of a replay has.
const LATER = 1e9, NOW = 2e9, NEVER = 3e9;

const BLOCK = 1024; // slots that are uploaded together: a call costs more than they
const MOST_RANGES = 2000; // that wait for a frame; with more than these all is uploaded

export function hueOf(n: number): THREE.Color {
  return new THREE.Color().setHSL((n * 0.618034) % 1, 0.65, 0.6);
}

export class PointCloud {
  readonly object: THREE.Points;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material: THREE.ShaderMaterial;
  private paint = new Uint8Array(0); // colour and error: cards have no attributes of three bytes, and rewrite those all
  private born = new Float32Array(0); // photographs that had come when each point appeared
  private user = new Float32Array(0);
  private readonly order = new Shuffled();
  private placedAt: ReadonlyMap<number, number> | null = null;
  count = 0; // slots

  constructor(readonly cluster: Cluster, readonly userOf: (image: number) => number) {
    this.material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT,
      uniforms: { size: { value: 2 }, time: { value: NOW }, mode: { value: 0 }, own: { value: hueOf(cluster.id) } } });
    this.object = new THREE.Points(this.geometry, this.material);
    this.object.matrixAutoUpdate = false;
    this.object.frustumCulled = false;
    this.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), Infinity);
    this.update();
  }

  /** Uploads what has changed. */
  update(): void {
    const c = this.cluster, p = c.place;
    this.object.matrix.compose(new THREE.Vector3(...p.t), new THREE.Quaternion(...p.q), new THREE.Vector3(p.scale, p.scale, p.scale));
    this.object.matrixWorldNeedsUpdate = true;
    const changed = c.changed;
    c.changed = [];
    if (c.born.length !== this.born.length) this.buildFor(c.born.length); // a buffer that grows is a new one
    else this.refill(changed);
    if (c.slots === this.count) return;
    this.count = c.slots;
    this.order.grow(c.slots);
    this.geometry.index!.needsUpdate = true;
  }
  private buildFor(room: number): void {
    const c = this.cluster;
    this.geometry.dispose();
    this.paint = new Uint8Array(4 * room);
    this.born = new Float32Array(room);
    this.user = new Float32Array(room);
    for (let slot = 0; slot < c.slots; ++slot) this.fill(slot);
    this.order.makeRoom(room);
    this.geometry.setIndex(new THREE.BufferAttribute(this.order.values, 1));
    this.attribute("position", c.positions, 3, false);
    this.attribute("paint", this.paint, 4, true);
    this.attribute("track", c.tracks, 1, true);
    this.attribute("born", this.born, 1, false);
    this.attribute("user", this.user, 1, false);
  }
  private refill(changed: Uint32Array[]): void {
    const blocks = new Set<number>(), all = Object.values(this.geometry.attributes) as THREE.BufferAttribute[];
    const take = (slot: number): void => { this.fill(slot); blocks.add(Math.floor(slot / BLOCK)); };
    for (const slots of changed) slots.forEach(take);
    for (let slot = this.count; slot < this.cluster.slots; ++slot) take(slot); // those that no point ever was in, too
    for (const attribute of blocks.size > 0 ? all : []) {
      for (const block of blocks) attribute.addUpdateRange(block * BLOCK * attribute.itemSize, Math.min(BLOCK, this.born.length - block * BLOCK) * attribute.itemSize);
      if (attribute.updateRanges.length > MOST_RANGES) upload(attribute); else attribute.needsUpdate = true;
    }
  }
  private fill(slot: number): void {
    const c = this.cluster;
    for (let k = 0; k < 3; ++k) this.paint[4 * slot + k] = c.colours[3 * slot + k];
    this.paint[4 * slot + 3] = c.errors[slot];
    this.user[slot] = this.userOf(c.firsts[slot]);
    this.born[slot] = this.begins(slot);
  }
  /** The two photographs that saw a point first have to be placed, as well as the replay knows. */
  private begins(slot: number): number {
    const c = this.cluster, at = this.placedAt, second = c.born[slot];
    if (second === NOWHERE) return NEVER;
    return at ? Math.max(second, at.get(c.firsts[slot]) ?? LATER, at.get(second - 1) ?? LATER) : second;
  }
  /** @param placedAt  photographs that had come when each was placed first, of a replay; null: as they came */
  begin(placedAt: ReadonlyMap<number, number> | null): void {
    if (placedAt === this.placedAt) return;
    this.placedAt = placedAt;
    if (this.count === 0) return; // nothing was ever uploaded
    for (let slot = 0; slot < this.cluster.slots; ++slot) this.born[slot] = this.begins(slot);
    upload(this.geometry.getAttribute("born") as THREE.BufferAttribute);
  }
  /** Whether a point is seen, now or at the version of so many photographs. */
  shows(slot: number, time: number | null): boolean {
    return this.object.visible && this.born[slot] <= (time ?? NOW);
  }
  private attribute(name: string, array: Float32Array | Uint8Array, size: number, normalised: boolean): void {
    const attribute = new THREE.BufferAttribute(array, size, normalised);
    attribute.setUsage(THREE.DynamicDrawUsage);
    this.geometry.setAttribute(name, attribute);
  }
  draw(share: number): number {
    const n = Math.max(Math.min(this.count, 200), Math.floor(this.count * share));
    this.geometry.setDrawRange(0, n);
    return Math.min(n, this.count);
  }
  set(mode: ColourMode, size: number, time: number | null): void {
    this.material.uniforms.mode.value = MODES.indexOf(mode);
    this.material.uniforms.size.value = size;
    this.material.uniforms.time.value = time ?? NOW;
  }
  dispose(): void { this.geometry.dispose(); this.material.dispose(); }
}

/** All of it, whatever is asked for before the next frame. */
function upload(attribute: THREE.BufferAttribute): void {
  attribute.clearUpdateRanges();
  attribute.addUpdateRange(0, attribute.array.length);
  attribute.needsUpdate = true;
}

/** 0 … n-1 in an order of which every beginning is spread over the whole; the same for equal n. */
class Shuffled {
  values = new Uint32Array(0);
  private n = 0;
  private seed = 12345;

  makeRoom(room: number): void {
    const before = this.values;
    this.values = new Uint32Array(room);
    this.values.set(before);
  }
  grow(n: number): void {
    for (; this.n < n; ++this.n) {
      this.seed = (Math.imul(this.seed, 1664525) + 1013904223) >>> 0;
      const j = this.seed % (this.n + 1);
      this.values[this.n] = this.values[j];
      this.values[j] = this.n;
    }
  }
}
