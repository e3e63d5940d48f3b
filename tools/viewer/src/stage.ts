// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What is seen: points, cameras and edges, and how one moves among them. Nothing is drawn while nothing changes.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Frusta, lines } from "./cameras";
import { ColourMode, PointCloud } from "./points";
import { DetailLevel } from "./detail_level";
import { Camera, Edge } from "./source";
import { Model, Quat, Vec3, WorldPose, conjugate, moved, rotate, worldPoses } from "./wire";

const UP_ANGLE = 0.1; // [rad]
const LEAST_FREE = 0.35; // of the canvas's height, whatever lies over it
const FEW_POINTS = 30000; // so many are drawn larger
const EDGE_COLOURS: Record<string, number> = { holds: 0x4f86b8, open: 0x8a8f98, implausible: 0xc9882b, apart: 0xc44fc0, contradicts: 0xe0442e };

export interface Picked { cluster: number; slot: number; position: Vec3 }

/** Takes as long as a model does to arrive, and needs none. */
export function rendererOf(canvas: HTMLCanvasElement): THREE.WebGLRenderer {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
  renderer.setClearColor(0x14181d);
  return renderer;
}

export class Stage {
  readonly camera = new THREE.PerspectiveCamera(50, 1, 0.01, 1000);
  controls: OrbitControls;
  private readonly world = new THREE.Scene();
  private readonly clouds = new Map<number, PointCloud>();
  readonly frusta = new Frusta(this.world, () => this.draw());
  private edges: THREE.LineSegments | null = null;
  private marker: THREE.Points | null = null;
  private shifts = new Map<number, Vec3>(); // by part
  private poses: WorldPose[] = [];
  private wanted = false;
  private readonly detail = new DetailLevel();
  private later = 0; // a frame that draws what the last one has left out
  private selected = new Set<number>();
  private replayed: Map<number, { q: Quat; centre: Vec3 }> | null = null;
  private placedAt: ReadonlyMap<number, number> | null = null;
  /** What lies over the canvas, at its top and at its bottom [px]: the model is fitted in between. */
  bars: () => [number, number] = () => [0, 0];
  mode: ColourMode = "colour";
  pointSize = 0; // [px]; 0: by how many there are
  showCameras = true;
  showEdges = false;
  time: number | null = null; // images of the version that is replayed; null: now
  drawn = 0; // points of the last frame, for tests and for who wants to know
  frameMs = 0;

  constructor(readonly canvas: HTMLCanvasElement, readonly renderer: THREE.WebGLRenderer, readonly model: Model, readonly cameras: Map<number, Camera>,
              private edgeList: Edge[], private up: Vec3, readonly userOf: (image: number) => number, private inMetres: boolean) {
    this.camera.up.set(...up);
    this.controls = this.newControls();
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.rebuild(); });
    this.resize();
  }

  /** About the camera's up, which OrbitControls reads once. */
  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.enableDamping = false;
    controls.zoomToCursor = true;
    controls.addEventListener("change", () => {
      this.camera.updateMatrixWorld(); // what is picked does not wait for a frame
      this.detail.move();
      this.draw();
    });
    return controls;
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w === 0 || h === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(w, h, false);
    this.centre();
    this.draw();
  }
  /** What is looked at is in the middle of what is free. @return the free share of the height */
  private centre(): number {
    const { clientWidth: w, clientHeight: h } = this.canvas, [top, bottom] = this.bars(), free = (h - top - bottom) / Math.max(1, h);
    if (w > 0 && h > 0) this.camera.setViewOffset(w, h, 0, free < LEAST_FREE ? 0 : (bottom - top) / 2, w, h);
    return free < LEAST_FREE ? 1 : free;
  }

  private rebuild(): void {
    for (const cloud of this.clouds.values()) { this.world.remove(cloud.object); cloud.dispose(); }
    this.clouds.clear();
    this.refresh();
  }

  /** What is known of the session has become more: its cameras, which way is up, and whether positions place its parts. */
  setFrame(cameras: Camera[], up: Vec3, inMetres: boolean): void {
    for (const camera of cameras) this.cameras.set(camera.id, camera);
    this.inMetres = inMetres;
    const turned = new THREE.Vector3(...up).angleTo(new THREE.Vector3(...this.up));
    if (turned > UP_ANGLE) { // people keep their bearings when it is but a little
      this.up = up;
      this.camera.up.set(...up);
      this.controls.dispose();
      this.controls = this.newControls();
      this.fit();
    }
    this.refresh();
  }

  /** Of a version that is replayed: points of clusters of which a camera stood, once two photographs that see them did. */
  private showClouds(): void {
    for (const cloud of this.clouds.values()) {
      cloud.begin(this.placedAt);
      cloud.object.visible = !this.replayed || [...cloud.cluster.poses.keys()].some((image) => this.replayed!.has(image));
    }
  }

  setEdges(edges: Edge[]): void { this.edgeList = edges; this.drawEdges(); this.draw(); }

  /** refresh() of a model that goes on changing: not all of its points at once. */
  follow(): void {
    this.detail.change();
    this.refresh();
  }
  /** Takes account of what the model has become. */
  refresh(): void {
    for (const [id, cloud] of this.clouds) {
      if (this.model.clusters.get(id) !== cloud.cluster) { this.world.remove(cloud.object); cloud.dispose(); this.clouds.delete(id); }
    }
    for (const cluster of this.model.clusters.values()) {
      let cloud = this.clouds.get(cluster.id);
      if (!cloud) {
        this.clouds.set(cluster.id, cloud = new PointCloud(cluster, this.userOf));
        this.world.add(cloud.object);
      }
      cloud.update();
    }
    this.showClouds();
    this.poses = worldPoses(this.model);
    this.layOut();
    this.drawFrusta();
    this.drawEdges();
    this.draw();
  }

  /** Parts that nothing connects stand beside the first one, unless positions say where. */
  private layOut(): void {
    this.shifts.clear();
    const boxes = new Map<number, THREE.Box3>();
    for (const pose of this.poses) {
      if (!boxes.has(pose.part)) boxes.set(pose.part, new THREE.Box3());
      boxes.get(pose.part)!.expandByPoint(new THREE.Vector3(...pose.centre));
    }
    let right = -Infinity;
    for (const part of [...boxes.keys()].sort((a, b) => a - b)) {
      const box = boxes.get(part)!, size = box.getSize(new THREE.Vector3()), margin = 0.75 * Math.max(size.x, size.y, size.z, 1e-6);
      let shift = 0;
      if (right > -Infinity && !this.inMetres) shift = right - (box.min.x - margin);
      this.shifts.set(part, [shift, 0, 0]);
      right = Math.max(right, box.max.x + shift + margin);
    }
    for (const cluster of this.model.clusters.values()) {
      const object = this.clouds.get(cluster.id)?.object, shift = this.shifts.get(cluster.part);
      if (!object || !shift) continue;
      object.matrix.elements[12] = cluster.place.t[0] + shift[0];
      object.matrixWorldNeedsUpdate = true;
    }
  }
  private shifted(part: number, v: Vec3): Vec3 {
    const s = this.shifts.get(part) ?? [0, 0, 0];
    return [v[0] + s[0], v[1] + s[1], v[2] + s[2]];
  }

  /** Cameras as shown: those of now, or of the version that is replayed. */
  shownPoses(): WorldPose[] {
    if (!this.replayed) return this.poses;
    const now = new Map(this.poses.map((pose) => [pose.image, pose]));
    return [...this.replayed].map(([image, pose]) => ({ image, q: pose.q, centre: pose.centre,
      camera: now.get(image)?.camera ?? -1, cluster: now.get(image)?.cluster ?? -1, part: now.get(image)?.part ?? 0 }));
  }
  /** @param placedAt  photographs that had come when each was placed first */
  setReplay(images: number | null, poses: Map<number, { q: Quat; centre: Vec3 }> | null, placedAt: ReadonlyMap<number, number> | null = null): void {
    this.time = images;
    this.replayed = poses;
    this.placedAt = placedAt;
    this.showClouds();
    this.drawFrusta();
    this.drawEdges();
    this.draw();
  }

  frustumSize(): number {
    const centres = this.poses.map((pose) => pose.centre);
    if (centres.length < 2) return 0.2;
    const box = new THREE.Box3().setFromPoints(centres.map((c) => new THREE.Vector3(...c)));
    return Math.max(box.getSize(new THREE.Vector3()).length() / Math.min(60, 8 + centres.length), 1e-6);
  }

  private drawFrusta(): void {
    const poses = this.showCameras ? this.shownPoses().map((pose) => ({ ...pose, centre: this.shifted(pose.part, pose.centre) })) : [];
    this.frusta.draw(poses, this.cameras, this.frustumSize(), this.selected);
  }

  private drawEdges(): void {
    if (this.edges) { this.world.remove(this.edges); this.edges.geometry.dispose(); (this.edges.material as THREE.Material).dispose(); this.edges = null; }
    if (!this.showEdges) return;
    const places = new Map(this.shownPoses().map((pose) => [pose.image, this.shifted(pose.part, pose.centre)]));
    const most = this.edgeList.reduce((m, e) => Math.max(m, e[2]), 1), positions: number[] = [], colours: number[] = [];
    for (const [a, b, matches, state] of this.edgeList) {
      const from = places.get(a), to = places.get(b);
      if (!from || !to) continue;
      const c = new THREE.Color(EDGE_COLOURS[state] ?? 0x888888).multiplyScalar(0.3 + 0.7 * Math.log1p(matches) / Math.log1p(most));
      positions.push(...from, ...to);
      colours.push(c.r, c.g, c.b, c.r, c.g, c.b);
    }
    this.edges = lines(positions, colours, 0.4);
    this.world.add(this.edges);
  }

  select(images: number[]): void {
    this.selected = new Set(images);
    this.drawFrusta();
    this.draw();
  }
  mark(position: Vec3 | null, part = 0): void {
    if (this.marker) { this.world.remove(this.marker); this.marker.geometry.dispose(); this.marker = null; }
    if (position) {
      const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(this.shifted(part, position), 3));
      this.marker = new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0xffd24a, size: 10, sizeAttenuation: false, depthTest: false }));
      this.world.add(this.marker);
    }
    this.draw();
  }
  setLayers(cameras: boolean, edges: boolean): void {
    this.showCameras = cameras;
    this.showEdges = edges;
    this.drawFrusta();
    this.drawEdges();
    this.draw();
  }

  /** Looks at everything that belongs to the model, or at some images and what they see; the few points that lie far out
      do not count. */
  fit(images: number[] | null = null): void {
    const some = images ? new Set(images) : null, poses = this.shownPoses().filter((p) => !some || some.has(p.image));
    if (poses.length === 0) return;
    const centres = poses.map((p) => new THREE.Vector3(...this.shifted(p.part, p.centre)));
    const samples = centres.concat(this.sample(2000, some));
    const middle = new THREE.Vector3(...[0, 1, 2].map((axis) => median(samples.map((s) => s.getComponent(axis)))) as Vec3);
    const distances = samples.map((s) => s.distanceTo(middle)).sort((a, b) => a - b);
    const least = 3 * this.frustumSize(), reach = Math.max(distances[Math.floor(0.94 * (distances.length - 1))], least);
    const kept = samples.filter((sample, i) => i < centres.length || sample.distanceTo(middle) <= reach);
    const kind = some ? this.camera.position.clone().sub(this.controls.target) : this.backOf(poses);
    if (kind.lengthSq() < 1e-12) kind.copy(this.backOf(poses));

    // As near as all of them are seen between the two bars.
    const basis = new THREE.Matrix4().lookAt(kind, new THREE.Vector3(), this.camera.up), x = new THREE.Vector3(), y = new THREE.Vector3(), z = new THREE.Vector3();
    basis.extractBasis(x, y, z);
    const range = (axis: THREE.Vector3): [number, number] => {
      const values = kept.map((k) => k.dot(axis));
      return [Math.min(...values), Math.max(...values)];
    };
    const mid = ([low, high]: [number, number]): number => (low + high) / 2;
    const target = new THREE.Vector3().addScaledVector(x, mid(range(x))).addScaledVector(y, mid(range(y))).addScaledVector(z, mid(range(z)));
    const tan = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2)), free = this.centre();
    let distance = 2 * least;
    for (const k of kept) {
      const d = k.clone().sub(target);
      distance = Math.max(distance, d.dot(z) + 1.05 * Math.max(Math.abs(d.dot(x)) / (tan * this.camera.aspect), Math.abs(d.dot(y)) / (tan * free)));
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(z, distance);
    this.camera.near = distance / 500;
    this.camera.far = distance * 50;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }
  /** From behind the cameras and above them; where they look all ways, from a side. */
  private backOf(poses: WorldPose[]): THREE.Vector3 {
    const up = this.camera.up.clone().normalize(), back = new THREE.Vector3();
    for (const pose of poses) back.sub(new THREE.Vector3(...rotate(conjugate(pose.q), [0, 0, 1])));
    back.divideScalar(poses.length).addScaledVector(up, -back.dot(up));
    if (back.length() < 0.3) {
      const side = Math.abs(up.x) < 0.9 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0);
      return side.addScaledVector(up, -side.dot(up)).normalize().addScaledVector(up, 1);
    }
    const right = new THREE.Vector3().crossVectors(up, back).normalize(); // a little from the side: depth is seen
    return back.normalize().addScaledVector(right, 0.4).addScaledVector(up, 0.5);
  }
  /** Some points; of some images, those that they were the first to see. */
  private sample(most: number, images: Set<number> | null): THREE.Vector3[] {
    const found: THREE.Vector3[] = [];
    for (const cluster of this.model.clusters.values()) {
      const cloud = this.clouds.get(cluster.id), stride = images ? 1 : Math.max(1, Math.floor(cluster.slots * this.model.clusters.size / most));
      for (let i = 0; i < cluster.slots && found.length < most; i += stride) {
        if (!cloud?.shows(i, this.time) || (images && !images.has(cluster.firsts[i]))) continue;
        const p = moved(cluster.place, [cluster.positions[3 * i], cluster.positions[3 * i + 1], cluster.positions[3 * i + 2]]);
        found.push(new THREE.Vector3(...this.shifted(cluster.part, p)));
      }
    }
    return found;
  }

  /** The point nearest to a pixel of the canvas, within some pixels; of two, the nearer to the eye. */
  pickPoint(x: number, y: number, reach = 6): Picked | null {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight;
    let best: Picked | null = null, bestDepth = Infinity;
    const matrix = new THREE.Matrix4();
    for (const cloud of this.clouds.values()) {
      matrix.multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse).multiply(cloud.object.matrix);
      const e = matrix.elements, c = cloud.cluster, p = c.positions;
      for (let i = 0; i < c.slots; ++i) {
        if (!cloud.shows(i, this.time)) continue;
        const px = p[3 * i], py = p[3 * i + 1], pz = p[3 * i + 2];
        const depth = e[3] * px + e[7] * py + e[11] * pz + e[15];
        if (depth <= 0 || depth >= bestDepth) continue;
        const sx = ((e[0] * px + e[4] * py + e[8] * pz + e[12]) / depth * 0.5 + 0.5) * w;
        const sy = (0.5 - (e[1] * px + e[5] * py + e[9] * pz + e[13]) / depth * 0.5) * h;
        if (Math.abs(sx - x) > reach || Math.abs(sy - y) > reach) continue;
        bestDepth = depth;
        best = { cluster: c.id, slot: i, position: moved(c.place, [px, py, pz]) };
      }
    }
    return best;
  }
  pickCamera(x: number, y: number, reach = 12): number | null {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight;
    let best: number | null = null, nearest = reach;
    if (!this.showCameras) return null;
    for (const pose of this.shownPoses()) {
      const at = new THREE.Vector3(...this.shifted(pose.part, pose.centre)).project(this.camera);
      if (at.z > 1) continue;
      const d = Math.hypot((at.x * 0.5 + 0.5) * w - x, (0.5 - at.y * 0.5) * h - y);
      if (d < nearest) { nearest = d; best = pose.image; }
    }
    return best;
  }
  screenOf(image: number): { x: number; y: number } | null {
    const pose = this.shownPoses().find((p) => p.image === image);
    if (!pose) return null;
    const at = new THREE.Vector3(...this.shifted(pose.part, pose.centre)).project(this.camera);
    return { x: (at.x * 0.5 + 0.5) * this.canvas.clientWidth, y: (0.5 - at.y * 0.5) * this.canvas.clientHeight };
  }

  /** By keys: about what is looked at [rad]. */
  turn(dx: number, dy: number): void {
    const up = this.camera.up.clone().normalize(), away = this.camera.position.clone().sub(this.controls.target);
    away.applyAxisAngle(up, -dx);
    const right = new THREE.Vector3().crossVectors(up, away).normalize(), tilted = away.clone().applyAxisAngle(right, dy);
    if (Math.abs(tilted.clone().normalize().dot(up)) < 0.99) away.copy(tilted);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
  }
  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  sizeOfPoints(): number {
    if (this.pointSize > 0) return this.pointSize;
    return this.points() < FEW_POINTS ? 3 : 2;
  }
  private points(): number { return [...this.clouds.values()].reduce((n, cloud) => n + cloud.count, 0); }

  draw(): void {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => this.frame());
  }
  private frame(): void {
    this.wanted = false;
    const start = performance.now(), budget = this.detail.begin(this.points());
    this.drawn = 0;
    for (const cloud of this.clouds.values()) {
      cloud.set(this.mode, this.sizeOfPoints() * this.renderer.getPixelRatio(), this.time);
      this.drawn += cloud.draw(this.detail.share);
    }
    if (!this.detail.isMoving && this.frusta.hang(this.camera, this.canvas.clientHeight)) this.draw();
    this.renderer.render(this.world, this.camera);
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // else only the queueing is timed
    this.frameMs = performance.now() - start;
    const again = this.detail.end(budget, this.frameMs);
    clearTimeout(this.later);
    if (again === 0) this.draw(); else if (again !== null) this.later = window.setTimeout(() => this.draw(), again);
  }
}

function median(values: number[]): number {
  const sorted = values.slice().sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}
