import assert from "node:assert/strict";
import { test } from "node:test";
import { share_of_way, strips } from "../src/schematic";
import { decodeSession } from "../src/session";

const signal = (name: string, type: string, writer: string) => ({ name, type, writer, unit: null, about: "" });
const component = (name: string, kind: string, signals: readonly string[], parameters: Readonly<Record<string, string>>) =>
  ({ name, kind, body: null, senses: null, signals, failures: [], parameters: Object.entries(parameters).map(([one, value]) => ({ name: one, value, unit: null })) });
const SESSION = {
  protocol: 1, title: "t", scenario: "s", step_ns: 10_000_000, until_ns: null,
  signals: [
    signal("Command.Feeder.TargetPosition", "REAL", "plc"), signal("Feedback.Feeder.ActualPosition", "REAL", "plant"),
    signal("Feedback.Feeder.Enabled", "BOOL", "plant"), signal("Pump", "LREAL", "plc"), signal("Level", "LREAL", "plant"), signal("Gap", "LREAL", "plant"),
  ],
  components: [
    component("block", "veneer_lathe", ["Gap"], {}),
    component("tank", "tank", ["Pump", "Level"], { height: "2" }),
    component("Feeder", "command_axis", ["Command.Feeder.TargetPosition", "Feedback.Feeder.ActualPosition", "Feedback.Feeder.Enabled"], { lower: "0", upper: "65000" }),
  ],
  plcs: [{ client: "plc", variables: [] }],
};

test("a machine without bodies is its axes with their limits, its tanks, and the rest", () => {
  const all = strips(decodeSession(SESSION));
  assert.deepEqual(all.map((one) => [one.component.name, one.form, one.place, one.target, one.limits]), [
    ["Feeder", "axis", 1, 0, [0, 65000]], ["tank", "tank", 4, null, [0, 2]], ["block", "other", null, null, null],
  ]);
  assert.deepEqual([all[0]?.states, all[2]?.readings], [[2], [5]]);
});

test("a machine with bodies is drawn by them", () => {
  const body = { name: "belt", kind: "fixed", shape: { kind: "box", size_m: [1, 2, 3] }, colour: null, position_m: [0, 0, 0] };
  assert.deepEqual(strips(decodeSession({ ...SESSION, bodies: [body] })), []);
});

test("a place is within its way", () => {
  assert.deepEqual([-1, 0, 1, 3].map((value) => share_of_way(value, [0, 2])), [0, 0, 0.5, 1]);
  assert.equal(share_of_way(1, [1, 1]), 0);
});
