import assert from "node:assert/strict";
import { test } from "node:test";
import { Sharpness } from "../src/sharpness";

/** Pictures that come `span_ms` apart; the share after them. */
function pictures(sharpness: Sharpness, span_ms: number, count: number, from_ms = 0): number {
  for (let index = 0; index < count; index += 1) sharpness.drawn(from_ms + index * span_ms);
  return sharpness.share;
}

test("what is drawn too slowly is drawn with fewer pixels, and no fewer than half", () => {
  const sharpness = new Sharpness();
  assert.equal(pictures(sharpness, 16, 100), 1);
  assert.equal(pictures(sharpness, 80, 14, 10_000), 0.75);
  assert.equal(pictures(sharpness, 80, 100, 20_000), 0.55);
});

test("it gets sharp again once, and does not flicker", () => {
  const sharpness = new Sharpness();
  pictures(sharpness, 60, 14);
  assert.equal(pictures(sharpness, 16, 14, 10_000), 1);
  assert.equal(pictures(sharpness, 60, 14, 20_000), 0.75);
  assert.equal(pictures(sharpness, 16, 100, 30_000), 0.75);
});

test("a rest is not a slow picture", () => {
  assert.equal(pictures(new Sharpness(), 1000, 100), 1);
});
