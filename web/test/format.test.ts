import assert from "node:assert/strict";
import { test } from "node:test";
import { breakable, form_for, in_form, shown } from "../src/format";
import type { Signal } from "../src/session";

const signal = (unit: string | null, type = "LREAL", names: readonly (readonly [number, string])[] = []): Signal =>
  ({ name: "s", type, writer: "w", about: "", unit, names: new Map(names) });

test("large values get a prefix of their unit, and no more digits than one reads", () => {
  assert.equal(shown(signal("W"), 87_565_900), "87.6 MW");
  assert.equal(shown(signal("A"), 58_685.7), "58.7 kA");
  assert.equal(shown(signal("°C"), 36.9252), "36.9 °C");
  assert.equal(shown(signal("kWh"), 7196.29), "7.20 MWh");
  assert.equal(shown(signal("kWh"), 96.29), "96.3 kWh");
  assert.equal(shown(signal("kg"), 46_501.1), "46501 kg");
  assert.equal(shown(signal("rad"), 28.6556), "28.66 rad");
  assert.equal(shown(signal("V"), 0.0042), "4.20 mV");
  assert.equal(shown(signal("m"), 0.00042), "0.000420 m");
  assert.equal(shown(signal("m"), -1.05), "−1.050 m");
  assert.equal(shown(signal("W"), 0), "0 W");
  assert.equal(shown(signal(null), Number.NaN), "not a number");
  assert.equal(shown(signal("m"), undefined), "–");
});

test("whole numbers have no places, and values have their names", () => {
  assert.equal(shown(signal(null, "DINT"), 1234567), "1234567");
  assert.equal(shown(signal("ms", "UINT"), 12), "12 ms");
  assert.equal(shown(signal(null, "INT", [[2, "Filling"]]), 2), "Filling");
  assert.equal(shown(signal(null, "BOOL"), 1), "TRUE");
  assert.equal(shown(signal(null, "BOOL", [[1, "open"]]), 1), "open");
});

test("the width of a value does not jump while it moves", () => {
  const power = signal("W");
  shown(power, 87_000_000);
  const texts = [86_000_123, 12_345_678, 9_999_999, 800_000, 0].map((value) => shown(power, value));
  assert.deepEqual(texts, ["86.0 MW", "12.3 MW", "10.0 MW", "0.8 MW", "0.0 MW"]);
  // What would read as nothing gets a form of its own.
  assert.equal(shown(power, 12_000), "12.0 kW");
  const length = signal("m");
  const lengths = [1.5, 1.25, 0.123456, 1e-3].map((value) => shown(length, value));
  assert.deepEqual(lengths, ["1.500 m", "1.250 m", "0.123 m", "0.001 m"]);
});

test("a form is that of the greatest value", () => {
  assert.deepEqual(form_for("W", false, 2e9), { by: 1e9, decimals: 2, unit: "GW" });
  assert.equal(in_form(-1e-9, form_for("m", false, 1)), "0.000 m");
});

test("names are broken at underscores and points only", () => {
  assert.deepEqual(breakable("IN_LW_CONTAINER_READY"), ["IN_", "LW_", "CONTAINER_", "READY"]);
  assert.deepEqual(breakable("Main_Control.SwitchOutput[0]"), ["Main_", "Control.", "SwitchOutput[0]"]);
});
