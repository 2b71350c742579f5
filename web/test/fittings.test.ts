import assert from "node:assert/strict";
import { test } from "node:test";
import { parameter } from "../src/fitted";
import { Vector3 } from "three";
import { along_of, drawn_otherwise, ends_of } from "../src/fittings";
import { glow_of, temperatures } from "../src/heat";
import { material_of } from "../src/materials";
import { lamp_colour, standing } from "../src/standing";
import type { Body, Component, Session } from "../src/session";

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

test("a component whose bodies the scenario draws itself has no shape", () => {
  const body = (name: string, kind = "dynamic", on: number | null = null): unknown => ({ name, kind, on });
  const session = {
    bodies: [body("mast"), body("ram"), body("bare"), body("skin", "figure", 0), body("cap", "figure", 3), body("sign", "figure")],
    looks: [{ bodies: [1], when: null, hidden: true, transparent: null }, { bodies: [2], when: "x", hidden: true, transparent: null }],
  } as unknown as Session;
  assert.deepEqual([...drawn_otherwise(session)].sort(), ["mast", "ram"]);
});

const component = (kind: string, parameters: readonly [string, string][], name = kind): Component =>
  ({ name, kind, parameters: parameters.map(([key, value]) => ({ name: key, value })), place: { point_m: [0, 0, 0] } }) as unknown as Component;

test("the level of a tank is that of its signal", () => {
  const tank = standing(component("tank", [["area", "0.5"], ["height", "2"], ["initial", "0.4"]]), []);
  assert.ok(tank !== null);
  const liquid = tank.node.getObjectByName("liquid");
  assert.ok(liquid !== undefined);
  assert.ok(Math.abs(liquid.scale.z - 0.2) < 1e-9, "before a value has come it is that of the set-up");
  tank.show((key) => (key === "level_m" ? 1.5 : null));
  assert.ok(Math.abs(liquid.scale.z - 0.75) < 1e-9);
  tank.show(() => 9);
  assert.equal(liquid.scale.z, 1, "no more than full");
});

const PARTS = ["stack_light", "key_switch", "two_hand_station", "barcode_reader", "rfid_head", "weighing_cell"];

test("the beams of a curtain lie upwards, across their way", () => {
  const along = (way: [number, number, number]): number[] => along_of(new Vector3(...way)).toArray();
  assert.deepEqual([along([0, 1, 0]), along([0, 0, 1])], [[0, 0, 1], [1, 0, 0]]);
  const tilted = along([0.6, 0, 0.8]);
  assert.ok(Math.abs((tilted[0] ?? 0) + 0.8) < 1e-12 && Math.abs((tilted[2] ?? 0) - 0.6) < 1e-12, String(tilted));
});

test("a part shows what its signals say, and begins dark", () => {
  for (const kind of PARTS) {
    const part = standing(component(kind, []), []);
    assert.ok(part !== null && part.follows.length > 0, kind);
    part.show(() => null);
    part.show(() => 1);
  }
});

test("each kind that stands by itself has a shape, and no other", () => {
  for (const kind of ["tank", "lamp", "push_button", "emergency_stop", "heater", "hydraulic_unit", "inductive_sensor", ...PARTS]) {
    assert.ok(standing(component(kind, []), []) !== null, kind);
  }
  assert.equal(standing(component("gate", []), []), null);
});

test("a lamp has the colour of its name", () => {
  const colours = ["Alarm_lamp", "ready", "Warning", "h3"].map((name) => lamp_colour(name));
  assert.deepEqual(colours, ["#d8262c", "#2fae4d", "#f0a818", "#e9edf0"]);
});

test("what is hot glows, the brighter the hotter", () => {
  assert.equal(glow_of(450), null);
  assert.equal(glow_of(Number.NaN), null);
  const light = [550, 700, 900, 1100, 1300, 2000].map((degc) => glow_of(degc)?.colour.getHSL({ h: 0, s: 0, l: 0 }).l ?? 0);
  assert.ok(light.every((one, at) => at === 0 || one > (light[at - 1] ?? 1)), String(light));
});

test("the temperature of a body is what a component on it gives or sees", () => {
  const session = {
    signals: [{ name: "Level" }, { name: "Shell" }],
    components: [
      { body: "shell", pins: [["level_m", "Level"]] }, { body: "shell", pins: [["measured_degc", "Shell"]] }, { body: null, pins: [["temperature_degc", "Shell"]] },
    ],
  } as unknown as Session;
  assert.deepEqual([...temperatures(session)], [["shell", 1]]);
});

test("a material is that of a belt, or of a density", () => {
  const body = (name: string, kind: string, density_kg_m3: number | null): Body => ({ name, kind, density_kg_m3 }) as Body;
  const name = (of: Body): string | undefined => material_of(of, new Set(["belt"]))?.name;
  assert.deepEqual([name(body("belt", "kinematic", null)), name(body("frame", "fixed", null)), name(body("ram", "dynamic", null))], ["rubber", undefined, undefined]);
  assert.deepEqual([7850, 2700, 1400, 600, 120].map((density) => name(body("one", "dynamic", density))), ["steel", "aluminium", "plastic", "wood", "cardboard"]);
});
