// Which bodies make up the machine in the picture, and from where a camera sees all of them: geometry only.

import type { Vec3 } from "./session";

/** Where a body is: its room along the axes of the world, m. */
export interface Room {
  readonly low: Vec3;
  readonly high: Vec3;
}

export interface Standing extends Room {
  /** Whether it may move, or belongs to a component: then it is no floor. */
  readonly works: boolean;
}

/** Directions of a camera: unit vectors to the right, upwards, and into the picture. */
export interface Gaze {
  readonly right: Vec3;
  readonly up: Vec3;
  readonly ahead: Vec3;
}

/** A floor is thinner than this share of its longer side. */
const FLAT = 0.06;
/** A floor reaches at least this share of the others' length and width. */
const WIDE = 0.8;
/** A floor does not lie above others by more than this share of the height of all. */
const LOW = 0.05;

/** The least and the greatest of many: more than a call can have as its arguments. */
const least = (all: readonly number[]): number => all.reduce((found, one) => Math.min(found, one), Infinity);
const greatest = (all: readonly number[]): number => all.reduce((found, one) => Math.max(found, one), -Infinity);
const size = ({ low, high }: Room): Vec3 => [high[0] - low[0], high[1] - low[1], high[2] - low[2]];
const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** The room of all of them; nothing of none. */
export function together(rooms: readonly Room[]): Room | null {
  const side = (of: (axis: number) => number): Vec3 => [of(0), of(1), of(2)];
  if (rooms.length === 0) return null;
  return {
    low: side((axis) => least(rooms.map((one) => one.low[axis] as number))),
    high: side((axis) => greatest(rooms.map((one) => one.high[axis] as number))),
  };
}

/** Whether the body at `index` is a floor: flat, as wide as what stands on it, and below all of it. */
export function is_floor(bodies: readonly Standing[], index: number): boolean {
  const floor = bodies[index];
  const others = together(bodies.filter((_, at) => at !== index));
  if (floor === undefined || floor.works || others === null) return false;
  const [length, width, height] = size(floor);
  const rest = size(others);
  const isFlat = height <= FLAT * Math.max(length, width) && height < Math.min(length, width);
  const isWide = length >= WIDE * rest[0] && width >= WIDE * rest[1];
  return isFlat && isWide && floor.high[2] <= others.low[2] + LOW * rest[2] + height;
}

/** The numbers of the bodies that are framed: all but floors, or all if nothing else is there. */
export function framed(bodies: readonly Standing[]): readonly number[] {
  const all = bodies.map((_, index) => index);
  const machine = all.filter((index) => !is_floor(bodies, index));
  return machine.length === 0 ? all : machine;
}

/** The corners of a room. */
export function corners({ low, high }: Room): readonly Vec3[] {
  return [low[0], high[0]].flatMap((x) => [low[1], high[1]].flatMap((y) => [low[2], high[2]].map((z): Vec3 => [x, y, z])));
}

/**
 * Where a camera that looks along `gaze` stands nearest so that it sees all points within `share` of its picture, with the
 * points in the middle; `half_height` is the tangent of half its angle of view. Each edge of the picture is a plane through
 * the camera, so that the points bound where the camera may be along that edge; what is left are two intervals.
 */
export function camera_for(points: readonly Vec3[], gaze: Gaze, half_height: number, aspect: number, share = 0.92): Vec3 {
  if (points.length === 0) return [0, 0, 0];
  const depths = points.map((point) => dot(point, gaze.ahead));
  const along = (axis: Vec3, half: number): { low: number; high: number; back: number; half: number } => {
    const offsets = points.map((point) => dot(point, axis));
    const low = greatest(offsets.map((offset, at) => offset - half * (depths[at] as number)));
    const high = least(offsets.map((offset, at) => offset + half * (depths[at] as number)));
    return { low, high, half, back: (high - low) / (2 * half) };
  };
  const sideways = along(gaze.right, half_height * aspect * share);
  const upwards = along(gaze.up, half_height * share);
  // A flat machine seen from its edge would be at no distance at all.
  const depth = Math.min(sideways.back, upwards.back, least(depths) - 1e-3);
  const x = (sideways.low + sideways.high) / 2;
  const y = (upwards.low + upwards.high) / 2;
  const at = (axis: number): number => x * (gaze.right[axis] as number) + y * (gaze.up[axis] as number) + depth * (gaze.ahead[axis] as number);
  return [at(0), at(1), at(2)];
}

/** Where a point is in the picture of a camera, from -1 to 1 to the right and upwards; nothing behind it. */
export function seen_at(point: Vec3, camera: Vec3, gaze: Gaze, half_height: number, aspect: number): readonly [number, number] | null {
  const way: Vec3 = [point[0] - camera[0], point[1] - camera[1], point[2] - camera[2]];
  const depth = dot(way, gaze.ahead);
  return depth <= 0 ? null : [dot(way, gaze.right) / (depth * half_height * aspect), dot(way, gaze.up) / (depth * half_height)];
}

/** Which way the camera looks at first: from the front, to the right and above. */
export function gaze_from(place: Vec3): Gaze {
  const unit = (v: Vec3): Vec3 => {
    const length = Math.hypot(...v);
    return [v[0] / length, v[1] / length, v[2] / length];
  };
  const ahead = unit([-place[0], -place[1], -place[2]]);
  const right = unit([ahead[1], -ahead[0], 0]);
  const up: Vec3 = [
    right[1] * ahead[2] - right[2] * ahead[1], right[2] * ahead[0] - right[0] * ahead[2], right[0] * ahead[1] - right[1] * ahead[0],
  ];
  return { right, up, ahead };
}
