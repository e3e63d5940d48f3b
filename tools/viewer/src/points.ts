// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// The points of one cluster on the graphics card. They lie there in order of their slots, so that a change is
// uploaded where it is; an index names them in a random order, of which as many are drawn as there is time for.
import * as THREE from "three";
import { Cluster, NOWHERE } from "./wire";

export type ColourMode = "colour" | "error" | "track" | "cluster" | "user";
const MODES: ColourMode[] = ["colour", "error", "track", "cluster", "user"];
/** What the colours mean; the figures are the shader's. */
export const LEGENDS: Record<ColourMode, string> = { colour: "", error: "blue 0, red 2 px and more", track: "blue 2, red 32 photographs and more",
  cluster: "a colour a cluster", user: "a colour a user" };

const VERTEX = `
attribute vec3 colour; attribute vec2 figures; attribute float born; attribute float user;
uniform float size; uniform float time; uniform int mode; uniform vec3 own; varying vec3 shade;
vec3 ramp(float t) { // blue, green, yellow, red: all of them light enough for a dark ground
  t = 3.0 * clamp(t, 0.0, 1.0);
  vec3 green = vec3(0.35, 0.85, 0.62), yellow = vec3(0.97, 0.85, 0.32);
  return t < 1.0 ? mix(vec3(0.34, 0.58, 0.98), green, t) : t < 2.0 ? mix(green, yellow, t - 1.0) : mix(yellow, vec3(0.96, 0.32, 0.25), t - 2.0);
}
vec3 hue(float n) { return 0.55 + 0.45 * cos(6.2831 * (n * 0.618 + vec3(0.0, 0.33, 0.67))); }
void main() {
  if (born > time) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); gl_PointSize = 0.0; return; }
  // Features without a colour (imported ones) are black, which would be nothing on a dark ground.
  shade = mode == 0 ? (colour == vec3(0.0) ? vec3(0.75, 0.79, 0.83) : colour) : mode == 1 ? ramp(figures.x * 255.0 * 0.02 / 2.0) : mode == 2 ? ramp(log2(figures.y * 255.0 / 2.0 + 0.001) / 4.0) : mode == 3 ? own : hue(user);
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * at;
  gl_PointSize = size;
}`;
const FRAGMENT = `varying vec3 shade; void main() { gl_FragColor = vec4(shade, 1.0); }`;
// Times in the card's floats, which tell them apart: now is later than what no version of a replay has.
const LATER = 1e9, NOW = 2e9, NEVER = 3e9;

export function hueOf(n: number): THREE.Color {
  return new THREE.Color().setHSL((n * 0.618034) % 1, 0.65, 0.6);
}

export class PointCloud {
  readonly object: THREE.Points;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material: THREE.ShaderMaterial;
  private room = 0;
  private version = -1;
  private born = new Float32Array(0); // photographs that had come when each point appeared
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
    if (this.version === c.version) return;
    this.version = c.version;
    const n = c.slots, figures = new Uint8Array(2 * c.born.length), born = this.begins(), user = new Float32Array(c.born.length);
    for (let i = 0; i < c.born.length; ++i) {
      figures[2 * i] = c.errors[i];
      figures[2 * i + 1] = c.tracks[i];
      user[i] = this.userOf(c.firsts[i]);
    }
    if (c.born.length !== this.room) { // a buffer that grows is a new one
      this.room = c.born.length;
      this.geometry.dispose();
      this.attribute("position", c.positions, 3, false);
      this.attribute("colour", c.colours, 3, true);
      this.attribute("figures", figures, 2, true);
      this.attribute("born", born, 1, false);
      this.attribute("user", user, 1, false);
    } else {
      this.refill("position", c.positions);
      this.refill("colour", c.colours);
      this.refill("figures", figures);
      this.refill("born", born);
      this.refill("user", user);
    }
    if (n !== this.count) {
      this.count = n;
      this.geometry.setIndex(new THREE.BufferAttribute(shuffled(n), 1));
    }
  }
  /** The two photographs that saw a point first have to be placed, as well as the replay knows. */
  private begins(): Float32Array<ArrayBuffer> {
    const c = this.cluster, at = this.placedAt, born = new Float32Array(c.born.length);
    for (let i = 0; i < c.born.length; ++i) {
      const second = c.born[i];
      born[i] = second === NOWHERE ? NEVER : at ? Math.max(second, at.get(c.firsts[i]) ?? LATER, at.get(second - 1) ?? LATER) : second;
    }
    return this.born = born;
  }
  /** @param placedAt  photographs that had come when each was placed first, of a replay; null: as they came */
  begin(placedAt: ReadonlyMap<number, number> | null): void {
    if (placedAt === this.placedAt) return;
    this.placedAt = placedAt;
    this.refill("born", this.begins());
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
  private refill(name: string, array: Float32Array | Uint8Array): void {
    const attribute = this.geometry.getAttribute(name) as THREE.BufferAttribute;
    if (attribute.array !== array) (attribute.array as Float32Array).set(array);
    attribute.needsUpdate = true;
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

/** 0 … n-1 in an order of which every beginning is spread over the whole; the same for equal n. */
function shuffled(n: number): Uint32Array {
  const order = new Uint32Array(n);
  let seed = 12345;
  for (let i = 0; i < n; ++i) {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    const j = seed % (i + 1);
    order[i] = order[j];
    order[j] = i;
  }
  return order;
}
