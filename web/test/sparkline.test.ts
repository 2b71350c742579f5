import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../src/history";
import { points } from "../src/sparkline";

test("a line ends at the right, and stays within its range", () => {
  const history = new History();
  for (let t_s = 0; t_s <= 120; t_s += 1) history.push(t_s, t_s);
  const line = points(history, 120, 0, 100);
  assert.equal(line[0]?.[0], 0);
  assert.equal(line[line.length - 1]?.[0], 240);
  assert.equal(line[line.length - 1]?.[1], 3, "a value above the range is at its upper end");
  assert.deepEqual(points(new History(), 1, null, null), []);
});
