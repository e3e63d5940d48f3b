// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What is seen: points, cameras and edges, and how one moves among them. Nothing is drawn while nothing changes.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ColourMode, PointCloud } from "./points";
import { Camera, Edge } from "./source";
import { Model, NOWHERE, Quat, Vec3, WorldPose, conjugate, moved, rotate, worldPoses } from "./wire";

const FRAME_MS = 33; // while one moves: as many points as this allows
const EDGE_COLOURS: Record<string, number> = { holds: 0x4f86b8, open: 0x8a8f98, implausible: 0xc9882b, apart: 0xc44fc0, contradicts: 0xe0442e };

export interface Picked { cluster: number; slot: number; position: Vec3 }

export class Stage {
  readonly renderer: THREE.WebGLRenderer;
  readonly camera = new THREE.PerspectiveCamera(50, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  private readonly world = new THREE.Scene();
  private readonly clouds = new Map<number, PointCloud>();
  private frusta: THREE.LineSegments | null = null;
  private edges: THREE.LineSegments | null = null;
  private marker: THREE.Points | null = null;
  private shifts = new Map<number, Vec3>(); // by part
  private poses: WorldPose[] = [];
  private wanted = false;
  private share = 1; // of the points that are drawn
  private moving = 0; // until when [ms]
  private selected = new Set<number>();
  private replayed: Map<number, { q: Quat; centre: Vec3 }> | null = null;
  mode: ColourMode = "colour";
  pointSize = 2;
  showCameras = true;
  showEdges = false;
  time: number | null = null; // images of the version that is replayed; null: now
  drawn = 0; // points of the last frame, for tests and for who wants to know
  frameMs = 0;

  constructor(readonly canvas: HTMLCanvasElement, readonly model: Model, readonly cameras: Map<number, Camera>,
              private edgeList: Edge[], private up: Vec3, readonly userOf: (image: number) => number, readonly inMetres: boolean) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this.renderer.setClearColor(0x14181d);
    this.camera.up.set(...up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => { this.moving = performance.now() + 250; this.draw(); });
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.rebuild(); });
    this.resize();
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (w === 0 || h === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private rebuild(): void {
    for (const cloud of this.clouds.values()) { this.world.remove(cloud.object); cloud.dispose(); }
    this.clouds.clear();
    this.refresh();
  }

  setEdges(edges: Edge[]): void { this.edgeList = edges; this.drawEdges(); this.draw(); }

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
  setReplay(images: number | null, poses: Map<number, { q: Quat; centre: Vec3 }> | null): void {
    this.time = images;
    this.replayed = poses;
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
    if (this.frusta) { this.world.remove(this.frusta); this.frusta.geometry.dispose(); (this.frusta.material as THREE.Material).dispose(); this.frusta = null; }
    if (!this.showCameras) return;
    const size = this.frustumSize(), positions: number[] = [], colours: number[] = [];
    for (const pose of this.shownPoses()) {
      const camera = this.cameras.get(pose.camera), w = camera ? camera.width / camera.focal / 2 : 0.5, h = camera ? camera.height / camera.focal / 2 : 0.375;
      const back = conjugate(pose.q), centre = this.shifted(pose.part, pose.centre);
      const corner = (x: number, y: number): Vec3 => {
        const d = rotate(back, [x * w * size, y * h * size, size]);
        return [centre[0] + d[0], centre[1] + d[1], centre[2] + d[2]];
      };
      const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
      const colour = this.selected.has(pose.image) ? [1, 0.75, 0.2] : [0.35, 0.75, 0.55];
      for (let i = 0; i < 4; ++i) {
        positions.push(...centre, ...corners[i], ...corners[i], ...corners[(i + 1) % 4]);
        for (let k = 0; k < 4; ++k) colours.push(...colour);
      }
    }
    this.frusta = lines(positions, colours);
    this.world.add(this.frusta);
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
    this.edges = lines(positions, colours);
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

  /** Looks at everything that belongs to the model; the few points that lie far out do not count. */
  fit(images: number[] | null = null): void {
    const some = images ? new Set(images) : null;
    const centres = this.shownPoses().filter((p) => !some || some.has(p.image)).map((p) => new THREE.Vector3(...this.shifted(p.part, p.centre)));
    if (centres.length === 0) return;
    const samples = some ? centres : centres.concat(this.sample(2000));
    const middle = new THREE.Vector3(...[0, 1, 2].map((axis) => median(samples.map((s) => s.getComponent(axis)))) as Vec3);
    const distances = samples.map((s) => s.distanceTo(middle)).sort((a, b) => a - b);
    const radius = Math.max(distances[Math.floor(0.92 * (distances.length - 1))], some ? 6 * this.frustumSize() : 1e-6);
    const up = new THREE.Vector3(...this.up).normalize();
    let away = this.camera.position.clone().sub(this.controls.target);
    if (some === null || away.lengthSq() < 1e-12) {
      const side = Math.abs(up.x) < 0.9 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0);
      away = side.sub(up.clone().multiplyScalar(side.dot(up))).normalize().add(up.clone().multiplyScalar(0.8));
    }
    const distance = radius / Math.sin(THREE.MathUtils.degToRad(this.camera.fov / 2)) / Math.min(1, this.camera.aspect);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(away.normalize().multiplyScalar(distance));
    this.camera.near = distance / 500;
    this.camera.far = distance * 50;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }
  private sample(most: number): THREE.Vector3[] {
    const found: THREE.Vector3[] = [];
    for (const cluster of this.model.clusters.values()) {
      const stride = Math.max(1, Math.floor(cluster.slots * this.model.clusters.size / most));
      for (let i = 0; i < cluster.slots; i += stride) {
        if (cluster.born[i] === NOWHERE) continue;
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
        if (c.born[i] === NOWHERE || (this.time !== null && c.born[i] > this.time)) continue;
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

  draw(): void {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => this.frame());
  }
  private frame(): void {
    this.wanted = false;
    const start = performance.now(), isMoving = start < this.moving;
    if (!isMoving) this.share = Math.min(1, this.share * 2);
    this.drawn = 0;
    for (const cloud of this.clouds.values()) {
      cloud.set(this.mode, this.pointSize * this.renderer.getPixelRatio(), this.time);
      this.drawn += cloud.draw(this.share);
    }
    this.renderer.render(this.world, this.camera);
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // else only the queueing is timed
    this.frameMs = performance.now() - start;
    if (isMoving) {
      this.share = Math.min(1, Math.max(0.01, this.share * Math.min(1.5, Math.max(0.3, FRAME_MS / Math.max(this.frameMs, 1)))));
      setTimeout(() => this.draw(), 260); // what was left out is drawn when one stands still
    } else if (this.share < 1) {
      this.draw();
    }
  }
}

function lines(positions: number[], colours: number[]): THREE.LineSegments {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  const object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.85 }));
  object.frustumCulled = false;
  return object;
}
function median(values: number[]): number {
  const sorted = values.slice().sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}
