// From where the machine is seen: the whole of it, a view of the scenario, or as the viewer turns it.

import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { camera_for, corners, gaze_from, seen_at, together, type Gaze, type Room } from "./framing";
import type { Vec3, View } from "./session";

/** The whole machine is seen from the front, to the right and above. */
const FROM: Vec3 = [0.55, -0.95, 0.65];
/** The angle of view from bottom to top, °. */
const VIEW_DEG = 45;
/** Views of a scenario are made for panes of this aspect: in a narrower one the camera sees more above and below. */
const VIEW_ASPECT = 1.5;
/** A machine without bodies is as large as this. */
const NOTHING: Room = { low: [-1, -1, 0], high: [1, 1, 1] };

/** A body that is seen now. */
export interface Seen {
  readonly name: string;
  /** False for a floor. */
  readonly isFramed: boolean;
  readonly room: Room;
  readonly points: readonly Vec3[];
}

/** Where bodies are in the pane, CSS pixels from its upper left corner: left, top, right, bottom. */
export interface Sight {
  readonly free: readonly number[];
  readonly bodies: readonly { readonly name: string; readonly isFramed: boolean; readonly box: readonly number[] | null }[];
}

export class Eye {
  readonly camera = new PerspectiveCamera(VIEW_DEG, 1, 0.01, 500);
  private readonly controls: OrbitControls;
  /** What stays in sight when the pane changes: nothing once the viewer has turned it. */
  private kept: "whole" | View | null = "whole";
  /** Whether the viewer is turning it. */
  isTurning = false;
  /** The part of the pane that nothing covers, CSS pixels. */
  private room = { width: 1, top: 0, height: 1 };

  /** `covered_px` says how much of the pane something covers from above. */
  constructor(
    canvas: HTMLCanvasElement,
    private readonly covered_px: () => number,
    private readonly seen: () => readonly Seen[],
    private readonly changed: () => void,
  ) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", changed);
    this.controls.addEventListener("start", () => [this.kept, this.isTurning] = [null, true]);
    this.controls.addEventListener("end", () => (this.isTurning = false));
    canvas.addEventListener("keydown", () => (this.kept = null));
  }

  /** Takes the size of the pane. */
  fit(width: number, height: number): void {
    const top = Math.min(this.covered_px(), height / 2);
    this.room = { width, top, height: height - top };
    this.turn();
  }

  /** Whether the whole machine stays in sight. */
  get isWhole(): boolean {
    return this.kept === "whole";
  }

  see(view: View): void {
    this.kept = view;
    this.turn();
  }

  /** Sees the whole machine, as large as the free part of the pane allows. */
  whole(): void {
    this.kept = "whole";
    this.turn();
  }

  /** Stays with what is there. */
  follow(place: Vector3): void {
    const way = place.sub(this.controls.target);
    if (way.lengthSq() === 0) return;
    this.kept = null;
    this.controls.target.add(way);
    this.camera.position.add(way);
    this.camera.lookAt(this.controls.target);
  }

  /** The room of the machine, without floors. */
  reach(): Room {
    return together(this.seen().filter(({ isFramed }) => isFramed).map(({ room }) => room)) ?? NOTHING;
  }

  /** Where bodies are in the pane, for tests. */
  sight(): Sight {
    this.camera.updateMatrixWorld();
    const axis = (column: number, sign: number): Vec3 => {
      const { x, y, z } = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, column).multiplyScalar(sign);
      return [x, y, z];
    };
    const gaze: Gaze = { right: axis(0, 1), up: axis(1, 1), ahead: axis(2, -1) };
    const { width, top, height } = this.room;
    const { x, y, z } = this.camera.position;
    const bodies = this.seen().map(({ name, isFramed, points }) => {
      const at = points.flatMap((point) => {
        const seen = seen_at(point, [x, y, z], gaze, this.half_height(), width / height);
        return seen === null ? [] : [[((seen[0] + 1) / 2) * width, top + ((1 - seen[1]) / 2) * height] as const];
      });
      const all = (side: 0 | 1): number[] => at.map((one) => one[side]);
      const box = at.length < points.length ? null : [Math.min(...all(0)), Math.min(...all(1)), Math.max(...all(0)), Math.max(...all(1))];
      return { name, isFramed, box };
    });
    return { free: [0, top, width, top + height], bodies };
  }

  /** The tangent of half the angle of view. */
  private half_height(): number {
    return Math.tan((this.camera.fov * Math.PI) / 360);
  }

  /** Turns to what is kept in sight. */
  private turn(): void {
    const { width, top, height } = this.room;
    const aspect = width / height;
    const isNarrow = this.kept !== null && this.kept !== "whole" && aspect < VIEW_ASPECT;
    const half = Math.tan((VIEW_DEG * Math.PI) / 360) * (isNarrow ? VIEW_ASPECT / aspect : 1);
    if (this.kept !== null) this.camera.fov = (Math.atan(half) * 360) / Math.PI;
    // The picture is made for the free part and goes on above it: what is aimed at is in the middle of that part.
    this.camera.setViewOffset(width, height, 0, -top, width, height + top);
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    if (this.kept === "whole") this.frame_all(aspect);
    else if (this.kept !== null) {
      this.camera.position.set(...this.kept.position_m);
      this.controls.target.set(...this.kept.target_m);
    }
    this.controls.update();
    this.changed();
  }

  private frame_all(aspect: number): void {
    const gaze = gaze_from(FROM);
    const points = this.seen().filter(({ isFramed }) => isFramed).flatMap(({ points }) => points);
    const { low, high } = this.reach();
    const camera = camera_for(points.length === 0 ? corners(NOTHING) : points, gaze, this.half_height(), aspect);
    const ahead = new Vector3(...gaze.ahead);
    const middle = new Vector3(...low).add(new Vector3(...high)).multiplyScalar(0.5);
    this.camera.position.set(...camera);
    // One turns about what is in the middle of the picture, as far away as the middle of the machine.
    const depth_m = Math.max(0.1, middle.sub(this.camera.position).dot(ahead));
    this.controls.target.copy(this.camera.position).addScaledVector(ahead, depth_m);
  }
}
