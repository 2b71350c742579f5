import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../src/history";

test("a spike of one sample survives decimation", () => {
  const history = new History();
  for (let index = 0; index < 10_000; index += 1) history.push(index / 100, index === 4321 ? 9 : 0);
  const { t_s, value } = history.decimated(0, 100, 50);
  assert.ok(t_s.length <= 4 * 50 + 2, `${t_s.length} points`);
  assert.equal(Math.max(...value), 9);
  assert.equal(t_s[value.indexOf(9)], 43.21);
  for (let index = 1; index < t_s.length; index += 1) assert.ok((t_s[index] as number) >= (t_s[index - 1] as number));
});

test("a past that comes later stands before what is known", () => {
  const history = new History();
  history.push(5, 50);
  history.push(6, 60);
  for (const [t_s, value] of [[1, 10], [2, 20], [5, 51], [5.5, 55]] as const) history.insert(t_s, value);
  assert.deepEqual([0.5, 1, 2.5, 5, 5.7, 6].map((t_s) => history.at(t_s)), [null, 10, 20, 51, 55, 60]);
  assert.equal(history.length, 5);
});

test("a value holds until the next and before the part that is shown", () => {
  const history = new History();
  history.push(1, 5);
  history.push(3, 7);
  assert.equal(history.at(0.5), null);
  assert.equal(history.at(1), 5);
  assert.equal(history.at(2.9), 5);
  assert.equal(history.at(100), 7);
  assert.deepEqual(history.decimated(2, 4, 10), { t_s: [2, 3], value: [5, 7] });
});

test("time that goes back drops what was after it", () => {
  const history = new History();
  for (const t of [1, 2, 3, 4]) history.push(t, t);
  history.push(2, 20);
  assert.equal(history.length, 2);
  assert.equal(history.at(9), 20);
});

test("memory is bounded", () => {
  const history = new History(100);
  for (let index = 0; index < 10_000; index += 1) history.push(index, index);
  assert.ok(history.length <= 100);
  assert.equal(history.at(9999), 9999);
});
