// The machine that is built, in 3D: bodies are chosen and moved, beams and axes are shown.

import { say } from "../say";
import {
  ArrowHelper, BufferGeometry, Color, DirectionalLight, EdgesGeometry, GridHelper, Group, HemisphereLight, Box3, Line,
  LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Body } from "../session";
import { geometry_of } from "../shapes";
import { colour } from "../theme";
import type { Json, SceneState, Table } from "./protocol";
import { camera_for, corners, framed, gaze_from, together, type Room, type Standing } from "../framing";
import { base, snap } from "./snap";

const BY_KIND: Readonly<Record<string, string>> = { fixed: "#8a949b", kinematic: "#6f8ea6", dynamic: "#c2a878" };
const BEAM = new Color("#e0a000");
const AXIS = 0x1d8a42;
const DARK = new Color("#000000");
const WRONG = new Color("#c4161c");
/** A scene without bodies is as large as this. */
const EMPTY: Room = { low: [-0.8, -0.6, 0], high: [0.8, 0.6, 0.6] };
/** Where the machine is seen from at first: the front, to the right and above. */
const FROM = [0.4, -0.95, 0.7] as const;
/** What the keys over the stage cover, CSS pixels. */
const TOOLS_PX = 44;
/** How much of the free part a machine takes. */
const SHARE = 0.86;

interface Part {
  readonly body: Body;
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  readonly table: Table | null;
}

interface Drag {
  readonly table: Table;
  readonly start_m: Vector3;
  readonly from: Vector3;
  readonly plane: Plane;
  readonly upright: boolean;
  readonly parts: readonly { readonly part: Part; readonly from: Vector3 }[];
  at_m: Vector3;
}

export class Bench {
  private readonly renderer = new WebGLRenderer({ antialias: true, powerPreference: "low-power" });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 500);
  private readonly controls: OrbitControls;
  private readonly things = new Group();
  private parts: Part[] = [];
  private tables: readonly Table[] = [];
  private chosen: string | null = null;
  private warned: ReadonlySet<string> = new Set();
  private drag: Drag | null = null;
  private isStale = true;
  private isSeen = false;
  /** Whether somebody has turned it: until then the whole machine stays in sight. */
  private isTurned = false;
  grid_m = 0.05;

  /** Draws into `place`; `choose` is called with a body that is clicked, `move` with one that is put elsewhere. */
  constructor(
    private readonly place: HTMLElement,
    private readonly choose: (body: string | null) => void,
    private readonly move: (body: string, position_m: readonly [number, number, number]) => void,
  ) {
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", say("Machine in 3D; drag a body to move it, with Shift up and down; arrow keys and Page up, Page down move the chosen one"));
    place.append(canvas);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("start", () => (this.isTurned = true));
    this.controls.addEventListener("change", () => (this.isStale = true));
    const sun = new DirectionalLight("#ffffff", 1.9);
    sun.position.set(3, -4, 8);
    const fill = new DirectionalLight("#dfe8ff", 0.6);
    fill.position.set(-5, 3, 3);
    const sky = new HemisphereLight("#ffffff", "#8d9398", 1.7);
    sky.position.set(0, 0, 1);
    this.scene.add(sun, fill, sky, this.things);
    const floor = new GridHelper(8, 32, "#888888", "#888888");
    floor.rotation.x = Math.PI / 2;
    if (!Array.isArray(floor.material)) Object.assign(floor.material, { transparent: true, opacity: 0.35 });
    this.scene.add(floor);
    this.theme();
    window.addEventListener("themechange", () => this.theme());
    this.listen();
    new ResizeObserver(() => this.fit()).observe(place);
    this.fit();
    this.home();
    this.renderer.setAnimationLoop(() => {
      if (!this.isStale) return;
      this.isStale = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** Shows a scene; of one that is wrong, the bodies stay as they were. */
  show(state: SceneState): void {
    this.tables = state.tables;
    if (state.bodies === null) return;
    for (const thing of [...this.things.children]) this.things.remove(thing);
    this.parts = state.bodies.flatMap((body) => this.part(body));
    this.things.add(...this.marks());
    this.paint();
    if (!this.isSeen && this.parts.length > 0) {
      this.home();
      this.isSeen = true;
    }
  }

  /** Marks the bodies of a table, by its name. */
  mark(name: string | null): void {
    this.chosen = name;
    this.paint();
  }

  /** Marks the bodies of which something is wrong. */
  warn(bodies: ReadonlySet<string>): void {
    this.warned = bodies;
  }

  /** Sees the whole machine. */
  home(): void {
    // As on the page: all but floors, as large as the part of the stage allows that no key covers.
    const seen = this.framed();
    const room: Room = together(seen) ?? EMPTY;
    const { clientWidth: width, clientHeight: height } = this.place;
    const free = Math.max(1, height - TOOLS_PX);
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const gaze = gaze_from(FROM);
    const [x, y, z] = camera_for(seen.length === 0 ? corners(room) : seen.flatMap(corners), gaze, half * (free / Math.max(1, height)), Math.max(0.2, width / free), SHARE);
    const middle = room.low.map((low, axis) => (low + (room.high[axis] ?? low)) / 2);
    this.camera.position.set(x, y, z);
    const depth_m = Math.max(0.1, gaze.ahead.reduce((sum, way, axis) => sum + way * ((middle[axis] ?? 0) - ([x, y, z][axis] ?? 0)), 0));
    this.controls.target.copy(this.camera.position).addScaledVector(new Vector3(...gaze.ahead), depth_m);
    this.controls.update();
    this.isStale = true;
  }

  /** The rooms of all bodies but floors. */
  private framed(): readonly Room[] {
    const rooms = this.parts.map((part): Standing => {
      const { min, max } = new Box3().setFromObject(part.mesh);
      return { low: [min.x, min.y, min.z], high: [max.x, max.y, max.z], works: part.body.kind !== "fixed" };
    });
    return framed(rooms).flatMap((index) => rooms[index] ?? []);
  }

  /** Where the corners of what is framed are on the screen, for tests. */
  corners(): readonly { readonly x: number; readonly y: number }[] {
    return this.framed().flatMap(corners).map((point) => this.on_screen(new Vector3(...point)));
  }

  /** Where a body is on the screen, for tests. */
  screen(body: string): { readonly x: number; readonly y: number } | null {
    const part = this.parts.find((one) => one.body.name === body);
    if (part === undefined) return null;
    return this.on_screen(part.mesh.getWorldPosition(new Vector3()));
  }

  private on_screen(point: Vector3): { readonly x: number; readonly y: number } {
    const at = point.project(this.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height };
  }

  private theme(): void {
    this.scene.background = new Color(colour("--sheet"));
    this.isStale = true;
  }

  private part(body: Body): Part[] {
    const geometry = geometry_of(body.shape);
    if (geometry === null) return [];
    const table = this.tables.find((one) => one.sort === "body" && base(one.name) === base(body.name.split("/")[0] ?? body.name)) ?? null;
    const isZone = table?.keys.get("collides") === false;
    const material = new MeshLambertMaterial({ color: BY_KIND[body.kind] ?? "#a0a6ab", transparent: isZone, opacity: isZone ? 0.25 : 1, depthWrite: !isZone });
    const mesh = new Mesh(geometry, material);
    mesh.add(new LineSegments(new EdgesGeometry(geometry, 30), new LineBasicMaterial({ color: "#30373c", transparent: true, opacity: 0.55 })));
    mesh.position.set(...body.position_m);
    mesh.quaternion.set(...body.rotation);
    this.things.add(mesh);
    return [{ body, mesh, table }];
  }

  /** Beams of sensors that look along a line, and axes of joints. */
  private marks(): readonly (Line | ArrowHelper)[] {
    return this.tables.flatMap((table): readonly (Line | ArrowHelper)[] => {
      const way = triple(table.keys.get("direction") ?? table.keys.get("axis"));
      if (table.sort === "joint" && way !== null) {
        const child = this.parts.find((part) => part.body.name === table.keys.get("child"));
        const from = triple(table.keys.get("anchor_m")) ?? child?.mesh.position.clone();
        return from === undefined || way.length() === 0 ? [] : [new ArrowHelper(way.normalize(), from, 0.25, AXIS, 0.06, 0.04)];
      }
      const point = triple(table.keys.get("point_m"));
      if (point === null || way === null || way.length() === 0) return [];
      const range = table.keys.get("range_m");
      const to = point.clone().addScaledVector(way.normalize(), typeof range === "number" ? range : 1);
      return [new Line(new BufferGeometry().setFromPoints([point, to]), new LineBasicMaterial({ color: BEAM }))];
    });
  }

  private listen(): void {
    const canvas = this.renderer.domElement;
    let down = { x: 0, y: 0 };
    // before the controls handle it, so that a body is moved and the view is not
    canvas.addEventListener("pointerdown", (event) => {
      down = { x: event.clientX, y: event.clientY };
      const part = event.button === 0 ? this.under(event) : null;
      if (part?.table && part.table.name === this.chosen) this.begin(event, part.table);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => this.drawTo(event));
    canvas.addEventListener("pointerup", (event) => {
      const drag = this.drag;
      if (drag !== null) {
        this.drag = null;
        this.controls.enabled = true;
        if (drag.at_m.distanceTo(drag.start_m) > 0) this.move(drag.table.name, [drag.at_m.x, drag.at_m.y, drag.at_m.z]);
      }
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) < 4) {
        const part = this.under(event);
        this.choose(part?.table?.name ?? null);
      }
    });
    canvas.addEventListener("keydown", (event) => this.typed(event));
  }

  private begin(event: PointerEvent, table: Table): void {
    const first = this.parts.find((part) => part.table === table);
    const start_m = triple(table.keys.get("position_m")) ?? new Vector3();
    if (first === undefined) return;
    this.controls.enabled = false;
    const upright = event.shiftKey;
    const normal = upright ? new Vector3().subVectors(this.camera.position, first.mesh.position).setZ(0).normalize() : new Vector3(0, 0, 1);
    const hit = this.ray(event).ray.intersectPlane(new Plane().setFromNormalAndCoplanarPoint(normal, first.mesh.position), new Vector3());
    if (hit === null) return;
    const parts = this.parts.filter((part) => part.table === table).map((part) => ({ part, from: part.mesh.position.clone() }));
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, hit);
    this.drag = { table, start_m, from: hit, plane, upright, parts, at_m: start_m.clone() };
  }

  private drawTo(event: PointerEvent): void {
    const drag = this.drag;
    const hit = drag === null ? null : this.ray(event).ray.intersectPlane(drag.plane, new Vector3());
    if (drag === null || hit === null) return;
    const by = hit.sub(drag.from);
    const put = (start: number, way: number): number => (way === 0 ? start : snap(start + way, this.grid_m));
    drag.at_m.set(
      drag.upright ? drag.start_m.x : put(drag.start_m.x, by.x),
      drag.upright ? drag.start_m.y : put(drag.start_m.y, by.y),
      drag.upright ? put(drag.start_m.z, by.z) : drag.start_m.z,
    );
    const shift = drag.at_m.clone().sub(drag.start_m);
    for (const { part, from } of drag.parts) part.mesh.position.copy(from).add(shift);
    this.isStale = true;
  }

  private typed(event: KeyboardEvent): void {
    const ways: Readonly<Record<string, readonly [number, number, number]>> = {
      ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1],
    };
    const way = ways[event.key];
    const table = this.tables.find((one) => one.sort === "body" && one.name === this.chosen);
    if (way === undefined || table === undefined) return;
    event.preventDefault();
    const start_m = triple(table.keys.get("position_m")) ?? new Vector3();
    const step_m = this.grid_m > 0 ? this.grid_m : 0.001;
    const put = (value: number, by: number): number => (by === 0 ? value : snap(value + by * step_m, this.grid_m));
    this.move(table.name, [put(start_m.x, way[0]), put(start_m.y, way[1]), put(start_m.z, way[2])]);
  }

  private ray(event: PointerEvent): Raycaster {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray;
  }

  private under(event: PointerEvent): Part | null {
    const hits = this.ray(event).intersectObjects(this.parts.map((part) => part.mesh), false);
    const found = hits.map((hit) => this.parts.find((part) => part.mesh === hit.object)).filter((part) => part !== undefined);
    // one sees through a zone, and takes what is in it
    return found.find((part) => !part.mesh.material.transparent) ?? found[0] ?? null;
  }

  private paint(): void {
    for (const part of this.parts) {
      const isChosen = part.table !== null && part.table.name === this.chosen;
      const isWrong = part.table !== null && this.warned.has(part.table.name);
      part.mesh.material.emissive.copy(isChosen ? new Color("#1f6fbf") : isWrong ? WRONG : DARK);
      part.mesh.material.emissiveIntensity = 0.55;
    }
    this.isStale = true;
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    // The keys are above: the free part lies below the middle of the stage. This brings the projection up to date, too.
    this.camera.setViewOffset(width, height, 0, -TOOLS_PX / 2, width, height);
    if (!this.isTurned) this.home();
    this.isStale = true;
  }
}

/** Three numbers as a vector. */
function triple(value: Json | undefined): Vector3 | null {
  if (!Array.isArray(value) || value.length !== 3) return null;
  const [x, y, z] = value as readonly Json[];
  return typeof x === "number" && typeof y === "number" && typeof z === "number" ? new Vector3(x, y, z) : null;
}
