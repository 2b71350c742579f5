// A body as it is drawn: by itself, or as one of many with the same shape, which a graphics card draws in one go.

import {
  Box3, BufferGeometry, CanvasTexture, Color, DoubleSide, DynamicDrawUsage, FrontSide, Group, InstancedMesh, Matrix4, Mesh,
  MeshLambertMaterial, Quaternion, RepeatWrapping, Vector3, type Object3D,
} from "three";
import { crowd_edges, edges } from "./edges";
import { corners } from "./framing";
import type { Style } from "./looks";
import type { Body, Quaternion as Turn, Vec3 } from "./session";
import { is_open } from "./shapes";

/** What lies over a body's own colour. */
export interface Glow {
  readonly colour: Color;
  readonly strength: number;
  /** How much of the body's own colour is lost beside it, 0 to 1. */
  readonly dims?: number;
}

export interface Drawn {
  /** Puts it into the frame that it is in. */
  place(position_m: Vec3, rotation: Turn): void;
  paint(colour: Color, glow: Glow | null, transparent: number): void;
  show(isVisible: boolean): void;
  /** Whether a click on this object, and on this of its copies, is a click on it. */
  is(object: Object3D, copy: number): boolean;
  bend(style: Style | null): void;
  /** Lets its surface run on by so many metres. */
  run(way_m: number): void;
  /** Where it is in the world, m. */
  where(): Vector3;
  /** The corners of the box about it, in the world, m. */
  corners_m(): readonly Vec3[];
}

/** A belt's stripes are this far apart. */
const STRIPE_M = 0.1;

/** A body that is drawn by itself; others may be in its frame. */
export class Single implements Drawn {
  readonly node: Object3D;
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  private stripes: CanvasTexture | null = null;

  /** In `parent`; `isBent` if looks move it or others are in its frame. */
  constructor(private readonly body: Body, geometry: BufferGeometry, parent: Object3D, isBent: boolean) {
    const side = is_open(body.shape) ? DoubleSide : FrontSide;
    this.mesh = new Mesh(geometry, new MeshLambertMaterial({ side }));
    this.mesh.castShadow = true;
    this.mesh.receiveShadow = true;
    this.mesh.add(edges(geometry));
    this.node = isBent ? new Group().add(this.mesh) : this.mesh;
    parent.add(this.node);
    this.place(body.position_m, body.rotation);
  }

  place(position_m: Vec3, rotation: Turn): void {
    this.node.position.set(...position_m);
    this.node.quaternion.set(...rotation);
  }

  paint(colour: Color, glow: Glow | null, transparent: number): void {
    const material = this.mesh.material;
    material.color.copy(colour).lerp(BLACK, glow?.dims ?? 0);
    material.emissive.copy(glow?.colour ?? BLACK);
    material.emissiveIntensity = glow?.strength ?? 1;
    if (material.transparent !== transparent > 0) {
      material.transparent = transparent > 0;
      material.depthWrite = transparent === 0;
      material.needsUpdate = true;
    }
    material.opacity = 1 - transparent;
    // What one sees through hides nothing from the sun.
    this.mesh.castShadow = transparent === 0;
  }

  show(isVisible: boolean): void {
    // What is in its frame is not hidden with it.
    this.mesh.visible = isVisible;
  }

  is(object: Object3D): boolean {
    return object === this.mesh;
  }

  bend(style: Style | null): void {
    if (this.node === this.mesh || style === null) return;
    const at = new Vector3(...this.body.position_m).add(style.moved_m);
    const turned = new Quaternion(...this.body.rotation);
    for (const { by, about_m } of style.turns) {
      if (about_m !== null) {
        const about = new Vector3(...about_m);
        at.sub(about).applyQuaternion(by).add(about);
      }
      turned.premultiply(by);
    }
    if (this.body.kind === "figure") {
      this.node.position.copy(at);
      this.node.quaternion.copy(turned);
    }
    this.mesh.scale.set(...style.grown).multiplyScalar(style.scale);
    const { min } = this.mesh.geometry.boundingBox ?? new Box3();
    // It grows from its lower end.
    this.mesh.position.set(min.x * (1 - style.grown[0]), min.y * (1 - style.grown[1]), min.z * (1 - style.grown[2]));
  }

  run(way_m: number): void {
    this.stripes ??= this.striped();
    this.stripes.offset.x = -(way_m / STRIPE_M) % 1;
  }

  where(): Vector3 {
    return this.node.getWorldPosition(new Vector3());
  }

  corners_m(): readonly Vec3[] {
    this.mesh.updateWorldMatrix(true, false);
    return corners_of(this.mesh.geometry, this.mesh.matrixWorld);
  }

  /** Stripes along the longest side of a belt. */
  private striped(): CanvasTexture {
    const canvas = document.createElement("canvas");
    canvas.width = 64;
    canvas.height = 4;
    const brush = canvas.getContext("2d");
    if (brush !== null) {
      brush.fillStyle = "#ffffff";
      brush.fillRect(0, 0, 64, 4);
      brush.fillStyle = "#9aa3aa";
      brush.fillRect(0, 0, 10, 4);
    }
    const texture = new CanvasTexture(canvas);
    texture.wrapS = texture.wrapT = RepeatWrapping;
    const size = (this.mesh.geometry.boundingBox ?? new Box3()).getSize(new Vector3());
    const isAlongY = size.y > size.x;
    texture.repeat.set(Math.max(1, Math.round((isAlongY ? size.y : size.x) / STRIPE_M)), 1);
    if (isAlongY) texture.rotation = Math.PI / 2;
    this.mesh.material.map = texture;
    this.mesh.material.needsUpdate = true;
    return texture;
  }
}

/** The corners of the box about a shape, where `matrix` puts it. */
function corners_of(geometry: BufferGeometry, matrix: Matrix4): readonly Vec3[] {
  const { min, max } = geometry.boundingBox ?? new Box3();
  return corners({ low: [min.x, min.y, min.z], high: [max.x, max.y, max.z] }).map((corner) => {
    const { x, y, z } = new Vector3(...corner).applyMatrix4(matrix);
    return [x, y, z];
  });
}

const BLACK = new Color("#000000");
const NOWHERE = new Matrix4().makeScale(0, 0, 0);

/** Bodies of one shape, none of them in another's frame. */
export class Crowd {
  readonly mesh: InstancedMesh<BufferGeometry, MeshLambertMaterial>;
  private count = 0;
  private isMoved = false;

  constructor(geometry: BufferGeometry, most: number, parent: Object3D) {
    this.mesh = new InstancedMesh(geometry, new MeshLambertMaterial(), most);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    // Its members may be anywhere.
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = true;
    this.mesh.receiveShadow = true;
    parent.add(this.mesh, crowd_edges(this.mesh));
  }

  add(body: Body): Member {
    this.count += 1;
    return new Member(this, this.count - 1, body);
  }

  put(slot: number, matrix: Matrix4): void {
    this.mesh.setMatrixAt(slot, matrix);
    this.isMoved = true;
  }

  colour(slot: number, colour: Color): void {
    this.mesh.setColorAt(slot, colour);
    if (this.mesh.instanceColor !== null) this.mesh.instanceColor.needsUpdate = true;
  }

  /** Before a picture is drawn. */
  settle(): void {
    if (!this.isMoved) return;
    this.mesh.instanceMatrix.needsUpdate = true;
    // It is found by a click where it is now.
    this.mesh.boundingSphere = null;
    this.isMoved = false;
  }
}

/** A body that is drawn together with others. */
export class Member implements Drawn {
  private readonly at = new Vector3();
  private readonly turned = new Quaternion();
  private readonly matrix = new Matrix4();
  private isVisible = true;

  constructor(
    private readonly crowd: Crowd,
    private readonly slot: number,
    body: Body,
  ) {
    this.place(body.position_m, body.rotation);
  }

  place(position_m: Vec3, rotation: Turn): void {
    this.at.set(...position_m);
    this.turned.set(...rotation);
    this.put();
  }

  paint(colour: Color, glow: Glow | null): void {
    this.crowd.colour(this.slot, glow === null ? colour : colour.clone().lerp(glow.colour, glow.strength));
  }

  show(isVisible: boolean): void {
    if (this.isVisible === isVisible) return;
    this.isVisible = isVisible;
    this.put();
  }

  /** Whether a click on this object and this one of its copies is a click on it. */
  is(object: Object3D, slot: number): boolean {
    return object === this.crowd.mesh && slot === this.slot;
  }

  bend(): void {
    // Bodies that looks bend are drawn by themselves.
  }

  run(): void {
    // So are belts.
  }

  where(): Vector3 {
    return this.at.clone();
  }

  corners_m(): readonly Vec3[] {
    return corners_of(this.crowd.mesh.geometry, new Matrix4().compose(this.at, this.turned, ONE));
  }

  private put(): void {
    this.crowd.put(this.slot, this.isVisible ? this.matrix.compose(this.at, this.turned, ONE) : NOWHERE);
  }
}

const ONE = new Vector3(1, 1, 1);
