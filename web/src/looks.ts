// What bodies look like while something holds, or by the value of a signal: for the eye only.

import { Color, Quaternion, Vector3 } from "three";
import type { Look, Session, Vec3 } from "./session";

/** How a body is drawn beside what it is. */
export interface Style {
  readonly colour: Color | null;
  readonly isHidden: boolean;
  /** How much one sees through it; nothing as the body itself says. */
  readonly transparent: number | null;
  readonly scale: number;
  /** The shares of its lengths that are drawn, from the lower end. */
  readonly grown: Vec3;
  readonly moved_m: Vector3;
  readonly turns: readonly { readonly by: Quaternion; readonly about_m: Vec3 | null }[];
  /** How fast its surface runs, m/s. */
  readonly runs_m_s: Vec3 | null;
}

/** How far along its way a value is: 0 at the begin, 1 at the end of `over`. */
export function share_of(value: number, over: readonly [number, number] | null): number {
  if (over === null) return value;
  const share = (value - over[0]) / (over[1] - over[0]);
  return Number.isNaN(share) ? 0 : Math.min(1, Math.max(0, share));
}

export class Looks {
  private readonly by_body = new Map<number, number[]>();
  /** Where each look that follows a signal is on its way, and where it goes. */
  private readonly shares: { now: number | null; to: number | null }[];
  private active: ReadonlySet<number> = new Set();
  private t_ns: number | null = null;

  constructor(private readonly session: Session) {
    this.shares = session.looks.map(() => ({ now: null, to: null }));
    session.looks.forEach((look, index) => {
      for (const body of look.bodies) this.by_body.set(body, [...(this.by_body.get(body) ?? []), index]);
    });
  }

  /** The signals that looks follow. */
  signals(): readonly number[] {
    return this.session.looks.flatMap((look) => (look.follows === null ? [] : [look.follows]));
  }

  get are_none(): boolean {
    return this.by_body.size === 0;
  }

  /** The bodies that have looks. */
  bodies(): IterableIterator<number> {
    return this.by_body.keys();
  }

  /** True for a body that cannot be drawn together with others: it is bent, seen through, or its surface runs. */
  needs_own(body: number): boolean {
    return this.bends(body) || (this.by_body.get(body) ?? []).some((index) => {
      const look = this.session.looks[index];
      return look !== undefined && (look.transparent !== null || look.run_m_s !== null);
    });
  }

  /** True if looks change the place or the size of a body. */
  bends(body: number): boolean {
    return (this.by_body.get(body) ?? []).some((index) => {
      const look = this.session.looks[index];
      return look !== undefined && (look.move_m ?? look.turn_deg ?? look.grow ?? look.scale) !== null;
    });
  }

  /** The looks whose condition holds. */
  hold(active: readonly number[]): void {
    this.active = new Set(active);
  }

  value(signal: number, value: number): void {
    this.session.looks.forEach((look, index) => {
      const share = this.shares[index];
      if (look.follows === signal && share !== undefined) share.to = share_of(value, look.over);
    });
  }

  /** Goes on to a time; true if something is still on its way. After a jump everything is where it goes. */
  advance(t_ns: number): boolean {
    const step_s = this.t_ns === null ? Infinity : (t_ns - this.t_ns) / 1e9;
    this.t_ns = t_ns;
    let isMoving = false;
    this.session.looks.forEach((look, index) => {
      const share = this.shares[index];
      if (share === undefined || share.to === null) return;
      const most = look.takes_s === null || share.now === null || step_s < 0 ? Infinity : step_s / look.takes_s;
      const way = share.to - (share.now ?? share.to);
      share.now = Math.abs(way) <= most ? share.to : (share.now ?? share.to) + Math.sign(way) * most;
      isMoving ||= share.now !== share.to;
    });
    return isMoving;
  }

  /** Forgets what was on its way: the next time is another one. */
  jump(): void {
    this.t_ns = null;
    for (const share of this.shares) share.now = null;
  }

  /** How a body is drawn now; later looks go before earlier ones. */
  of(body: number): Style | null {
    const indices = this.by_body.get(body);
    if (indices === undefined) return null;
    let [colour, isHidden, transparent, scale]: [Color | null, boolean, number | null, number] = [null, false, null, 1];
    let [grown, runs_m_s]: [Vec3, Vec3 | null] = [[1, 1, 1], null];
    const moved_m = new Vector3();
    const turns: { by: Quaternion; about_m: Vec3 | null }[] = [];
    for (const index of indices) {
      const look = this.session.looks[index];
      if (look === undefined || (look.when !== null && !this.active.has(index))) continue;
      if (look.colour !== null) colour = new Color(look.colour);
      isHidden ||= look.hidden;
      transparent = look.transparent ?? transparent;
      scale *= look.scale ?? 1;
      const share = this.shares[index]?.now ?? null;
      if (look.follows === null || share === null) continue;
      if (look.colours !== null) colour = new Color(look.colours[0]).lerp(new Color(look.colours[1]), clamped(share));
      if (look.move_m !== null) moved_m.addScaledVector(new Vector3(...look.move_m), share);
      if (look.turn_deg !== null) turns.push({ by: turn(look.turn_deg, share), about_m: look.turn_about_m });
      if (look.grow !== null) grown = grow(grown, look.grow, share);
      if (look.run_m_s !== null) runs_m_s = look.run_m_s.map((part) => part * share) as unknown as Vec3;
    }
    return { colour, isHidden, transparent, scale, grown, moved_m, turns, runs_m_s };
  }
}

const clamped = (share: number): number => Math.min(1, Math.max(0, share));

function turn(turn_deg: Vec3, share: number): Quaternion {
  const axis = new Vector3(...turn_deg);
  const angle = (axis.length() * share * Math.PI) / 180;
  return new Quaternion().setFromAxisAngle(axis.normalize(), angle);
}

function grow(grown: Vec3, axis: NonNullable<Look["grow"]>, share: number): Vec3 {
  // What has no length at all cannot be lit.
  const length = Math.max(1e-4, share);
  return [axis === "x" ? length : grown[0], axis === "y" ? length : grown[1], axis === "z" ? length : grown[2]];
}
