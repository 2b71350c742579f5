import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { chosen } from "../src/theme";

const css = readFileSync("src/page.css", "utf8");

/** The colours of a theme; what the dark one does not set is that of the light one. */
function colours(selector: string): Map<string, string> {
  const block = new RegExp(`${selector.replace(/[[\]"=:]/g, "\\$&")} \\{([^}]*)\\}`).exec(css)?.[1] ?? assert.fail(selector);
  return new Map([...block.matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map(([, name = "", colour = ""]) => [name, colour]));
}

/** Relative luminance (WCAG 2.2). */
function luminance(colour: string): number {
  const [r = 0, g = 0, b = 0] = [1, 3, 5].map((at) => {
    const part = Number.parseInt(colour.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(one: string, other: string): number {
  const [a, b] = [luminance(one), luminance(other)];
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}

const light = colours(":root");
const themes = { light, dark: new Map([...light, ...colours(':root[data-theme="dark"]')]) };
/** What stands on what: text (WCAG 2.2, 1.4.3 AA: 4.5), and marks that carry meaning (1.4.11: 3). */
const TEXT = ["text", "text-2", "accent", "warn", "bad", "good", "past", "true", "code-key", "code-say", "code-text"];
const GROUNDS = ["ground", "sheet", "raised"];

test("the contrast of black on white is known", () => {
  assert.equal(contrast("#000000", "#ffffff"), 21);
  assert.ok(Math.abs(contrast("#777777", "#ffffff") - 4.48) < 0.01);
});

for (const [name, theme] of Object.entries(themes)) {
  const of = (colour: string): string => theme.get(colour) ?? assert.fail(`${name} has no --${colour}`);
  test(`text is legible in the ${name} theme`, () => {
    for (const text of TEXT) {
      for (const ground of GROUNDS) {
        const found = contrast(of(text), of(ground));
        assert.ok(found >= 4.5, `--${text} on --${ground}: ${found.toFixed(2)}`);
      }
    }
    assert.ok(contrast(of("on-accent"), of("accent")) >= 4.5, "text on what is chosen");
    assert.ok(contrast(of("on-past"), of("past")) >= 4.5, "the banner of the past");
    assert.ok(contrast(of("sheet"), of("good")) >= 4.5, "the name of a step that is active");
  });
  test(`lamps are distinguished in the ${name} theme`, () => {
    assert.ok(contrast(of("bulb"), of("bulb-off")) >= 3, "on and off");
    assert.ok(contrast(of("text-2"), of("raised")) >= 3, "the rim of a lamp");
  });
}

test("a theme that is the system's follows the system again", () => {
  assert.deepEqual(chosen("light", "light"), { theme: "dark", kept: "dark" });
  assert.deepEqual(chosen("dark", "light"), { theme: "light", kept: null });
});
