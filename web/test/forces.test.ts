import assert from "node:assert/strict";
import { test } from "node:test";
import { entry_of, wrong_value } from "../src/forces";

test("a value is entered as its type asks for", () => {
  assert.equal(entry_of("BOOL", new Map()), "two");
  assert.equal(entry_of("INT", new Map([[1, "Filling"]])), "list");
  assert.equal(entry_of("LREAL", new Map()), "number");
  assert.equal(entry_of("TIME", new Map()), "text");
});

test("what is no value of the type is refused in words", () => {
  assert.equal(wrong_value("LREAL", "-1.5e3"), null);
  assert.equal(wrong_value("LREAL", "1,5"), "Enter a number.");
  assert.equal(wrong_value("INT", "1.5"), "Enter a whole number: the type is INT.");
  assert.equal(wrong_value("INT", "40000"), "INT goes from -32768 to 32767.");
  assert.equal(wrong_value("USINT", "255"), null);
  assert.equal(wrong_value("TIME", "T#1s"), null);
  assert.equal(wrong_value("STRING", " "), "Enter a value.");
});
