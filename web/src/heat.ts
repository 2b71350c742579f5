// What is hot glows: the colour of a body by its temperature, from the first dark red to white.

import { Color } from "three";
import type { Session } from "./session";

/** Colours of hot steel by temperature, °C, as smiths know them. */
const GLOW: readonly (readonly [number, string])[] = [[500, "#2a0400"], [650, "#6e0e00"], [800, "#b82a00"], [950, "#ec5a08"], [1100, "#ff8f24"], [1250, "#ffc05a"], [1450, "#fff0c8"]];

export interface Heat {
  readonly colour: Color;
  readonly strength: number;
  /** How much of the body's own colour is lost beside it, 0 to 1. */
  readonly dims: number;
}

/** How something glows at a temperature; not at all below the first red. */
export function glow_of(degc: number): Heat | null {
  const first = GLOW[0];
  if (first === undefined || !(degc > first[0])) return null;
  const above = GLOW.findIndex(([at]) => degc < at);
  const [from, to] = above < 0 ? [GLOW[GLOW.length - 1], GLOW[GLOW.length - 1]] : [GLOW[above - 1], GLOW[above]];
  if (from === undefined || to === undefined) return null;
  const share = to[0] > from[0] ? (degc - from[0]) / (to[0] - from[0]) : 1;
  return { colour: new Color(from[1]).lerp(new Color(to[1]), share), strength: 1, dims: Math.min(0.85, 0.25 + (degc - first[0]) / 500) };
}

/** The signals that say how hot a body is, by the body's name: a component on it gives or sees its temperature. */
export function temperatures(session: Session): ReadonlyMap<string, number> {
  const found = new Map<string, number>();
  for (const { body, pins } of session.components) {
    const pin = body === null ? undefined : pins.find(([key]) => /(^|_)(temperature|measured)\w*_degc$/.test(key));
    const signal = pin === undefined ? -1 : session.signals.findIndex((one) => one.name === pin[1]);
    if (body !== null && signal >= 0 && !found.has(body)) found.set(body, signal);
  }
  return found;
}
