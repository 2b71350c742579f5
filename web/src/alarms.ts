// Alarms as they come, go, are acknowledged and put aside, at any moment of virtual time (ISA-18.2).

import type { Alarm, AlarmChange } from "./session";

/** How an alarm stands that is on, or that nobody has acknowledged. */
export interface Standing {
  readonly alarm: number;
  readonly about: Alarm;
  readonly came_ns: number;
  /** When it went; nothing while it is on. */
  readonly gone_ns: number | null;
  /** Whether it has been acknowledged. */
  readonly isSeen: boolean;
  /** Until when it is put aside; nothing if it is not. */
  readonly aside_ns: number | null;
}

/** The most urgent one first. */
export const PRIORITIES = ["critical", "high", "medium", "low"] as const;

const rank = (one: Standing): number => PRIORITIES.indexOf(one.about.priority);

/** The order of a list: first what is to be acknowledged, of this the most urgent, of these the newest. */
function first(a: Standing, b: Standing): number {
  const group = (one: Standing): number => (one.aside_ns !== null ? 2 : one.isSeen ? 1 : 0);
  return group(a) - group(b) || rank(a) - rank(b) || b.came_ns - a.came_ns || a.alarm - b.alarm;
}

/** All changes of the alarms of a session. */
export class AlarmBook {
  private changes: readonly AlarmChange[] = [];

  constructor(private readonly alarms: readonly Alarm[]) {}

  /** Takes changes; `isAll` says that none came before these. Gives those that are new to this page. */
  take(isAll: boolean, changes: readonly AlarmChange[]): readonly AlarmChange[] {
    const before = isAll ? this.changes : [];
    this.changes = isAll ? changes : [...this.changes, ...changes];
    const is_same = (one: AlarmChange, other: AlarmChange): boolean => one.alarm === other.alarm && one.t_ns === other.t_ns && one.fate === other.fate;
    return changes.filter((one) => !before.some((other) => is_same(one, other)));
  }

  /** The alarms that are on or not acknowledged at `t_ns`; with `isLive`, after all changes. The most urgent is the first. */
  at(t_ns: number, isLive: boolean): readonly Standing[] {
    const standing = new Map<number, Standing>();
    const aside = new Map<number, number>();
    for (const { alarm, t_ns: at_ns, fate, until_ns } of this.changes) {
      const about = this.alarms[alarm];
      if (about === undefined || (!isLive && at_ns > t_ns)) continue;
      const one = standing.get(alarm);
      if (fate === "on") standing.set(alarm, { alarm, about, came_ns: at_ns, gone_ns: null, isSeen: false, aside_ns: null });
      else if (fate === "shelved") aside.set(alarm, until_ns ?? Number.POSITIVE_INFINITY);
      else if (fate === "unshelved") aside.delete(alarm);
      else if (one === undefined) continue;
      else if (fate === "acknowledged" && one.gone_ns !== null) standing.delete(alarm);
      else if (fate === "acknowledged") standing.set(alarm, { ...one, isSeen: true });
      else if (one.isSeen) standing.delete(alarm);
      else standing.set(alarm, { ...one, gone_ns: at_ns });
    }
    const all = [...standing.values()].map((one) => {
      const until_ns = aside.get(one.alarm);
      return until_ns !== undefined && until_ns > t_ns ? { ...one, aside_ns: until_ns } : one;
    });
    return all.sort(first);
  }
}

/** The alarm that somebody has to look at first: the most urgent one that is not acknowledged. */
export function most_urgent(all: readonly Standing[]): Standing | null {
  return all.find((one) => !one.isSeen && one.aside_ns === null) ?? null;
}
