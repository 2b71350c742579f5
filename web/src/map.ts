// A map: what of a table of values is seen in each pixel, which of them is the greatest, and where an axis is marked. Nothing of the
// page is in here.

/** An axis of a map. */
export interface Axis {
  /** What it is, with its unit. */
  readonly name: string;
  /** Where each cell begins, and where the last one ends; in rising order. */
  readonly edges: readonly number[];
}

/** Where the cells of a map lie. */
export interface Cells {
  readonly across: Axis;
  readonly down: Axis;
}

/** A map at one moment. */
export interface Table extends Cells {
  /** Row after row; what is not a number is not a value. */
  readonly values: Float32Array;
}

/** Cells that share a stretch of pixels. */
export interface Strip {
  readonly from_px: number;
  readonly to_px: number;
  readonly from: number;
  readonly to: number;
}

/** A cell with its value. */
export interface Cell {
  readonly column: number;
  readonly row: number;
  readonly value: number;
}

/** How many cells an axis has. */
export function count(axis: Axis): number {
  return Math.max(0, axis.edges.length - 1);
}

/** The first value of an axis and the last. */
export function ends(axis: Axis): readonly [number, number] {
  const [low, high] = [axis.edges[0] ?? 0, axis.edges.at(-1) ?? 1];
  return [low, high > low ? high : low + 1];
}

/** The middle of a cell. */
export function middle(axis: Axis, cell: number): number {
  return ((axis.edges[cell] ?? 0) + (axis.edges[cell + 1] ?? 0)) / 2;
}

/** A place on an axis in words: its name is written `position (m)`, and a place as `position 22 m`. */
export function named(axis: Axis, value: number): string {
  const [, name, unit] = /^(.+) \((.+)\)$/.exec(axis.name) ?? [];
  if (name === undefined || unit === undefined) return `${axis.name} ${value}`;
  return unit === "°" ? `${name} ${value}°` : `${name} ${value} ${unit}`;
}

/** The cells of an axis, or, where they are smaller than a pixel, its pixels. */
export function strips(axis: Axis, length_px: number): readonly Strip[] {
  const [low, high] = ends(axis);
  const at_px = (value: number): number => Math.round(((value - low) / (high - low)) * length_px);
  const all: Strip[] = [];
  for (let cell = 0; cell < count(axis); cell += 1) {
    const to_px = at_px(axis.edges[cell + 1] ?? high);
    const last = all.at(-1);
    const from_px = last?.to_px ?? at_px(axis.edges[cell] ?? low);
    if (last !== undefined && to_px <= last.to_px) all[all.length - 1] = { ...last, to: cell + 1 };
    else if (to_px > from_px) all.push({ from_px, to_px, from: cell, to: cell + 1 });
  }
  return all;
}

/** The greatest value in a strip of columns and one of rows: a hot spot of one cell does not vanish. */
export function greatest_in(table: Table, column: Strip, row: Strip): number | null {
  const columns = count(table.across);
  let greatest: number | null = null;
  for (let y = row.from; y < row.to; y += 1) {
    for (let x = column.from; x < column.to; x += 1) {
      const value = table.values[y * columns + x];
      if (value !== undefined && Number.isFinite(value) && (greatest === null || value > greatest)) greatest = value;
    }
  }
  return greatest;
}

/** The least and the greatest cell of a map; nothing if it has no value. */
export function extremes(table: Table): readonly [Cell, Cell] | null {
  const columns = Math.max(1, count(table.across));
  let least: Cell | null = null;
  let greatest: Cell | null = null;
  for (const [index, value] of table.values.entries()) {
    if (!Number.isFinite(value)) continue;
    const cell = { column: index % columns, row: Math.floor(index / columns), value };
    if (least === null || value < least.value) least = cell;
    if (greatest === null || value > greatest.value) greatest = cell;
  }
  return least === null || greatest === null ? null : [least, greatest];
}

/** The place of a value among so many colours of a scale. */
export function level(value: number, [low, high]: readonly [number, number], colours: number): number {
  const part = (value - low) / (high > low ? high - low : 1);
  return Math.min(colours - 1, Math.max(0, Math.floor(part * colours)));
}

/** Beyond this, marks of an axis are closer than numbers can tell them apart. */
const COUNTED_MOST = 1e12;

/** Round values within a range, as many as asked for or fewer. */
export function ticks([low, high]: readonly [number, number], most: number): readonly number[] {
  const rough = (high - low) / most;
  if (!(rough > 0) || !Number.isFinite(rough)) return [];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough * (1 - 1e-9)) ?? 10 * power;
  const first = Math.ceil(low / step - 1e-9);
  // Values that differ in their last digits only: there are no round ones between them, and counting would not get on.
  if (Math.abs(first) > COUNTED_MOST) return [];
  const marks: number[] = [];
  for (let index = first; index * step <= high + step * 1e-9; index += 1) marks.push(Number((index * step).toPrecision(12)));
  return marks;
}
