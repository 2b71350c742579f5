import assert from "node:assert/strict";
import { test } from "node:test";
import { ProtocolError } from "../src/field";
import { decodeAnswer, decodeLibrary, decodeState } from "../src/construct/protocol";
import { columns, fits, rows } from "../src/construct/rows";
import { free, snap } from "../src/construct/snap";

const hook = (client: string, ...at: string[]): object => ({ client, at });
const end = (client: string, at: string, gives: boolean, signals: string[]): object =>
  ({ client, at, type: "BOOL", gives, signals, hand: { kind: "variable", path: at } });

const STATE = {
  protocol: 1, scenario: "s", revision: 3, undo: "move box", redo: null, changed: [],
  findings: [{ is_error: true, message: "m", file: "plant.toml", line: 4 }],
  clients: [{ name: "plc", kind: "soft-plc" }, { name: "plant", kind: "plant", scene: "plant.toml" }],
  signals: ["Seen", "Push", "Bad"],
  map: {
    signals: [
      { name: "Seen", type: "BOOL", writer: hook("plant", "eye.detected"), readers: [] },
      { name: "Push", type: "BOOL", writer: hook("plc", "Main.Push"), readers: [hook("plant", "ram.extend")] },
      { name: "Bad", type: "BOOL", writer: hook("plc"), readers: [hook("plant", "ram.retract")] },
    ],
    troubles: [{ kind: "unread", signal: "Seen", message: "nobody" }, { kind: "unconnected", signal: "Bad", message: "no variable" }],
  },
  ends: [end("plant", "eye.detected", true, ["Seen"]), end("plant", "ram.extend", false, ["Push"]), end("plc", "Main.Push", true, ["Push"]), end("plc", "Main.Box", false, [])],
  scenes: [{ file: "plant.toml", bodies: null, tables: [{ sort: "body", name: "box[0..3]", line: 3, keys: { size_m: [1, 2, 3], collides: false, more: { a: null } } }] }],
};

test("a state is read, with tables of any keys", () => {
  const state = decodeState(STATE);
  assert.equal(state.scenes[0]?.tables[0]?.keys.get("collides"), false);
  assert.equal(state.findings[0]?.line, 4);
  assert.equal(decodeAnswer({ error: { message: "no", references: [{ by: "b", file: "f", line: 2 }] }, state: STATE }).error?.references[0]?.line, 2);
});

test("what is wrong in a state is named by its place", () => {
  const wrong: readonly (readonly [object, string])[] = [
    [{ ...STATE, protocol: 2 }, "protocol"],
    [{ ...STATE, revision: "3" }, "revision"],
    [{ ...STATE, ends: [{ client: "plc" }] }, "ends[0].at"],
    [{ ...STATE, scenes: [{ file: "f", bodies: [{}], tables: [] }] }, "scenes[0].bodies[0].name"],
  ];
  for (const [value, place] of wrong) {
    assert.throws(() => decodeState(value), (error) => error instanceof ProtocolError && error.place === place, place);
  }
  for (const value of [null, 1, "x", [], { error: 3 }]) assert.throws(() => decodeAnswer(value), ProtocolError);
});

test("a library is read, and a form that is not known is refused", () => {
  const field = (form: object): object => ({ key: "speed_m_s", name: "speed", unit: "m/s", about: "a", form, needed: false, preset: 0.5, part: "parameter" });
  const library = (form: object): object => ({ protocol: 1, kinds: [{ name: "conveyor", about: "a", types: { run_signal: "BOOL" }, fields: [field(form)] }], sorts: [] });
  const read = decodeLibrary(library({ kind: "number", least: 0, most: 2 }));
  assert.deepEqual(read.kinds[0]?.fields[0]?.form, { kind: "number", least: 0, most: 2 });
  assert.throws(() => decodeLibrary(library({ kind: "matrix" })), /kinds\[0\]\.fields\[0\]\.form: is a `matrix`/);
});

test("rows: what is wrong first, then lines, then ends without one", () => {
  const state = decodeState(STATE);
  assert.deepEqual(columns(state).map((client) => client.name), ["plant", "plc"]);
  const all = rows(state, "");
  assert.deepEqual(all.map((row) => row.signal), ["Bad", "Seen", "Push", null]);
  assert.deepEqual(all.map((row) => row.isError), [true, false, false, false]);
  const [bad, seen, push, loose] = all;
  assert.deepEqual(bad?.dots.map((dot) => dot.tip), [{ signal: "Bad" }, { signal: "Bad" }]);
  assert.equal(seen?.trouble, "nobody");
  assert.deepEqual(push?.dots.map((dot) => [dot.column, dot.label]), [[1, "Main.Push"], [0, "ram.extend"]]);
  assert.deepEqual(loose?.dots.map((dot) => [dot.column, dot.label, dot.isOpen]), [[1, "Main.Box", true]]);
  assert.ok(seen?.dots[0] && loose?.dots[0] && fits(seen.dots[0], loose.dots[0]));
  assert.deepEqual(rows(state, "extend").map((row) => row.signal), ["Push"]);
});

test("places are put on the grid as people would write them", () => {
  assert.equal(snap(0.3712, 0.05), 0.35);
  assert.equal(snap(-0.07, 0.1), -0.1);
  assert.equal(snap(0.123456, 0), 0.1235);
  assert.equal(free("box", ["box[0..3]", "box_2"]), "box_3");
  assert.equal(free("belt", []), "belt");
});
