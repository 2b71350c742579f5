// The machine in 3D: bodies where the session has them, at the step that is shown.

import {
  AmbientLight, Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, DirectionalLight,
  Float32BufferAttribute, GridHelper, HemisphereLight, Mesh, MeshLambertMaterial, PerspectiveCamera, Plane, Raycaster,
  Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Tracks } from "./interpolation";
import type { Body, Pose, Session, Shape, View } from "./protocol";

/** Colours of the parts that have none of their own, by what they are. */
const BY_KIND: Readonly<Record<string, string>> = { fixed: "#7d868d", kinematic: "#8b98a3", dynamic: "#b7bec4" };
const SEES = new Color("#e0a000");
const CHOSEN = new Color("#1f6fbf");
const DARK = new Color("#000000");

/** Machines with more bodies are drawn without smooth edges. */
const SMOOTH_BODIES = 100;

interface Part {
  readonly body: Body;
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  readonly colour: Color;
  isHiddenByHand: boolean;
}

export class MachineView {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 500);
  private readonly controls: OrbitControls;
  private readonly parts: (Part | null)[];
  private readonly tracks = new Tracks();
  private readonly section = new Plane(new Vector3(0, -1, 0), 0);
  private followed: number | null = null;
  private chosen: number | null = null;
  private lit: ReadonlySet<number> = new Set();
  private looks: ReadonlyMap<number, { colour: Color | null; isHidden: boolean }> = new Map();
  private isStale = true;
  private moving_until_ms = 0;
  /** Pictures drawn since the page was opened. */
  drawn = 0;

  /** Draws into `place`; `choose` hears the number of the body that is clicked, or nothing. */
  constructor(
    private readonly place: HTMLElement,
    session: Session,
    choose: (body: number | null) => void,
  ) {
    // Smooth edges cost four samples a pixel where there is no graphics card.
    this.renderer = new WebGLRenderer({ antialias: session.bodies.length <= SMOOTH_BODIES, powerPreference: "low-power" });
    this.renderer.domElement.setAttribute("aria-label", "Machine in 3D; drag to turn, wheel to zoom, arrow keys to pan");
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.tabIndex = 0;
    place.append(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.listenToKeyEvents(this.renderer.domElement);
    this.controls.addEventListener("change", () => (this.isStale = true));
    this.light();
    const geometries = new Map<string, BufferGeometry>();
    this.parts = session.bodies.map((body) => this.part(body, geometries));
    this.floor();
    this.home();
    this.listen(choose);
    new ResizeObserver(() => this.fit()).observe(place);
    this.fit();
    this.renderer.setAnimationLoop(() => this.draw());
  }

  /** Takes the poses of a picture that has just arrived. */
  arrive(poses: readonly Pose[]): void {
    if (poses.length === 0) return;
    const now_ms = performance.now();
    for (const pose of poses) this.tracks.arrive(pose, now_ms);
    this.moving_until_ms = now_ms + 600;
  }

  /** Forgets where bodies were: the next picture is of another time. */
  jump(): void {
    this.tracks.clear();
  }

  /** The position of a body in the last picture, in metres; nothing while it is away. */
  position_m(body: number): readonly number[] | null {
    const exact = this.tracks.exact(body);
    return exact === undefined ? (this.parts[body]?.body.position_m ?? null) : (exact?.position_m ?? null);
  }

  /** Lights the bodies of the sensors that see something. */
  light_up(bodies: ReadonlySet<number>): void {
    this.lit = bodies;
    this.paint();
  }

  /** Colours or hides bodies whose condition holds. */
  look(looks: ReadonlyMap<number, { colour: string | null; hidden: boolean }>): void {
    this.looks = new Map([...looks].map(([body, look]) => [
      body, { colour: look.colour === null ? null : new Color(look.colour), isHidden: look.hidden },
    ]));
    this.paint();
  }

  choose(body: number | null): void {
    this.chosen = body;
    this.paint();
  }

  follow(body: number | null): void {
    this.followed = body;
    this.isStale = true;
  }

  hide(body: number): void {
    const part = this.parts[body];
    if (part) part.isHiddenByHand = true;
    this.paint();
  }

  show_all(): void {
    for (const part of this.parts) if (part) part.isHiddenByHand = false;
    this.paint();
  }

  /** Cuts away what lies in front of `y_m`; nothing is cut without it. */
  cut(y_m: number | null): void {
    this.section.set(new Vector3(0, 1, 0), y_m === null ? 0 : -y_m);
    this.renderer.clippingPlanes = y_m === null ? [] : [this.section];
    this.isStale = true;
  }

  /** How far the machine reaches along y, in metres. */
  depth_m(): readonly [number, number] {
    const { low, high } = this.reach();
    return [low.y, high.y];
  }

  see(view: View): void {
    this.camera.position.set(...view.position_m);
    this.controls.target.set(...view.target_m);
    this.controls.update();
    this.isStale = true;
  }

  /** Sees the whole machine from the front, to the right and above. */
  home(): void {
    const { low, high } = this.reach();
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const size_m = Math.max(0.5, high.distanceTo(low));
    const away = new Vector3(0.55, -0.95, 0.65).normalize().multiplyScalar(size_m * 0.9);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(away);
    this.controls.update();
    this.isStale = true;
  }

  theme(background: string, line: string): void {
    this.scene.background = new Color(background);
    const grid = this.scene.getObjectByName("grid");
    if (grid instanceof GridHelper && !Array.isArray(grid.material)) grid.material.color.set(line);
    this.isStale = true;
  }

  /** The room of the machine: without floors and halls, which are larger than all that moves. */
  private reach(): { low: Vector3; high: Vector3 } {
    const boxes = this.parts
      .filter((part) => part !== null)
      .map((part) => ({ box: new Box3().setFromObject(part.mesh), moves: part.body.kind !== "fixed" }))
      .filter(({ box }) => !box.isEmpty() && [...box.min.toArray(), ...box.max.toArray()].every(Number.isFinite));
    const room = (of: readonly { box: Box3 }[]): Box3 => of.reduce((all, { box }) => all.union(box), new Box3());
    const moving = room(boxes.filter(({ moves }) => moves));
    const size_m = (box: Box3): number => box.getSize(new Vector3()).length();
    const machine = moving.isEmpty()
      ? room(boxes)
      : room(boxes.filter(({ box, moves }) => moves || size_m(box) <= size_m(moving)));
    if (machine.isEmpty()) return { low: new Vector3(-1, -1, 0), high: new Vector3(1, 1, 1) };
    return { low: machine.min, high: machine.max };
  }

  private light(): void {
    const sun = new DirectionalLight("#ffffff", 1.9);
    sun.position.set(3, -4, 8);
    const fill = new DirectionalLight("#dfe8ff", 0.6);
    fill.position.set(-5, 3, 3);
    const sky = new HemisphereLight("#ffffff", "#6d7378", 1.1);
    sky.position.set(0, 0, 1);
    this.scene.add(sun, fill, sky, new AmbientLight("#ffffff", 0.25));
  }

  private floor(): void {
    const { low, high } = this.reach();
    const metres = Math.min(200, Math.max(4, Math.ceil(2 * Math.max(high.x - low.x, high.y - low.y))));
    const grid = new GridHelper(metres, metres * 2, "#888888", "#888888");
    grid.name = "grid";
    // The helper's floor is x z; the session's is x y.
    grid.rotation.x = Math.PI / 2;
    grid.position.set((low.x + high.x) / 2, (low.y + high.y) / 2, Math.min(0, low.z));
    if (!Array.isArray(grid.material)) {
      grid.material.vertexColors = false;
      grid.material.transparent = true;
      grid.material.opacity = 0.6;
    }
    this.scene.add(grid);
  }

  private part(body: Body, geometries: Map<string, BufferGeometry>): Part | null {
    const key = body.shape.kind === "mesh" ? body.name : JSON.stringify(body.shape);
    const known = geometries.get(key);
    const geometry = known ?? geometryOf(body.shape);
    if (geometry === null) return null;
    if (known === undefined) {
      geometry.computeBoundingSphere();
      geometries.set(key, geometry);
    }
    const colour = new Color(body.colour ?? BY_KIND[body.kind] ?? "#a0a6ab");
    const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: colour }));
    mesh.position.set(...body.position_m);
    mesh.quaternion.set(...body.rotation);
    mesh.visible = body.visible;
    this.scene.add(mesh);
    return { body, mesh, colour, isHiddenByHand: false };
  }

  private listen(choose: (body: number | null) => void): void {
    const canvas = this.renderer.domElement;
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => {
      // A drag turns the view and chooses nothing.
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) < 4) choose(this.under(event));
    });
  }

  private under(event: PointerEvent): number | null {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const shown = this.parts.flatMap((part) => (part?.mesh.visible ? [part.mesh] : []));
    const hit = ray.intersectObjects(shown, false)[0];
    if (hit === undefined) return null;
    const body = this.parts.findIndex((part) => part?.mesh === hit.object);
    return body < 0 ? null : body;
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.isStale = true;
  }

  private paint(): void {
    this.parts.forEach((part, body) => {
      if (part === null) return;
      const look = this.looks.get(body);
      part.mesh.material.color.copy(look?.colour ?? part.colour);
      part.mesh.material.emissive.copy(body === this.chosen ? CHOSEN : this.lit.has(body) ? SEES : DARK);
      part.mesh.material.emissiveIntensity = body === this.chosen ? 0.55 : 0.8;
      part.mesh.visible = this.isVisible(part, body);
    });
    this.isStale = true;
  }

  private isVisible(part: Part, body: number): boolean {
    const isAway = this.tracks.exact(body) === null;
    return part.body.visible && !part.isHiddenByHand && !isAway && !(this.looks.get(body)?.isHidden ?? false);
  }

  private draw(): void {
    const now_ms = performance.now();
    if (!this.isStale && now_ms > this.moving_until_ms) return;
    for (const body of this.tracks.bodies()) {
      const part = this.parts[body];
      const place = this.tracks.drawn(body, now_ms);
      if (!part || place === undefined) continue;
      part.mesh.visible = this.isVisible(part, body);
      if (place === null) continue;
      part.mesh.position.set(...place.position_m);
      part.mesh.quaternion.set(...place.rotation);
    }
    this.stay_with_followed();
    this.isStale = false;
    this.renderer.render(this.scene, this.camera);
    this.drawn += 1;
  }

  private stay_with_followed(): void {
    const part = this.followed === null ? null : this.parts[this.followed];
    if (!part) return;
    const way = part.mesh.position.clone().sub(this.controls.target);
    this.controls.target.add(way);
    this.camera.position.add(way);
    this.camera.lookAt(this.controls.target);
  }
}

/** A shape in metres, cylinders and capsules along z. */
export function geometryOf(shape: Shape): BufferGeometry | null {
  switch (shape.kind) {
    case "box":
      return new BoxGeometry(...shape.size_m);
    case "cylinder":
      return new CylinderGeometry(shape.radius_m, shape.radius_m, shape.length_m, 40).rotateX(Math.PI / 2);
    case "capsule":
      return new CapsuleGeometry(shape.radius_m, shape.length_m, 8, 24).rotateX(Math.PI / 2);
    case "sphere":
      return new SphereGeometry(shape.radius_m, 28, 18);
    case "mesh": {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new Float32BufferAttribute(shape.positions_m, 3));
      geometry.setIndex([...shape.indices]);
      geometry.computeVertexNormals();
      return geometry;
    }
    case "none":
      return null;
  }
}
