import assert from "node:assert/strict";
import { test } from "node:test";
import { ends_of, parameter } from "../src/fittings";
import type { Component } from "../src/session";

test("rollers are at the ends of a belt along the way it runs", () => {
  const { ends, across, radius } = ends_of([-2, -0.25, -0.04], [2, 0.25, 0.04], [-1, 0, 0]);
  assert.deepEqual(ends, [[-2, 0, 0], [2, 0, 0]]);
  assert.deepEqual([across, radius], [0.5, 0.04]);
  assert.deepEqual(ends_of([0, 0, 0], [1, 3, 0.2], [0, 1, 0]).ends, [[0.5, 0, 0.1], [0.5, 3, 0.1]]);
  assert.ok(ends_of([0, 0, 0], [1, 1, 0], [1, 0, 0]).radius > 0, "a belt without height has rollers that one sees");
});

test("a parameter is its number, whatever stands behind it", () => {
  const component = { parameters: [{ name: "range", value: "0.6", unit: "m" }, { name: "kind", value: "soft", unit: null }] } as unknown as Component;
  assert.deepEqual([parameter(component, "range"), parameter(component, "kind"), parameter(component, "speed")], [0.6, null, null]);
});
