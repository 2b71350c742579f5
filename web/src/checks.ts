// What arrives, where a type cannot say all that is right: generated readers call these. Each gives its value back.

import type { Field } from "./field";

/** A mesh has whole triangles, of vertices that are there. */
export function check_shape<S extends { readonly kind: string }>(field: Field, shape: S): S {
  const { positions_m = [], indices = [] } = shape as { readonly positions_m?: readonly number[]; readonly indices?: readonly number[] };
  const vertices = positions_m.length / 3;
  if (!Number.isInteger(vertices)) field.fail("has positions that are not triples");
  if (indices.length % 3 !== 0) field.fail("has indices that are not triangles");
  for (const index of indices) {
    if (!Number.isInteger(index) || index < 0 || index >= vertices) field.fail(`has no vertex ${index}`);
  }
  return shape;
}

/** The edges of an axis rise. */
export function check_axis<A extends { readonly edges: readonly number[] }>(field: Field, axis: A): A {
  const { edges } = axis;
  if (edges.some((edge, index) => index > 0 && edge < (edges[index - 1] ?? edge))) field.at("edges").fail("do not rise");
  return axis;
}

interface Wired {
  readonly elements: readonly { readonly pins: readonly unknown[] }[];
  readonly wires: readonly { readonly from: readonly [number, number]; readonly to: readonly [number, number] }[];
}

/** The wires of a drawing end at pins that are there. */
export function check_drawing<D extends Wired>(field: Field, drawing: D): D {
  field.at("wires").list((wire) => wire).forEach((wire, place) => {
    for (const key of ["from", "to"] as const) {
      const [element = -1, pin = -1] = drawing.wires[place]?.[key] ?? [];
      if (drawing.elements[element]?.pins[pin] === undefined) wire.at(key).fail("names a pin that is not there");
    }
  });
  return drawing;
}
