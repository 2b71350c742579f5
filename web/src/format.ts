// Values as they are read: with the digits that one can distinguish, which do not jump while the value moves.

import { language, own, say } from "./say";
import type { Signal } from "./session";

/** What stands between the whole part of a number and the rest. */
const POINT = new Intl.NumberFormat(language).formatToParts(0.5).find((part) => part.type === "decimal")?.value ?? ".";

/** The text of a number as it is written here. */
export function local(text: string): string {
  return text.replace(".", POINT);
}

/** What somebody has typed, as a number has it everywhere. */
export function neutral(text: string): string {
  return POINT === "." ? text : text.replace(POINT, ".");
}

/** Virtual time as seconds with three places. */
export function seconds(t_ns: number): string {
  return `${local((t_ns / 1e9).toFixed(3))} s`;
}

/** The same of seconds. */
export function seconds_of(t_s: number): string {
  return seconds(t_s * 1e9);
}

/** A time that is left, as minutes and seconds. */
export function minutes(t_ns: number): string {
  const whole = Math.max(0, Math.ceil(t_ns / 1e9));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** Digits that a value of its greatest size has, and one with a prefix that we chose. */
const DIGITS = 4;
const PREFIXED_DIGITS = 3;
const MOST_DECIMALS = 6;
/** Thousands and thousandths of a unit. */
const PREFIXES: readonly (readonly [number, string])[] = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
/** Units that take a prefix when a value is large; of these, the last ones when it is small, too. */
const LARGE = new Set(["W", "Wh", "A", "V", "VA", "var", "J", "N", "Pa", "Hz", "N·m", "Ω", "F", "H"]);
const SMALL = new Set(["A", "V", "W", "Ω", "F", "H"]);
/** Units of which more than so many decimals mean nothing to a reader. */
const DECIMALS: Readonly<Record<string, number>> = { "°C": 1, "%": 1, "°": 2, K: 1, "1/h": 1, "1/min": 1, bar: 2, ms: 1, mm: 2, kg: 1, min: 2, "l/min": 1, kWh: 1 };
/** Prefixes that a unit has already. */
const BEGUN: Readonly<Record<string, readonly [number, string]>> = { kW: [1e3, "W"], kWh: [1e3, "Wh"], kA: [1e3, "A"], kV: [1e3, "V"], mA: [1e-3, "A"], mV: [1e-3, "V"], kN: [1e3, "N"] };

/** How the values of a signal are written. */
export interface Form {
  /** What a value is divided by. */
  readonly by: number;
  readonly decimals: number;
  readonly unit: string | null;
}

/** The form for values up to `size` of a unit. */
export function form_for(unit: string | null, isWhole: boolean, size: number): Form {
  const [factor, base] = unit === null ? [1, ""] : (BEGUN[unit] ?? [1, unit]);
  const amount = Math.abs(size) * factor;
  const found = LARGE.has(base) && Number.isFinite(amount) && amount > 0
    ? PREFIXES.find(([by]) => amount >= by && (by >= 1 || SMALL.has(base))) ?? [1, ""] as const
    : null;
  // A unit keeps its own prefix until the value is a thousand times it, or less than one of it.
  const isOwn = found === null || (factor === 1 ? found[0] === 1 : found[0] === factor);
  const [by, written] = isOwn ? [1, unit] : [found[0] / factor, `${found[1]}${base}`];
  if (isWhole && by === 1) return { by, decimals: 0, unit: written };
  const large = Math.abs(size) / by;
  // Places before the point; where there are none, zeros behind it count for nothing.
  const places = large > 0 ? Math.floor(Math.log10(large)) + 1 : 1;
  // Nothing is known yet of a value that was never but zero.
  if (large === 0) return { by, decimals: 0, unit: written };
  const most = isOwn && unit !== null ? DECIMALS[unit] ?? MOST_DECIMALS : MOST_DECIMALS;
  return { by, decimals: Math.max(0, Math.min(most, (isOwn ? DIGITS : PREFIXED_DIGITS) - 1 - Math.min(0, places) - Math.max(0, places - 1))), unit: written };
}

/** A number in a form, with digits of equal width and a true minus. */
export function in_form(value: number, { by, decimals, unit }: Form): string {
  if (Number.isNaN(value)) return say("not a number");
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const text = Math.abs(value / by) >= 1e12 ? (value / by).toExponential(DIGITS - 1) : (value / by).toFixed(decimals);
  // What rounds to zero has no sign.
  const digits = Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
  return unit === null ? local(digits) : `${local(digits)} ${unit}`;
}

/** What of a signal's values has been seen: the greatest, from which the form follows. */
const sizes = new WeakMap<Signal, number>();
/** A value that is less than this share of the greatest would read as nothing: it gets a form of its own. */
const FORGETS = 0.002;

/** The form of a signal's values, as it is after `value`. */
export function form_of(signal: Signal, value: number): Form {
  const seen = sizes.get(signal) ?? 0;
  const size = Number.isFinite(value) ? Math.abs(value) : 0;
  // Megawatts stay megawatts while the power swings, and when there is none.
  const hasPrefix = form_for(signal.unit, false, seen).by !== 1;
  const kept = size >= seen || (hasPrefix && size > 0 && size < FORGETS * seen) ? size : seen;
  sizes.set(signal, kept);
  return form_for(signal.unit, is_whole(signal.type), kept);
}

/** Whether a type has whole values only. */
export function is_whole(type: string): boolean {
  return /^(U?[SDL]?INT|BYTE|L?D?WORD)$/.test(type);
}

/** A value of a signal with its name, if the signal names its values, and its unit. */
export function shown(signal: Signal, value: number | undefined): string {
  if (value === undefined) return "–";
  const name = signal.names.get(signal.type !== "BOOL" ? value : value === 0 ? 0 : 1);
  if (name !== undefined) return own(name);
  if (signal.type === "BOOL") return value === 0 ? "FALSE" : "TRUE";
  return in_form(value, form_of(signal, value));
}

/** A value in full, for those who must know all of it. */
export function exact(signal: Signal, value: number | undefined): string {
  if (value === undefined) return "";
  return signal.unit === null ? local(String(value)) : `${local(String(value))} ${signal.unit}`;
}

/** The parts of a name between which it may be broken: after an underscore or a point, never within a word. */
export function breakable(name: string): readonly string[] {
  return name.split(/(?<=[_.])(?=\w)/);
}
