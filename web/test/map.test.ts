import assert from "node:assert/strict";
import { test } from "node:test";
import { count, extremes, greatest_in, level, named, strips, ticks, type Axis, type Table } from "../src/map";
import { decodeMessage } from "../src/message";
import { decodeMapValues, isMap } from "../src/picture";

const even = (cells: number, length: number): Axis => ({ name: "x (m)", edges: Array.from({ length: cells + 1 }, (_, edge) => (edge / cells) * length) });

function shell(): Table {
  const values = new Float32Array(200 * 2000).fill(100);
  values[1234 * 200 + 77] = 300;
  values[5] = Number.NaN;
  return { across: even(200, 60), down: even(2000, 360), values };
}

test("a spot of one cell in a large map is seen, and where it is", () => {
  const table = shell();
  const [columns, rows] = [strips(table.across, 640), strips(table.down, 320)];
  assert.equal(columns.length, 200);
  assert.equal(rows.length, 320);
  assert.deepEqual([columns[0]?.from_px, columns.at(-1)?.to_px, rows.at(-1)?.to, rows.at(-1)?.to_px], [0, 640, 2000, 320]);
  const hot = rows.flatMap((row) => columns.filter((column) => (greatest_in(table, column, row) ?? 0) > 200).map((column) => [column.from, row.from <= 1234 && 1234 < row.to]));
  assert.deepEqual(hot, [[77, true]]);
  assert.deepEqual(extremes(table)?.map(({ column, row, value }) => [column, row, value]), [[0, 0, 100], [77, 1234, 300]]);
});

test("cells that are wider apart at the ends stay where they are", () => {
  const all = strips({ name: "x", edges: [0, 5, 6, 7, 20] }, 200);
  assert.deepEqual(all.map(({ from_px, to_px }) => [from_px, to_px]), [[0, 50], [50, 60], [60, 70], [70, 200]]);
  assert.deepEqual(strips({ name: "x", edges: [3] }, 100), []);
  assert.equal(count({ name: "x", edges: [] }), 0);
});

test("what has no value has no colour, and no place among the greatest", () => {
  const none = { across: even(2, 1), down: even(1, 1), values: new Float32Array([Number.NaN, Number.NaN]) };
  assert.equal(extremes(none), null);
  assert.equal(greatest_in(none, { from_px: 0, to_px: 1, from: 0, to: 2 }, { from_px: 0, to_px: 1, from: 0, to: 1 }), null);
});

test("values beyond the scale have the colour of its end", () => {
  assert.deepEqual([-1, 0, 0.49, 0.5, 1, 7].map((value) => level(value, [0, 1], 24)), [0, 0, 11, 12, 23, 23]);
  assert.equal(level(5, [5, 5], 24), 0);
});

test("axes are marked at round values", () => {
  assert.deepEqual(ticks([0, 60], 5), [0, 20, 40, 60]);
  assert.deepEqual(ticks([-0.05, 0.21], 5), [0, 0.1, 0.2]);
  assert.deepEqual(ticks([17, 380], 5), [100, 200, 300]);
  assert.deepEqual(ticks([1, 1], 5), []);
  // Equal but for the last digit: counting from one to the next would never end.
  assert.deepEqual(ticks([20, 20.000000000000004], 5), []);
});

test("a place is described with its unit", () => {
  const all = ["position (m)", "angle (°)", "line of the revolution"].map((name) => named({ name, edges: [] }, 22.5));
  assert.deepEqual(all, ["position 22.5 m", "angle 22.5°", "line of the revolution 22.5"]);
});

function bytes(map: number, columns: number, rows: number, values: readonly number[]): ArrayBuffer {
  const view = new DataView(new ArrayBuffer(16 + 4 * values.length));
  view.setUint8(0, 2);
  [map, columns, rows].forEach((word, index) => view.setUint32(4 + 4 * index, word, true));
  values.forEach((value, index) => view.setFloat32(16 + 4 * index, value, true));
  return view.buffer as ArrayBuffer;
}

test("values of a map are read, and refused if they are cut or of another map", () => {
  const read = decodeMapValues(bytes(1, 2, 2, [1, 2, 3, 4.5]), 2);
  assert.deepEqual([read.map, read.columns, read.rows, [...read.values]], [1, 2, 2, [1, 2, 3, 4.5]]);
  assert.equal(isMap(bytes(0, 0, 0, [])), true);
  assert.throws(() => decodeMapValues(bytes(2, 1, 1, [1]), 2), /map: is map 2 of 2/);
  assert.throws(() => decodeMapValues(bytes(0, 3, 2, [1]), 1), /has 20 bytes instead of 40/);
  assert.throws(() => decodeMapValues(bytes(0, 1, 1, [1]).slice(0, 9), 1), /has 9 bytes/);
});

test("where cells lie is read, in rising order", () => {
  const message = decodeMessage(JSON.stringify({ type: "map", map: 0, across: { name: "x", edges: [0, 1] }, down: { name: "y", edges: [0, 2, 4] } }));
  assert.ok(message.type === "map" && count(message.down) === 2);
  const falling = { type: "map", map: 0, across: { name: "x", edges: [1, 0] }, down: { name: "y", edges: [] } };
  assert.throws(() => decodeMessage(JSON.stringify(falling)), /across\.edges: do not rise/);
});
