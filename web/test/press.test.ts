import assert from "node:assert/strict";
import { test } from "node:test";
import { why_not } from "../src/panels";
import { Press } from "../src/press";

/** A key, what it wrote, and a clock that is put on by hand. */
function key(): { press: Press; written: number[]; wait: (ms: number) => void } {
  let now = 0;
  let later: { at: number; deed: () => void }[] = [];
  const written: number[] = [];
  const press = new Press((value) => written.push(value), (deed, ms) => later.push({ at: now + ms, deed }));
  const wait = (ms: number): void => {
    now += ms;
    const due = later.filter((one) => one.at <= now);
    later = later.filter((one) => one.at > now);
    for (const one of due) one.deed();
  };
  return { press, written, wait };
}

test("a press of no time at all rises, is seen, and falls", () => {
  const { press, written, wait } = key();
  press.press(true);
  press.press(false);
  assert.deepEqual(written, [1], "it does not fall before the session has it");
  wait(100);
  assert.deepEqual(written, [1]);
  press.seen(true);
  assert.deepEqual(written, [1, 0]);
});

test("a key that is held falls when it is let go", () => {
  const { press, written, wait } = key();
  press.press(true);
  press.seen(true);
  wait(500);
  assert.deepEqual(written, [1]);
  press.press(false);
  press.press(false);
  assert.deepEqual(written, [1, 0]);
});

test("where the session never shows it, the key is let go all the same", () => {
  const { press, written, wait } = key();
  press.press(true);
  press.press(false);
  wait(100);
  wait(900);
  assert.deepEqual(written, [1, 0]);
  press.press(true);
  assert.deepEqual(written, [1, 0, 1]);
});

test("while time stands a key waits for its step", () => {
  let isHeld = true;
  const later: (() => void)[] = [];
  const written: number[] = [];
  const press = new Press((value) => written.push(value), (deed) => later.push(deed), () => isHeld);
  const wait = (): void => later.splice(0).forEach((deed) => deed());
  press.press(true);
  press.press(false);
  wait();
  wait();
  assert.deepEqual(written, [1]);
  isHeld = false;
  wait();
  assert.deepEqual(written, [1, 0]);
});

test("a panel says why nothing can be pressed", () => {
  assert.equal(why_not("operator", "mine", false), "");
  assert.match(why_not("operator", "free", false), /first press takes it/);
  assert.match(why_not("operator", "taken", false), /Another viewer/);
  assert.match(why_not("operator", "mine", true), /past/);
  // After the end there is no now to go back to.
  assert.match(why_not("operator", "mine", true, true), /^The run is over/);
});
