import assert from "node:assert/strict";
import { test } from "node:test";
import { spans } from "../src/backfill";
import { fitted } from "../src/lane";
import { span_s } from "../src/trends";

test("the past is asked for at whole steps, in a few spans without a gap, and not further back than can be run again", () => {
  assert.deepEqual(spans([0, 50], 10), [[0, 10], [10, 20], [20, 30], [30, 40], [40, 50]]);
  const long = spans([0, 3600e9], 10_000_000);
  assert.ok(long.length <= 12, `${long.length}`);
  assert.deepEqual([long[0]?.[0], long.at(-1)?.[1]], [(360_000 - 6_000) * 10_000_000, 3600e9]);
  assert.ok(long.every(([from], at) => at === 0 || from === long[at - 1]?.[1]));
  assert.deepEqual(spans([7, 7], 10), []);
});

test("trends show the last seconds, and the moment of the past within what surrounds it", () => {
  assert.deepEqual(span_s(5, null), [0, 20]);
  assert.deepEqual(span_s(48, null), [28, 48]);
  assert.deepEqual(span_s(48, 40), [28, 48]);
  assert.deepEqual(span_s(48, 18.76), [8.760000000000002, 28.76]);
  assert.deepEqual(span_s(48, 2), [0, 20]);
});

test("a mark of an axis is no wider than its room", () => {
  const width = (text: string): number => text.length * 6;
  assert.equal(fitted("Idle", 48, width), "Idle");
  assert.equal(fitted("Program_Init", 48, width), "Program…");
  assert.equal(fitted("Program_Init", 2, width), "…");
});
