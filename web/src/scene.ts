// The machine in 3D: bodies where the session has them, at the step that is shown.

import {
  AmbientLight, Box3, BufferGeometry, Color, DirectionalLight, GridHelper, HemisphereLight, PerspectiveCamera, Plane,
  Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Crowd, Single, type Drawn, type Glow, type Member } from "./drawn";
import { Tracks } from "./interpolation";
import { Looks, type Style } from "./looks";
import type { Pose } from "./picture";
import type { Body, Session, View } from "./session";
import { Sharpness } from "./sharpness";
import { geometry_of, is_open, key_of } from "./shapes";

/** Colours of the parts that have none of their own, by what they are. */
const BY_KIND: Readonly<Record<string, string>> = { fixed: "#7d868d", kinematic: "#8b98a3", dynamic: "#b7bec4" };
const SEES = new Color("#e0a000");
const CHOSEN = new Color("#1f6fbf");

/** Machines with more bodies are drawn without smooth edges. */
const SMOOTH_BODIES = 100;
/** So many bodies of one shape are drawn together. */
const CROWD_BODIES = 8;

interface Part {
  readonly body: Body;
  readonly drawn: Drawn;
  readonly colour: Color;
  style: Style | null;
  /** How far its surface has run, m. */
  ran_m: number;
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
  private readonly sharpness = new Sharpness();
  private readonly looks: Looks;
  private readonly bodies: readonly Body[];
  private readonly crowds: Crowd[] = [];
  private t_ns: number | null = null;
  private isStale = true;
  private moving_until_ms = 0;
  /** Pictures drawn since the page was opened. */
  drawn = 0;

  /** Draws into `place`; `choose` is called with the number of the body that is clicked, or with nothing. */
  constructor(
    private readonly place: HTMLElement,
    session: Session,
    choose: (body: number | null) => void,
    isForPicture = false,
  ) {
    // Smooth edges cost four samples a pixel where there is no graphics card.
    this.renderer = new WebGLRenderer({ antialias: isForPicture || session.bodies.length <= SMOOTH_BODIES, powerPreference: "low-power" });
    this.renderer.domElement.setAttribute("aria-label", "Machine in 3D; drag to turn, wheel to zoom, arrow keys to pan");
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.tabIndex = 0;
    place.append(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.listenToKeyEvents(this.renderer.domElement);
    this.controls.addEventListener("change", () => (this.isStale = true));
    this.light();
    this.looks = new Looks(session);
    this.bodies = session.bodies;
    this.parts = this.parts_of(session.bodies);
    this.advance(0);
    this.t_ns = null;
    this.floor();
    this.home();
    this.listen(choose);
    new ResizeObserver(() => this.fit()).observe(place);
    this.fit();
    if (!isForPicture) this.renderer.setAnimationLoop(() => this.draw());
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
    this.looks.jump();
    this.t_ns = null;
  }

  /** The signals that looks follow. */
  signals(): readonly number[] {
    return this.looks.signals();
  }

  value(signal: number, value: number): void {
    this.looks.value(signal, value);
  }

  /** Lets looks go on to the time of a picture. */
  advance(t_ns: number): void {
    const step_s = this.t_ns === null ? 0 : Math.max(0, t_ns - this.t_ns) / 1e9;
    this.t_ns = t_ns;
    this.looks.advance(t_ns);
    if (this.looks.are_none) return;
    for (const body of this.looks.bodies()) {
      const part = this.parts[body];
      if (!part) continue;
      part.style = this.looks.of(body);
      part.drawn.bend(part.style);
      const runs = part.style?.runs_m_s ?? null;
      if (runs !== null) part.drawn.run((part.ran_m += (runs[0] + runs[1] + runs[2]) * step_s));
      this.paint_one(part, body);
    }
    this.isStale = true;
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

  /** The looks whose condition holds. */
  look(active: readonly number[]): void {
    this.looks.hold(active);
    this.advance(this.t_ns ?? 0);
  }

  /** How a body is drawn now, for tests. */
  style(body: number): Style | null {
    return this.parts[body]?.style ?? null;
  }

  /** Where a body is drawn in the world, m. */
  drawn_m(body: number): readonly number[] | null {
    return this.parts[body]?.drawn.where().toArray() ?? null;
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

  /** The machine as it is now, a PNG. */
  async picture(width: number, height: number): Promise<Blob> {
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.isStale = true;
    this.draw();
    // What is drawn is kept until the task is over.
    return new Promise((done, failed) => {
      this.renderer.domElement.toBlob((blob) => (blob === null ? failed(new Error("nothing was drawn")) : done(blob)), "image/png");
    });
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
      .map((part) => ({ box: part.drawn.box(), moves: this.moves(part.body) }))
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

  private moves(body: Body): boolean {
    return body.kind === "figure" ? body.on !== null || this.looks.bends(this.bodies.indexOf(body)) : body.kind !== "fixed";
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
    const cells = metres <= 20 ? metres * 2 : Math.ceil(metres / (metres <= 60 ? 2 : 5));
    const grid = new GridHelper(metres, cells, "#888888", "#888888");
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

  private parts_of(bodies: readonly Body[]): (Part | null)[] {
    const geometries = new Map<string, BufferGeometry>();
    const crowds = new Map<string, Crowd>();
    const parents = new Set(bodies.flatMap((body) => (body.on === null ? [] : [body.on])));
    const alone = (body: Body, index: number): boolean =>
      body.on !== null || body.transparent > 0 || is_open(body.shape) || parents.has(index) || this.looks.needs_own(index);
    const counts = new Map<string, number>();
    bodies.forEach((body, index) => {
      const key = key_of(body.name, body.shape);
      if (!alone(body, index)) counts.set(key, (counts.get(key) ?? 0) + 1);
    });
    const parts: (Part | null)[] = [];
    bodies.forEach((body, index) => {
      const key = key_of(body.name, body.shape);
      const geometry = geometries.get(key) ?? geometry_of(body.shape);
      if (geometry === null) return void parts.push(null);
      if (!geometries.has(key)) {
        geometry.computeBoundingSphere();
        geometry.computeBoundingBox();
        geometries.set(key, geometry);
      }
      const many = alone(body, index) ? 0 : (counts.get(key) ?? 0);
      const drawn = many >= CROWD_BODIES
        ? this.member(body, key, geometry, many, crowds)
        : new Single(body, geometry, this.frame_of(body, parts), parents.has(index) || this.looks.bends(index));
      const colour = new Color(body.colour ?? BY_KIND[body.kind] ?? "#a0a6ab");
      const part = { body, drawn, colour, style: null, ran_m: 0, isHiddenByHand: false };
      parts.push(part);
      drawn.paint(colour, null, body.transparent);
      drawn.show(true);
    });
    return parts;
  }

  private member(body: Body, key: string, geometry: BufferGeometry, most: number, crowds: Map<string, Crowd>): Member {
    let crowd = crowds.get(key);
    if (crowd === undefined) {
      crowd = new Crowd(geometry, most, this.scene);
      crowds.set(key, crowd);
      this.crowds.push(crowd);
    }
    return crowd.add(body);
  }

  /** The frame that a body is in: that of a body before it, or the world's. */
  private frame_of(body: Body, parts: readonly (Part | null)[]): Object3D {
    const drawn = body.on === null ? null : parts[body.on]?.drawn;
    return drawn instanceof Single ? drawn.node : this.scene;
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
    const hit = ray.intersectObjects(this.scene.children, true).find((one) => one.object.visible && one.object.name !== "grid");
    if (hit === undefined) return null;
    const body = this.parts.findIndex((part) => part?.drawn.is(hit.object, hit.instanceId ?? -1) ?? false);
    return body < 0 ? null : body;
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * this.sharpness.share);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.isStale = true;
  }

  private paint(): void {
    this.parts.forEach((part, body) => {
      if (part !== null) this.paint_one(part, body);
    });
    this.isStale = true;
  }

  private paint_one(part: Part, body: number): void {
    const glow: Glow | null = body === this.chosen
      ? { colour: CHOSEN, strength: 0.55 }
      : this.lit.has(body) ? { colour: SEES, strength: 0.8 } : null;
    part.drawn.paint(part.style?.colour ?? part.colour, glow, part.style?.transparent ?? part.body.transparent);
    part.drawn.show(this.isVisible(part, body));
  }

  private isVisible(part: Part, body: number): boolean {
    const isAway = this.tracks.exact(body) === null;
    return !part.isHiddenByHand && !isAway && !(part.style?.isHidden ?? false);
  }

  private draw(): void {
    const now_ms = performance.now();
    if (!this.isStale && now_ms > this.moving_until_ms) return;
    for (const body of this.tracks.bodies()) {
      const part = this.parts[body];
      const place = this.tracks.drawn(body, now_ms);
      if (!part || place === undefined) continue;
      part.drawn.show(this.isVisible(part, body));
      if (place !== null) part.drawn.place(place.position_m, place.rotation);
    }
    for (const crowd of this.crowds) crowd.settle();
    this.stay_with_followed();
    this.isStale = false;
    this.renderer.render(this.scene, this.camera);
    this.drawn += 1;
    if (now_ms <= this.moving_until_ms && this.sharpness.drawn(now_ms)) this.fit();
  }

  private stay_with_followed(): void {
    const part = this.followed === null ? null : this.parts[this.followed];
    if (!part) return;
    const way = part.drawn.where().sub(this.controls.target);
    this.controls.target.add(way);
    this.camera.position.add(way);
    this.camera.lookAt(this.controls.target);
  }
}
