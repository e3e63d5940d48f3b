// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Cameras as frusta; those that are near or chosen hold their photographs, which are fetched when they are wanted.
import * as THREE from "three";
import { Camera } from "./source";
import { Vec3, WorldPose, conjugate, rotate } from "./wire";

const MOST_PICTURES = 40; // that hang in frusta at a time
const MOST_FETCHED = 4; // at a time: others want the connection, too
const SEEN_PX = 24; // a frustum that is lower shows nothing of its photograph

interface Picture { mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>; texture: THREE.Texture | null }
interface Frustum { image: number; corners: Vec3[] } // top left, top right, bottom right, bottom left

export class Frusta {
  private outlines: THREE.LineSegments | null = null;
  private frusta: Frustum[] = [];
  private chosen: ReadonlySet<number> = new Set();
  private readonly pictures = new Map<number, Picture>();
  private readonly without = new Set<number>(); // images of which there is no thumbnail
  private waiting: number[] = [];
  private fetched = 0;
  thumbnail: (image: number) => string | null = () => null;
  showPictures = false;

  constructor(private readonly world: THREE.Scene, private readonly changed: () => void) {}

  /** @param poses  with their centres where they are shown */
  draw(poses: WorldPose[], cameras: Map<number, Camera>, size: number, chosen: ReadonlySet<number>): void {
    if (this.outlines) { this.world.remove(this.outlines); free(this.outlines); this.outlines = null; }
    this.chosen = chosen;
    const positions: number[] = [], colours: number[] = [];
    this.frusta = poses.map((pose) => {
      const camera = cameras.get(pose.camera), w = camera ? camera.width / camera.focal / 2 : 0.5, h = camera ? camera.height / camera.focal / 2 : 0.375;
      const back = conjugate(pose.q), centre = pose.centre;
      const corner = (x: number, y: number): Vec3 => {
        const d = rotate(back, [x * w * size, y * h * size, size]);
        return [centre[0] + d[0], centre[1] + d[1], centre[2] + d[2]];
      };
      const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
      const colour = chosen.has(pose.image) ? [1, 0.75, 0.2] : [0.35, 0.75, 0.55];
      for (let i = 0; i < 4; ++i) {
        positions.push(...centre, ...corners[i], ...corners[i], ...corners[(i + 1) % 4]);
        for (let k = 0; k < 4; ++k) colours.push(...colour);
      }
      return { image: pose.image, corners };
    });
    if (positions.length > 0) this.world.add(this.outlines = lines(positions, colours, 0.9));
    const shown = new Map(this.frusta.map((frustum) => [frustum.image, frustum]));
    for (const [image, picture] of this.pictures) {
      const frustum = shown.get(image);
      if (frustum) picture.mesh.geometry.setAttribute("position", cornersOf(frustum)); else this.drop(image);
    }
  }

  /** Hangs the photographs that one can see something of, the chosen and the largest first. @return whether any changed */
  hang(eye: THREE.PerspectiveCamera, height_px: number): boolean {
    const wanted = this.showPictures ? this.wanted(eye, height_px) : [], keep = new Set(wanted.map((frustum) => frustum.image));
    let changed = false;
    for (const image of [...this.pictures.keys()]) if (!keep.has(image)) { this.drop(image); changed = true; }
    for (const frustum of wanted) if (!this.pictures.has(frustum.image)) this.pictures.set(frustum.image, { mesh: sheet(frustum), texture: null });
    this.waiting = wanted.map((frustum) => frustum.image).filter((image) => this.pictures.get(image)!.texture === null);
    this.fetch();
    return changed;
  }
  get hung(): number[] { return [...this.pictures].filter(([, picture]) => picture.texture?.image).map(([image]) => image); }

  private wanted(eye: THREE.PerspectiveCamera, height_px: number): Frustum[] {
    const perDepth = height_px / (2 * Math.tan(THREE.MathUtils.degToRad(eye.fov / 2))), at = new THREE.Vector3();
    const sizes: [number, Frustum][] = [];
    for (const frustum of this.frusta) {
      const [a, , c, d] = frustum.corners;
      if (this.without.has(frustum.image)) continue;
      at.set((a[0] + c[0]) / 2, (a[1] + c[1]) / 2, (a[2] + c[2]) / 2);
      const depth = -at.clone().applyMatrix4(eye.matrixWorldInverse).z, place = at.project(eye);
      if (depth <= eye.near || Math.abs(place.x) > 1.2 || Math.abs(place.y) > 1.2) continue;
      const px = Math.hypot(d[0] - a[0], d[1] - a[1], d[2] - a[2]) * perDepth / depth;
      if (this.chosen.has(frustum.image)) sizes.push([Infinity, frustum]);
      else if (px >= SEEN_PX) sizes.push([px, frustum]);
    }
    return sizes.sort((one, two) => (one[0] === two[0] ? 0 : two[0] - one[0])).slice(0, MOST_PICTURES).map(([, frustum]) => frustum);
  }
  private fetch(): void {
    while (this.fetched < MOST_FETCHED && this.waiting.length > 0) {
      const image = this.waiting.shift()!, url = this.thumbnail(image), picture = this.pictures.get(image);
      if (!picture || picture.texture) continue;
      if (url === null) { this.drop(image); this.without.add(image); continue; }
      ++this.fetched;
      const next = (): void => { --this.fetched; this.fetch(); this.changed(); };
      picture.texture = new THREE.TextureLoader().load(url, (texture) => {
        texture.colorSpace = THREE.SRGBColorSpace;
        texture.anisotropy = 4; // frusta are seen from the side
        if (this.pictures.get(image) === picture) {
          picture.mesh.material.map = texture;
          this.world.add(picture.mesh);
        } else {
          texture.dispose();
        }
        next();
      }, undefined, () => { if (this.pictures.get(image) === picture) this.drop(image); this.without.add(image); next(); });
    }
  }
  private drop(image: number): void {
    const picture = this.pictures.get(image);
    if (!picture) return;
    this.pictures.delete(image);
    this.world.remove(picture.mesh);
    free(picture.mesh);
    picture.texture?.dispose();
  }
  /** Thumbnails that were not to be had may be there by now. */
  tryAgain(): void { this.without.clear(); }
}

function cornersOf(frustum: Frustum): THREE.Float32BufferAttribute { return new THREE.Float32BufferAttribute(frustum.corners.flat(), 3); }
function sheet(frustum: Frustum): Picture["mesh"] {
  const geometry = new THREE.BufferGeometry().setAttribute("position", cornersOf(frustum));
  geometry.setAttribute("uv", new THREE.Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 0], 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ side: THREE.DoubleSide }));
  mesh.frustumCulled = false;
  return mesh;
}
function free(object: THREE.LineSegments | THREE.Mesh): void {
  object.geometry.dispose();
  (object.material as THREE.Material).dispose();
}
export function lines(positions: number[], colours: number[], opacity: number): THREE.LineSegments {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  const object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity }));
  object.frustumCulled = false;
  return object;
}
