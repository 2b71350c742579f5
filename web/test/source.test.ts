import assert from "node:assert/strict";
import { test } from "node:test";
import { main_source, programs, words } from "../src/highlight";
import { bounded, kept } from "../src/split";

const TEXT = `(* PROGRAM Old *)
PROGRAM Main // the machine
VAR n : INT := 16#FF; t : TIME := T#1.5s; s : STRING := 'IF $' x'; END_VAR
  if n > 3 THEN done := TRUE; END_IF;
`;

test("words of a source have their kinds", () => {
  const found = words(TEXT).map(({ from, to, kind }) => `${kind} ${TEXT.slice(from, to)}`);
  assert.deepEqual(found, [
    "say (* PROGRAM Old *)", "key PROGRAM", "say // the machine", "key VAR", "key INT", "number 16#FF", "key TIME", "number T#1.5s", "key STRING",
    "text 'IF $' x'", "key END_VAR", "key if", "number 3", "key THEN", "number TRUE", "key END_IF",
  ]);
});

test("the sheet begins with the program that has the most variables", () => {
  assert.deepEqual(programs(TEXT), ["Main"]);
  const sources = [{ text: "FUNCTION F : INT END_FUNCTION" }, { text: "PROGRAM Panel END_PROGRAM" }, { text: TEXT }];
  assert.equal(main_source(sources, ["Panel.Start", "Main.n", "Main.t"]), 2);
  assert.equal(main_source(sources, ["Panel.Start"]), 1);
  assert.equal(main_source([sources[0] as { text: string }], []), 0);
});

test("the panes are as they were left, within bounds", () => {
  assert.deepEqual(kept(null), { side: 38, low: 36 });
  assert.deepEqual(kept('{"side": 50, "low": 99}'), { side: 50, low: 80 });
  assert.deepEqual(kept('{"side": "x"}'), { side: 38, low: 36 });
  assert.deepEqual(kept("{"), { side: 38, low: 36 });
  assert.equal(bounded(3), 15);
});
