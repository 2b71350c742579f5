import assert from "node:assert/strict";
import { test } from "node:test";
import { AlarmBook, most_urgent } from "../src/alarms";
import type { AlarmChange } from "../src/session";

const ALARMS = [{ name: "door", priority: "low" }, { name: "water", priority: "critical" }, { name: "oil", priority: "high" }] as const;

const change = (t_ns: number, alarm: number, fate: AlarmChange["fate"], until_ns: number | null = null): AlarmChange => ({ t_ns, alarm, fate, until_ns });

function book(...changes: AlarmChange[]): AlarmBook {
  const all = new AlarmBook(ALARMS);
  all.take(true, changes);
  return all;
}

const names = (all: AlarmBook, t_ns: number, isLive = false): string[] =>
  all.at(t_ns, isLive).map((one) => `${one.about.name} ${one.gone_ns === null ? "on" : "gone"} ${one.aside_ns !== null ? "aside" : one.isSeen ? "seen" : "new"}`);

test("an alarm stays until it is gone and acknowledged, in either order", () => {
  const all = book(change(1, 0, "on"), change(2, 0, "acknowledged"), change(3, 0, "off"), change(5, 0, "on"), change(6, 0, "off"), change(8, 0, "acknowledged"));
  assert.deepEqual([0, 1, 2, 3, 5, 6, 8].map((t_ns) => names(all, t_ns)), [[], ["door on new"], ["door on seen"], [], ["door on new"], ["door gone new"], []]);
});

test("the most urgent one that is not acknowledged is the first", () => {
  const all = book(change(1, 0, "on"), change(2, 1, "on"), change(3, 2, "on"), change(4, 1, "acknowledged"), change(5, 0, "off"));
  assert.deepEqual(names(all, 3), ["water on new", "oil on new", "door on new"]);
  assert.deepEqual(names(all, 9), ["oil on new", "door gone new", "water on seen"]);
  assert.equal(most_urgent(all.at(9, false))?.about.name, "oil");
  assert.equal(most_urgent(book().at(9, true)), null);
});

test("an alarm that is put aside comes back when its time is over, or it is taken back", () => {
  const all = book(change(1, 1, "on"), change(2, 1, "shelved", 10), change(20, 1, "shelved", 30), change(22, 1, "unshelved"));
  assert.deepEqual([1, 2, 9, 10, 21, 22].map((t_ns) => names(all, t_ns)[0]), ["water on new", "water on aside", "water on aside", "water on new", "water on aside", "water on new"]);
  assert.equal(most_urgent(all.at(5, false)), null);
});

test("the past has the alarms of its moment, the live edge all that is known", () => {
  const all = book(change(100, 2, "on"));
  assert.deepEqual([names(all, 99), names(all, 99, true)], [[], ["oil on new"]]);
});

test("what a session reports again after a loss is not new", () => {
  const all = new AlarmBook(ALARMS);
  assert.equal(all.take(true, [change(1, 0, "on")]).length, 1);
  assert.equal(all.take(false, [change(2, 1, "on")]).length, 1);
  assert.deepEqual(all.take(true, [change(1, 0, "on"), change(2, 1, "on"), change(3, 2, "on")]), [change(3, 2, "on")]);
});
