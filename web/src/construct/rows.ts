// The rows of the wiring: a line for each signal, then the ends that have none.

import { say } from "../say";
import type { EditState, End, Tip, Wired } from "./protocol";

/** A tip of a line, in the column of its client. */
export interface Dot {
  readonly column: number;
  readonly label: string;
  readonly tip: Tip;
  readonly type: string;
  readonly gives: boolean;
  /** Something should be here and is not. */
  readonly isOpen: boolean;
}

export interface Row {
  readonly signal: string | null;
  readonly label: string;
  readonly type: string;
  readonly dots: readonly Dot[];
  /** What is wrong; empty if nothing is. */
  readonly trouble: string;
  readonly isError: boolean;
}

/** The clients in the order of their columns: plants, then everybody else, PLCs last. */
export function columns(state: EditState): readonly { readonly name: string; readonly kind: string }[] {
  const rank = (kind: string): number => (kind === "plant" ? 0 : kind === "soft-plc" || kind === "gateway" ? 2 : 1);
  return [...state.clients].sort((one, other) => rank(one.kind) - rank(other.kind));
}

function shown(at: readonly string[]): string {
  return at.length <= 2 ? at.join(", ") : say("{first} and {count} more", { first: at[0] ?? "", count: at.length - 1 });
}

export function rows(state: EditState, filter: string): readonly Row[] {
  const wanted = filter.trim().toLowerCase();
  const has = (...texts: readonly string[]): boolean => texts.some((text) => text.toLowerCase().includes(wanted));
  const order = columns(state).map((client) => client.name);
  const signals = state.map?.signals ?? [];
  const lines = signals
    .filter((signal) => has(signal.name, ...signal.writer.at, ...signal.readers.flatMap((reader) => reader.at)))
    .map((signal) => line(signal, state, order))
    .sort((one, other) => Number(other.isError) - Number(one.isError) || (one.dots[0]?.column ?? 0) - (other.dots[0]?.column ?? 0));
  const free = state.ends.filter((end) => end.signals.length === 0 && has(end.at));
  const sides = order.map((client) => free.filter((end) => end.client === client));
  const deepest = Math.max(0, ...sides.map((side) => side.length));
  const loose = Array.from({ length: deepest }, (_, index): Row => ({
    signal: null, label: "", type: "", trouble: "", isError: false,
    dots: sides.flatMap((side, column) => (side[index] === undefined ? [] : [endDot(side[index], column)])),
  }));
  return [...lines, ...loose];
}

function endDot(end: End, column: number): Dot {
  return { column, label: end.at, tip: { client: end.client, at: end.at }, type: end.type, gives: end.gives, isOpen: true };
}

function line(signal: Wired, state: EditState, order: readonly string[]): Row {
  const troubles = state.map?.troubles.filter((trouble) => trouble.signal === signal.name) ?? [];
  const hooks = [{ hook: signal.writer, gives: true }, ...signal.readers.map((hook) => ({ hook, gives: false }))];
  const dots = hooks.map(({ hook, gives }): Dot => {
    const end = state.ends.find((one) => one.client === hook.client && one.at === hook.at[0]);
    const isKnown = end !== undefined;
    return {
      column: order.indexOf(hook.client),
      label: shown(hook.at),
      tip: isKnown ? { client: end.client, at: end.at } : { signal: signal.name },
      type: end?.type ?? signal.type,
      gives,
      isOpen: hook.at.length === 0 && state.ends.some((one) => one.client === hook.client),
    };
  });
  return {
    signal: signal.name,
    label: `${signal.name} : ${signal.type}${signal.unit === null ? "" : ` ${signal.unit}`}`,
    type: signal.type,
    dots,
    trouble: troubles.map((trouble) => trouble.message).join("; "),
    isError: troubles.some((trouble) => trouble.kind !== "unread"),
  };
}

/** Whether two tips could have one signal, for the eye; the server decides. */
export function fits(one: Dot, other: Dot): boolean {
  return one.type === other.type && (one.column !== other.column || one === other);
}

/** The name of a tip, by which a drop finds it again. */
export function key(tip: Tip): string {
  return "signal" in tip ? say("signal {name}", { name: tip.signal }) : say("end {client} {at}", { client: tip.client, at: tip.at });
}
