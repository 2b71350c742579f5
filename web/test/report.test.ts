import assert from "node:assert/strict";
import { test } from "node:test";
import { aligned, value_at, written, type ChartPanel } from "../src/report/data";

const panel = (steps: boolean): ChartPanel => ({
  signal: "x", unit: "mm", steps, names: [[2, "open"]],
  runs: [
    { t_ns: [0, 2e9, 4e9], values: [0, 2, null] },
    { t_ns: [0, 1e9], values: [5, 6] },
  ],
});

test("runs of different times stand over one axis, and only a missing value is a gap", () => {
  assert.deepEqual(aligned(panel(true)), [[0, 1, 2, 4], [0, undefined, 2, null], [5, 6, undefined, undefined]]);
});

test("a step holds its value, a line goes from one to the next", () => {
  assert.equal(value_at(panel(true), 0, 1), 0);
  assert.equal(value_at(panel(false), 0, 1), 1);
  assert.equal(value_at(panel(false), 0, 2), 2);
  assert.equal(value_at(panel(true), 0, 4.5), null);
  assert.equal(value_at(panel(true), 1, 1), 6);
  assert.equal(value_at(panel(true), 1, 1.5), null, "after its end a run is not known");
  assert.equal(value_at(panel(true), 0, -1), null);
  assert.equal(value_at(panel(true), 7, 0), null);
});

test("a value has its name or its unit", () => {
  assert.deepEqual([written(panel(true), 2), written(panel(true), 1 / 3), written(panel(true), null)], ["open", "0.333333 mm", "–"]);
});
