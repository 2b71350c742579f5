// What comes as bytes: bodies and values of one step, and the values of maps.

import { ProtocolError } from "./field";
import type { Quaternion, Vec3 } from "./session";

/** Bodies and values of one step. */
export interface Picture {
  readonly isHeld: boolean;
  readonly isPast: boolean;
  readonly step: number;
  readonly t_ns: number;
  /** Pairs of signal and value. */
  readonly values: readonly (readonly [number, number])[];
  readonly poses: readonly Pose[];
}

export interface Pose {
  readonly body: number;
  /** Nothing while the body is away. */
  readonly place: { readonly position_m: Vec3; readonly rotation: Quaternion } | null;
}

const HEAD_BYTES = 24;
const VALUE_BYTES = 16;
const POSE_BYTES = 32;

/** Reads a binary picture of a session with so many signals and bodies; throws [`ProtocolError`]. */
export function decodePicture(data: ArrayBuffer, signals: number, bodies: number): Picture {
  if (data.byteLength < HEAD_BYTES) throw new ProtocolError("picture", `has ${data.byteLength} bytes, its head alone has ${HEAD_BYTES}`);
  const view = new DataView(data);
  if (view.getUint8(0) !== 1) throw new ProtocolError("picture", `is of kind ${view.getUint8(0)}; this page reads 1`);
  const valueCount = view.getUint16(2, true);
  const poseCount = view.getUint32(4, true);
  const expected = HEAD_BYTES + valueCount * VALUE_BYTES + poseCount * POSE_BYTES;
  if (data.byteLength !== expected) throw new ProtocolError("picture", `has ${data.byteLength} bytes instead of ${expected}`);
  const flags = view.getUint8(1);
  const values: (readonly [number, number])[] = [];
  for (let index = 0, at = HEAD_BYTES; index < valueCount; index += 1, at += VALUE_BYTES) {
    const one = view.getUint32(at, true);
    if (one >= signals) throw new ProtocolError("picture", `names signal ${one} of ${signals}`);
    values.push([one, view.getFloat64(at + 8, true)]);
  }
  const poses: Pose[] = [];
  for (let index = 0, at = HEAD_BYTES + valueCount * VALUE_BYTES; index < poseCount; index += 1, at += POSE_BYTES) {
    poses.push(decodePose(view, at, bodies));
  }
  return {
    isHeld: (flags & 1) !== 0,
    isPast: (flags & 2) !== 0,
    step: Number(view.getBigUint64(8, true)),
    t_ns: Number(view.getBigUint64(16, true)),
    values,
    poses,
  };
}

function decodePose(view: DataView, at: number, bodies: number): Pose {
  const body = view.getUint32(at, true);
  if (body >= bodies) throw new ProtocolError("picture", `names body ${body} of ${bodies}`);
  const f = (place: number): number => view.getFloat32(at + 4 + place * 4, true);
  if (Number.isNaN(f(0))) return { body, place: null };
  return { body, place: { position_m: [f(0), f(1), f(2)], rotation: [f(3), f(4), f(5), f(6)] } };
}

/** The values of a map at one moment. */
export interface MapValues {
  readonly map: number;
  readonly isPast: boolean;
  readonly columns: number;
  readonly rows: number;
  /** Row after row. */
  readonly values: Float32Array;
}

const MAP_HEAD_BYTES = 16;

/** Whether bytes are the values of a map. */
export function isMap(data: ArrayBuffer): boolean {
  return data.byteLength > 0 && new DataView(data).getUint8(0) === 2;
}

/** Reads the values of a map of a session with so many; throws [`ProtocolError`]. */
export function decodeMapValues(data: ArrayBuffer, maps: number): MapValues {
  if (data.byteLength < MAP_HEAD_BYTES) throw new ProtocolError("map", `has ${data.byteLength} bytes, its head alone has ${MAP_HEAD_BYTES}`);
  const view = new DataView(data);
  const [map, columns, rows] = [view.getUint32(4, true), view.getUint32(8, true), view.getUint32(12, true)];
  if (map >= maps) throw new ProtocolError("map", `is map ${map} of ${maps}`);
  const expected = MAP_HEAD_BYTES + 4 * columns * rows;
  if (data.byteLength !== expected) throw new ProtocolError("map", `has ${data.byteLength} bytes instead of ${expected}`);
  const values = new Float32Array(columns * rows);
  for (let index = 0; index < values.length; index += 1) values[index] = view.getFloat32(MAP_HEAD_BYTES + 4 * index, true);
  return { map, isPast: (view.getUint8(1) & 2) !== 0, columns, rows, values };
}
