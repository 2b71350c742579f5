// The machine in 3D: bodies where the session has them, at the step that is shown.

import { say } from "./say";
import {
  Box3, BufferGeometry, Color, GridHelper, Plane, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Object3D,
} from "three";
import { Crowd, Single, type Drawn, type Glow, type Member } from "./drawn";
import { show_edges } from "./edges";
import { Eye, type Seen, type Sight } from "./eye";
import { Fittings, type Carrier } from "./fittings";
import { corners, framed, together } from "./framing";
import { Tracks } from "./interpolation";
import { glow_of, temperatures } from "./heat";
import { Light } from "./light";
import { Looks, type Style } from "./looks";
import { belts, material_of, type Material } from "./materials";
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
/** How often it is looked at what lies under the pointer, ms. */
const LOOKS_MS = 50;
/** After a picture of the session, bodies are on their way for so long, ms. */
const MOVES_MS = 600;
/** Nothing has moved for so long in what rests, ms. */
const REST_MS = 700;
/** For so long the page has other things to do than to draw well, ms. */
const FIRST_MS = 1500;
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
  private readonly eye: Eye;
  private readonly parts: (Part | null)[];
  private readonly tracks: Tracks;
  private readonly section = new Plane(new Vector3(0, -1, 0), 0);
  private followed: number | null = null;
  private chosen: number | null = null;
  private lit: ReadonlySet<number> = new Set();
  private readonly sharpness: Sharpness;
  private readonly light: Light;
  private readonly looks: Looks;
  private readonly fittings: Fittings;
  private readonly bodies: readonly Body[];
  private readonly belts: ReadonlySet<string>;
  /** The bodies whose temperatures are known, by the signals that say them; what they are now, °C. */
  private readonly heats = new Map<number, number>();
  private readonly degc = new Map<number, number>();
  /** The bodies of components. */
  private readonly fitted: ReadonlySet<string>;
  /** Whether bodies are where the session has them; before, they are where the scene puts them. */
  private hasArrived = false;
  private readonly crowds: Crowd[] = [];
  private t_ns: number | null = null;
  private isStale = true;
  /** What is drawn first is drawn soon. */
  private moving_until_ms = performance.now() + FIRST_MS;
  private resting_from_ms = performance.now();
  private isAtRest = false;
  /** Pictures drawn since the page was opened. */
  drawn = 0;
  /** Pictures that were given away. */
  private pictures = 0;

  /** Draws into `place`; `choose` is called with the number of the body that is clicked, or the component that stands there. */
  constructor(
    private readonly place: HTMLElement,
    session: Session,
    choose: (body: number | null, component: string | null) => void,
    private readonly isForPicture = false,
    /** How much of the place something covers from above, CSS pixels. */
    covered_px: () => number = () => 0,
    /** Called with whether the machine is drawn without shadows and edges. */
    private readonly graded: (isPlain: boolean) => void = () => {},
  ) {
    this.tracks = new Tracks(isForPicture);
    // Smooth edges cost four samples a pixel where there is no graphics card.
    this.renderer = new WebGLRenderer({ antialias: isForPicture || session.bodies.length <= SMOOTH_BODIES, powerPreference: "low-power" });
    this.renderer.domElement.setAttribute("aria-label", say("Machine in 3D; drag to turn, wheel to zoom, arrow keys to pan"));
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.tabIndex = 0;
    place.append(this.renderer.domElement);
    this.eye = new Eye(this.renderer.domElement, covered_px, () => this.seen(), () => (this.isStale = true));
    this.sharpness = new Sharpness(!isForPicture && (session.bodies.length > SMOOTH_BODIES || is_software(this.renderer)));
    this.light = new Light(this.renderer, this.scene);
    this.looks = new Looks(session);
    this.bodies = session.bodies;
    this.fitted = new Set(session.components.flatMap(({ body }) => (body === null ? [] : [body])));
    this.belts = belts(session);
    this.parts = this.parts_of(session.bodies);
    for (const [name, signal] of temperatures(session)) {
      const body = this.number_of(name);
      if (body >= 0) this.heats.set(body, signal);
    }
    this.fittings = new Fittings(session, this.scene, (body) => this.carrier(body), (body, way_m) => this.parts[this.number_of(body)]?.drawn.run(way_m));
    this.advance(0);
    this.t_ns = null;
    this.floor();
    this.listen(choose, new Set(session.panels.flatMap((panel) => panel.elements.flatMap((one) => one.bodies))));
    new ResizeObserver(() => {
      this.fit();
      // Otherwise the pane is empty until the next picture.
      if (!isForPicture) this.draw();
    }).observe(place);
    this.fit();
    if (!isForPicture) this.renderer.setAnimationLoop(() => this.draw());
  }

  /** Whether there is nothing to draw: neither a body, nor a component that stands somewhere. */
  get is_empty(): boolean {
    return this.parts.every((part) => part === null) && this.fittings.rooms().length === 0;
  }

  /** Whether a body is in the world, as far as is known. */
  is_there(body: number): boolean {
    return this.tracks.exact(body) !== null;
  }

  /** What a body is made of, if anybody can tell. */
  material(body: number): Material | null {
    const of = this.bodies[body];
    return of === undefined ? null : material_of(of, this.belts);
  }

  /** Takes the poses of a picture that has just arrived. */
  arrive(poses: readonly Pose[]): void {
    if (poses.length === 0) return;
    const now_ms = performance.now();
    for (const pose of poses) this.tracks.arrive(pose, now_ms);
    this.moves_on(now_ms);
    if (this.hasArrived) return;
    this.hasArrived = true;
    this.settle(now_ms);
    this.floor();
    if (this.eye.isWhole) this.eye.whole();
  }

  /** Something moves, by poses or by looks. */
  private moves_on(now_ms: number): void {
    if (now_ms > this.moving_until_ms) this.sharpness.rest();
    this.moving_until_ms = Math.max(this.moving_until_ms, now_ms + MOVES_MS);
  }

  /** Forgets where bodies were: the next picture is of another time. */
  jump(): void {
    this.tracks.clear();
    this.looks.jump();
    this.t_ns = null;
  }

  /** The signals that looks follow. */
  signals(): readonly number[] {
    return [...this.looks.signals(), ...this.fittings.signals(), ...this.heats.values()];
  }

  value(signal: number, value: number): void {
    this.looks.value(signal, value);
    this.fittings.value(signal, value);
    for (const [body, of] of this.heats) {
      const part = this.parts[body];
      if (of !== signal || !part) continue;
      this.degc.set(body, value);
      this.paint_one(part, body);
      this.isStale = true;
    }
  }

  /** Lets looks go on to the time of a picture. */
  advance(t_ns: number): void {
    const step_s = this.t_ns === null ? 0 : Math.max(0, t_ns - this.t_ns) / 1e9;
    this.t_ns = t_ns;
    this.looks.advance(t_ns);
    if (this.fittings.advance(step_s)) this.isStale = true;
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
    if (step_s > 0) this.moves_on(performance.now());
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
    const { low, high } = this.eye.reach();
    return [low[1], high[1]];
  }

  see(view: View): void {
    this.eye.see(view);
  }

  /** Sees the whole machine. */
  home(): void {
    this.eye.whole();
  }

  /** Where bodies are in the pane, for tests. */
  sight(): Sight {
    return this.eye.sight();
  }

  /** The machine as it is now, a picture of this type. */
  async picture(width: number, height: number, type = "image/png", quality?: number): Promise<Blob> {
    const canvas = this.renderer.domElement;
    // Pictures of a film have one size, and the eye stays where it is.
    if (canvas.width !== width || canvas.height !== height || this.pictures === 0) {
      this.renderer.setPixelRatio(1);
      this.renderer.setSize(width, height);
      this.eye.fit(width, height);
    }
    this.pictures += 1;
    // Also one in which nothing has moved is drawn: what was drawn before is gone.
    this.isStale = true;
    this.draw();
    // What is drawn is kept until the task is over.
    return new Promise((done, failed) => {
      this.renderer.domElement.toBlob((blob) => (blob === null ? failed(new Error("nothing was drawn")) : done(blob)), type, quality);
    });
  }

  theme(background: string, line: string): void {
    const ground = new Color(background);
    this.scene.background = ground;
    this.light.theme(ground);
    const grid = this.scene.getObjectByName("grid");
    if (grid instanceof GridHelper && !Array.isArray(grid.material)) grid.material.color.set(line);
    this.isStale = true;
  }

  /** What is seen of the machine, and what of it is framed. */
  private seen(): readonly Seen[] {
    const all = this.parts.flatMap((part, index) => {
      if (part === null || !this.isVisible(part, index)) return [];
      const points = part.drawn.corners_m();
      const room = together(points.map((point) => ({ low: point, high: point })));
      if (room === null || ![...room.low, ...room.high].every(Number.isFinite)) return [];
      const works = this.moves(part.body) || this.fitted.has(part.body.name);
      return [{ name: part.body.name, room, points, works }];
    });
    for (const { name, low, high } of this.fittings.rooms()) all.push({ name, room: { low, high }, points: corners({ low, high }), works: true });
    const machine = new Set(framed(all.map(({ room, works }) => ({ ...room, works }))));
    return all.map((one, index) => ({ ...one, isFramed: machine.has(index) }));
  }

  /** The number of a body that is drawn: the body's own shape, or its first. */
  private number_of(name: string): number {
    const own = this.bodies.findIndex((body) => body.name === name && body.shape.kind !== "none");
    return own >= 0 ? own : this.bodies.findIndex((body) => body.name.startsWith(`${name}/`));
  }

  /** A body that components are fitted to, if it is drawn by itself. */
  private carrier(name: string): Carrier | null {
    const drawn = this.parts[this.number_of(name)]?.drawn;
    if (!(drawn instanceof Single)) return null;
    const { min, max } = drawn.mesh.geometry.boundingBox ?? new Box3();
    return { node: drawn.node, low: min, high: max };
  }

  private moves(body: Body): boolean {
    return body.kind === "figure" ? body.on !== null || this.looks.bends(this.bodies.indexOf(body)) : body.kind !== "fixed";
  }

  private floor(): void {
    const { low, high } = this.eye.reach();
    const metres = Math.min(200, Math.max(4, Math.ceil(2 * Math.max(high[0] - low[0], high[1] - low[1]))));
    const cells = metres <= 20 ? metres * 2 : Math.ceil(metres / (metres <= 60 ? 2 : 5));
    const grid = new GridHelper(metres, cells, "#888888", "#888888");
    grid.name = "grid";
    // The helper's floor is x z; the session's is x y.
    grid.rotation.x = Math.PI / 2;
    grid.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, Math.min(0, low[2]));
    if (!Array.isArray(grid.material)) {
      grid.material.vertexColors = false;
      grid.material.transparent = true;
      grid.material.opacity = 0.6;
    }
    this.light.aim({ low, high }, grid.position.z);
    const before = this.scene.getObjectByName("grid");
    if (before instanceof GridHelper && !Array.isArray(before.material) && !Array.isArray(grid.material)) {
      grid.material.color.copy(before.material.color);
      before.removeFromParent();
      before.dispose();
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
      const colour = new Color(body.colour ?? material_of(body, this.belts)?.colour ?? BY_KIND[body.kind] ?? "#a0a6ab");
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

  /** A body of `keys` is pressed by a click, which the pointer says before. */
  private listen(choose: (body: number | null, component: string | null) => void, keys: ReadonlySet<number>): void {
    const canvas = this.renderer.domElement;
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => {
      // A drag turns the view and chooses nothing.
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) >= 4) return;
      const { body, component } = this.under(event);
      choose(body, component);
    });
    if (keys.size === 0) return;
    let looked_ms = 0;
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0 || event.timeStamp - looked_ms < LOOKS_MS) return;
      looked_ms = event.timeStamp;
      const { body } = this.under(event);
      canvas.style.cursor = body !== null && keys.has(body) ? "pointer" : "";
    });
  }

  /** The body under the pointer, or the component that stands there by itself. */
  private under(event: PointerEvent): { readonly body: number | null; readonly component: string | null } {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.eye.camera);
    const hit = ray.intersectObjects(this.scene.children, true).find((one) => one.object.visible && one.object.name !== "grid");
    // What is fitted to a body stands for it.
    for (let object: Object3D | null = hit?.object ?? null; object !== null; object = object.parent) {
      const at = object;
      const body = this.parts.findIndex((part) => part?.drawn.is(at, hit?.instanceId ?? -1) ?? false);
      if (body >= 0) return { body, component: null };
      const component: unknown = at.userData["component"];
      if (typeof component === "string") return { body: null, component };
    }
    return { body: null, component: null };
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2) * (this.isAtRest ? 1 : this.sharpness.share));
    this.renderer.setSize(width, height);
    const isFull = this.isAtRest || !this.sharpness.isPlain;
    this.light.cast(isFull);
    show_edges(isFull);
    this.graded(this.sharpness.isPlain);
    this.eye.fit(width, height);
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
      : this.lit.has(body) ? { colour: SEES, strength: 0.8 } : glow_of(this.degc.get(body) ?? Number.NaN);
    part.drawn.paint(part.style?.colour ?? part.colour, glow, part.style?.transparent ?? part.body.transparent);
    part.drawn.show(this.isVisible(part, body));
  }

  private isVisible(part: Part, body: number): boolean {
    const isAway = this.tracks.exact(body) === null;
    return !part.isHiddenByHand && !isAway && !(part.style?.isHidden ?? false);
  }

  private draw(): void {
    const now_ms = performance.now();
    const isMoving = now_ms <= this.moving_until_ms || this.eye.isTurning;
    if (isMoving) this.resting_from_ms = now_ms;
    // After a slow picture the next poses may wait to be read.
    const isAtRest = now_ms - this.resting_from_ms > REST_MS;
    if (!this.isStale && !isMoving && isAtRest === this.isAtRest) return;
    if (isAtRest !== this.isAtRest) {
      this.isAtRest = isAtRest;
      // What rests is drawn as well as can be, however long that takes.
      if (this.sharpness.isPlain) this.fit();
    }
    this.settle(now_ms);
    for (const crowd of this.crowds) crowd.settle();
    this.stay_with_followed();
    this.isStale = false;
    this.renderer.render(this.scene, this.eye.camera);
    this.drawn += 1;
    // A picture that is asked for is drawn as well as can be, however many are.
    if (!this.isForPicture && now_ms <= this.moving_until_ms && this.sharpness.drawn(now_ms)) this.fit();
    // Another size empties the picture.
    if (this.isStale) this.renderer.render(this.scene, this.eye.camera);
    this.isStale = false;
  }

  /** Puts bodies where they are at `now_ms`. */
  private settle(now_ms: number): void {
    for (const body of this.tracks.bodies()) {
      const part = this.parts[body];
      const place = this.tracks.drawn(body, now_ms);
      if (!part || place === undefined) continue;
      part.drawn.show(this.isVisible(part, body));
      if (place !== null) part.drawn.place(place.position_m, place.rotation);
    }
  }

  private stay_with_followed(): void {
    const part = this.followed === null ? null : this.parts[this.followed];
    if (part) this.eye.follow(part.drawn.where());
  }
}

/** Whether pictures are computed by the processor: there is no graphics card, or none that the browser uses. */
function is_software(renderer: WebGLRenderer): boolean {
  const gl = renderer.getContext();
  const about = gl.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = about === null ? "" : gl.getParameter(about.UNMASKED_RENDERER_WEBGL);
  return typeof name === "string" && /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
