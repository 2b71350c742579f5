// Values as they are read.

import type { Signal } from "./session";

/** Virtual time as seconds with three places. */
export function seconds(t_ns: number): string {
  return `${(t_ns / 1e9).toFixed(3)} s`;
}

/** A value of a signal with its name, if the signal names its values, and its unit. */
export function shown(signal: Signal, value: number | undefined): string {
  if (value === undefined) return "–";
  if (signal.type === "BOOL") return value === 0 ? "FALSE" : "TRUE";
  const name = signal.names.get(value);
  if (name !== undefined) return name;
  const digits = Number.isInteger(value) ? String(value) : Number(value.toPrecision(6)).toString();
  return signal.unit === null ? digits : `${digits} ${signal.unit}`;
}
