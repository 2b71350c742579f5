// Poses between two pictures, for the eye only: nothing here is read back by the session.

import type { Pose } from "./picture";
import type { Quaternion, Vec3 } from "./session";

interface Place {
  readonly position_m: Vec3;
  readonly rotation: Quaternion;
}

/** The point between `from` (share 0) and `to` (share 1). */
export function between(from: Vec3, to: Vec3, share: number): Vec3 {
  const mix = (axis: 0 | 1 | 2): number => from[axis] + (to[axis] - from[axis]) * share;
  return [mix(0), mix(1), mix(2)];
}

/** The rotation between two unit quaternions on the shorter arc (Shoemake 1985, slerp). */
export function slerp(from: Quaternion, to: Quaternion, share: number): Quaternion {
  const dot = from[0] * to[0] + from[1] * to[1] + from[2] * to[2] + from[3] * to[3];
  const sign = dot < 0 ? -1 : 1;
  const cosine = Math.min(1, Math.abs(dot));
  const angle = Math.acos(cosine);
  // Near each other the sines vanish, and the straight line is as good.
  const isClose = angle < 1e-4;
  const a = isClose ? 1 - share : Math.sin((1 - share) * angle) / Math.sin(angle);
  const b = sign * (isClose ? share : Math.sin(share * angle) / Math.sin(angle));
  const mix = (axis: 0 | 1 | 2 | 3): number => a * from[axis] + b * to[axis];
  return [mix(0), mix(1), mix(2), mix(3)];
}

/** The last two places of a body. */
interface Track {
  from: Place | null;
  to: Place | null;
  from_ms: number;
  to_ms: number;
}

/** A body that goes further than this between two pictures was put there, and is not drawn on its way. */
const JUMP_M = 0.5;
/** Pictures that are further apart than this are not joined. */
const GAP_MS = 500;

export class Tracks {
  private readonly tracks = new Map<number, Track>();

  /** `isExact` for pictures that are looked at one by one: nothing is on its way there. */
  constructor(private readonly isExact = false) {}

  /** Notes a pose that arrived at `now_ms` on the browser's clock. */
  arrive(pose: Pose, now_ms: number): void {
    const last = this.tracks.get(pose.body);
    const place = pose.place;
    if (this.isExact || last === undefined || last.to === null || place === null || isJump(last.to, place) || now_ms - last.to_ms > GAP_MS) {
      this.tracks.set(pose.body, { from: place, to: place, from_ms: now_ms, to_ms: now_ms });
      return;
    }
    this.tracks.set(pose.body, { from: last.to, to: place, from_ms: last.to_ms, to_ms: now_ms });
  }

  /** Where a body is drawn at `now_ms`, one picture late; nothing while it is away. */
  drawn(body: number, now_ms: number): Place | null | undefined {
    const track = this.tracks.get(body);
    if (track === undefined) return undefined;
    const { from, to } = track;
    if (from === null || to === null) return to;
    const span = track.to_ms - track.from_ms;
    const share = span <= 0 ? 1 : Math.min(1, Math.max(0, (now_ms - track.to_ms) / span));
    return {
      position_m: between(from.position_m, to.position_m, share),
      rotation: slerp(from.rotation, to.rotation, share),
    };
  }

  /** The exact pose of the last picture. */
  exact(body: number): Place | null | undefined {
    return this.tracks.get(body)?.to;
  }

  /** The numbers of all bodies that a picture has named. */
  bodies(): IterableIterator<number> {
    return this.tracks.keys();
  }

  clear(): void {
    this.tracks.clear();
  }
}

function isJump(from: Place, to: Place): boolean {
  const [x, y, z] = to.position_m;
  const [a, b, c] = from.position_m;
  return Math.hypot(x - a, y - b, z - c) > JUMP_M;
}
