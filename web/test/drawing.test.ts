import assert from "node:assert/strict";
import { test } from "node:test";
import { corners } from "../src/drawing";
import { FlowOf } from "../src/flow";
import type { Drawing, DrawingElement } from "../src/session";

function element(kind: string, text: string, marks: string[] = [], pins: string[] = ["", ">"]): DrawingElement {
  return {
    id: text, kind, text, instance: null, state: kind === "contact" || kind === "coil" || kind === "inVariable" ? text : kind === "step" ? `${text}.X` : null,
    marks, at: [0, 0], size: [1, 1], line: 1,
    pins: pins.map((name) => ({ name: name.replace(">", ""), output: name.startsWith(">"), marks: [], state: null, at: [0, 0] })),
  };
}

/** Elements in a row, each connected to the one before, or as `wires` says. */
function drawing(elements: DrawingElement[], wires: [number, number, number, number][]): Drawing {
  return {
    path: "a.xml", unit: "A", part: null, language: "ladder", elements, instances: [], states: [],
    wires: wires.map(([a, b, c, d]) => ({ from: [a, b], to: [c, d], points: [[0, 0], [1, 1]], line: 1 })),
  };
}

test("power flows through contacts that conduct, and through one of several ways", () => {
  const rung = drawing(
    [element("leftPowerRail", "", [], [">"]), element("contact", "a"), element("contact", "b", ["negated"]), element("contact", "c"), element("coil", "q")],
    [[0, 0, 1, 0], [1, 1, 2, 0], [0, 0, 3, 0], [2, 1, 4, 0], [3, 1, 4, 0]],
  );
  const coil = (values: Record<string, number | null>): number | null => new FlowOf(rung, (path) => values[path] ?? null).into(4, 0);
  assert.equal(coil({ a: 1, b: 0, c: 0 }), 1);
  assert.equal(coil({ a: 1, b: 1, c: 0 }), 0);
  assert.equal(coil({ a: 0, b: 1, c: 1 }), 1);
  assert.equal(coil({ a: 0, b: null, c: 0 }), 0, "nothing flows behind a contact that is open");
  assert.equal(coil({ a: 1, b: null, c: 0 }), null);
});

test("functions are worked out, with their enable", () => {
  const blocks = drawing(
    [element("inVariable", "x", [], [">"]), element("inVariable", "y", [], [">"]), element("inVariable", "on", [], [">"]),
      element("block", "GT", [], ["EN", "IN1", "IN2", ">ENO", ">OUT"])],
    [[2, 0, 3, 0], [0, 0, 3, 1], [1, 0, 3, 2]],
  );
  const out = (values: Record<string, number>, pin: number): number | null => new FlowOf(blocks, (path) => values[path] ?? null).out(3, pin);
  assert.equal(out({ x: 2, y: 1, on: 1 }, 4), 1);
  assert.equal(out({ x: 1, y: 1, on: 1 }, 4), 0);
  assert.equal(out({ x: 1, y: 1, on: 0 }, 4), null, "what is not enabled is not worked out");
  assert.equal(out({ x: 1, y: 1, on: 0 }, 3), 0);
});

test("a loop has no value of its own, and ends", () => {
  const loop = drawing([element("block", "OR", [], ["IN1", "IN2", ">OUT"])], [[0, 2, 0, 0], [0, 2, 0, 1]]);
  assert.equal(new FlowOf(loop, () => null).out(0, 2), null);
});

test("wires turn at right angles, and go back around a chart", () => {
  const wire = (points: [number, number][]) => ({ from: [0, 0] as const, to: [0, 0] as const, points, line: 1 });
  assert.deepEqual(corners(wire([[0, 0], [10, 20]]), false, 0), [[0, 0], [5, 0], [5, 20], [10, 20]]);
  assert.deepEqual(corners(wire([[0, 0], [10, 20]]), true, 0), [[0, 0], [0, 10], [10, 10], [10, 20]]);
  const back = corners(wire([[50, 100], [50, 10]]), true, 0);
  assert.ok(back.some(([x]) => x < 0) && back[0]?.[1] === 100 && back[back.length - 1]?.[1] === 10);
});
