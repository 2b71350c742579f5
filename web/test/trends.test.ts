import assert from "node:assert/strict";
import { test } from "node:test";
import { moments } from "../src/backfill";
import { fitted } from "../src/lane";
import { span_s } from "../src/trends";

test("the past is asked for at whole steps, at most some hundred times, and not further back than can be run again", () => {
  assert.deepEqual(moments([0, 50], 10), [0, 10, 20, 30, 40, 50]);
  const long = moments([0, 3600e9], 10_000_000);
  assert.ok(long.length <= 242, `${long.length}`);
  assert.equal(long[0], (360_000 - 6_000) * 10_000_000);
  assert.ok(long.every((t_ns, at) => t_ns % 10_000_000 === 0 && (at === 0 || t_ns > (long[at - 1] as number))));
  assert.deepEqual(moments([7, 7], 10), []);
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
