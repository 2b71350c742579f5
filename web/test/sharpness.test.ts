import assert from "node:assert/strict";
import { test } from "node:test";
import { Sharpness } from "../src/sharpness";

/** Pictures that come `span_ms` apart; the share after them. */
function pictures(sharpness: Sharpness, span_ms: number, count: number, from_ms = 0): number {
  for (let index = 0; index < count; index += 1) sharpness.drawn(from_ms + index * span_ms);
  return sharpness.share;
}

test("what is drawn too slowly is drawn plainly, then with fewer pixels, and no fewer than half", () => {
  const sharpness = new Sharpness();
  assert.equal(pictures(sharpness, 16, 100), 1);
  assert.equal(sharpness.isPlain, false);
  assert.equal(pictures(sharpness, 80, 14, 10_000), 1);
  assert.equal(sharpness.isPlain, true);
  assert.equal(pictures(sharpness, 80, 14, 20_000), 0.75);
  assert.equal(pictures(sharpness, 80, 100, 40_000), 0.55);
});

test("what is very slow is seen after three pictures", () => {
  const sharpness = new Sharpness();
  pictures(sharpness, 600, 4);
  assert.equal(sharpness.isPlain, true);
});

test("many bodies are drawn plainly at once", () => {
  assert.equal(new Sharpness(true).isPlain, true);
  assert.equal(new Sharpness(true).share, 1);
});

test("it gets sharp again once, and does not flicker", () => {
  const sharpness = new Sharpness();
  pictures(sharpness, 60, 14);
  assert.equal(sharpness.isPlain, true);
  pictures(sharpness, 16, 14, 10_000);
  assert.equal(sharpness.isPlain, false);
  pictures(sharpness, 60, 14, 20_000);
  assert.equal(sharpness.isPlain, true);
  pictures(sharpness, 16, 100, 30_000);
  assert.equal(sharpness.isPlain, true);
});

test("a rest is not a slow picture", () => {
  assert.equal(pictures(new Sharpness(), 4000, 100), 1);
  const sharpness = new Sharpness();
  for (let index = 0; index < 100; index += 1) {
    sharpness.rest();
    sharpness.drawn(index * 1000);
  }
  assert.equal(sharpness.isPlain, false);
});
