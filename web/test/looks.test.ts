import assert from "node:assert/strict";
import { test } from "node:test";
import { Looks, share_of } from "../src/looks";
import { decodeSession, type Session } from "../src/session";

function session(looks: readonly object[]): Session {
  return decodeSession({
    protocol: 1, title: "t", scenario: "s", step_ns: 1, signals: [{ name: "x", type: "LREAL", writer: "plant" }], looks,
    bodies: [{ name: "tank", kind: "figure", shape: { kind: "box", size_m: [1, 1, 2] }, position_m: [0, 0, 1] }],
  });
}

test("a share is along the way, and never beyond its ends", () => {
  assert.deepEqual([10, 20, 15, 0, 99, NaN].map((value) => share_of(value, [10, 20])), [0, 1, 0.5, 0, 1, 0]);
  assert.equal(share_of(15, [20, 10]), 0.5);
  assert.equal(share_of(-3, null), -3);
});

test("looks are on while their condition holds; later ones go before earlier ones", () => {
  const looks = new Looks(session([
    { bodies: [0], when: "x > 1", colour: "#ff0000" },
    { bodies: [0], when: "x > 2", colour: "#0000ff", hidden: true },
    { bodies: [0], transparent: 0.5 },
  ]));
  assert.equal(looks.of(0)?.colour, null);
  assert.equal(looks.of(0)?.transparent, 0.5);
  looks.hold([0]);
  assert.equal(looks.of(0)?.colour?.getHexString(), "ff0000");
  looks.hold([0, 1]);
  assert.equal(looks.of(0)?.colour?.getHexString(), "0000ff");
  assert.equal(looks.of(0)?.isHidden, true);
  assert.equal(looks.of(1), null);
});

test("a value drives places, sizes and colours", () => {
  const looks = new Looks(session([
    { bodies: [0], follows: 0, over: [0, 4], grow: "z", move_m: [0, 0, 2], colours: ["#000000", "#ffffff"] },
    { bodies: [0], follows: 0, turn_deg: [0, 0, 90], turn_about_m: [1, 0, 0] },
  ]));
  assert.deepEqual(looks.signals(), [0, 0]);
  looks.value(0, 2);
  looks.advance(0);
  const style = looks.of(0);
  assert.deepEqual(style?.grown, [1, 1, 0.5]);
  assert.deepEqual(style?.moved_m.toArray(), [0, 0, 1]);
  assert.deepEqual(style?.turns[0]?.about_m, [1, 0, 0]);
  // Twice a quarter turn about z is a half turn.
  assert.deepEqual(style?.turns[0]?.by.toArray().map((part) => Math.round(Math.abs(part) * 1e9) / 1e9), [0, 0, 1, 0]);
});

test("a way that takes its time is gone in virtual time, and jumped over when the time is another one", () => {
  const looks = new Looks(session([{ bodies: [0], follows: 0, over: [0, 1], takes_s: 10, move_m: [1, 0, 0] }]));
  const x = (): number | undefined => looks.of(0)?.moved_m.x;
  looks.value(0, 0);
  looks.advance(0);
  looks.value(0, 1);
  assert.equal(looks.advance(4e9), true);
  assert.equal(x(), 0.4);
  looks.advance(4e9);
  assert.equal(x(), 0.4, "while time is held nothing moves");
  looks.advance(20e9);
  assert.equal(x(), 1);
  looks.value(0, 0);
  looks.jump();
  looks.advance(21e9);
  assert.equal(x(), 0);
});
