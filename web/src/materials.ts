// What bodies are made of, for their colour: what the scene says of them tells it well enough.

import type { Text } from "./say";
import type { Body, Session } from "./session";

export interface Material {
  readonly name: Text;
  readonly colour: string;
}

const RUBBER: Material = { name: "rubber", colour: "#3a4146" };
/** Materials by their least density, kg/m³, the heaviest first. */
const BY_DENSITY: readonly (readonly [number, Material])[] = [
  [5000, { name: "steel", colour: "#a7b0b7" }],
  [2000, { name: "aluminium", colour: "#c6ccd1" }],
  [1050, { name: "plastic", colour: "#7f9fbd" }],
  [350, { name: "wood", colour: "#bb8f5c" }],
  [0, { name: "cardboard", colour: "#cfac76" }],
];

/** The bodies that are belts. */
export function belts(session: Session): ReadonlySet<string> {
  return new Set(session.components.flatMap(({ kind, place }) => (kind === "conveyor" && place?.moves != null ? [place.moves] : [])));
}

/** What a body is made of; nothing where nobody can tell. */
export function material_of({ name, kind, density_kg_m3 }: Body, belts: ReadonlySet<string>): Material | null {
  if (belts.has(name)) return RUBBER;
  if (kind !== "dynamic" || density_kg_m3 === null) return null;
  return BY_DENSITY.find(([least]) => density_kg_m3 >= least)?.[1] ?? null;
}
