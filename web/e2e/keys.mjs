// What scripts do with the keyboard alone: go to an element as a person does who has no mouse, and press it.

import assert from "node:assert/strict";

/** So many stops a page may have between one element and another. */
const STOPS_MOST = 400;

/** Whether an element, or what is in it, has the focus. */
const has_focus = (locator) => locator.evaluate((element) => element === document.activeElement);

/** Which way an element lies from the focus, the shorter one through the whole page: `Tab`, `Shift+Tab`, or null if it has the focus. */
const way_to = (locator) => locator.evaluate((element) => {
  const stops = [...document.querySelectorAll("button, a[href], select, input, summary, textarea, [tabindex]")];
  const [at, wanted] = [stops.indexOf(document.activeElement), stops.indexOf(element)];
  if (element === document.activeElement) return null;
  const forward = (wanted - at + stops.length) % stops.length;
  return at >= 0 && forward > stops.length / 2 ? "Shift+Tab" : "Tab";
});

/** Goes to an element by Tab alone, and checks that one sees where one is. */
export async function go_to(page, locator) {
  await locator.waitFor();
  const key = await way_to(locator);
  for (let stop = 0; stop < STOPS_MOST; stop += 1) {
    const seen = await locator.evaluate((element) => {
      if (element !== document.activeElement) return null;
      const { outlineStyle, outlineWidth, boxShadow } = getComputedStyle(element);
      return (outlineStyle !== "none" && outlineWidth !== "0px") || boxShadow !== "none";
    });
    if (seen !== null) {
      assert.ok(seen, `nothing shows that ${locator} has the focus`);
      return;
    }
    await page.keyboard.press(key);
  }
  assert.fail(`${locator} is not reached by Tab`);
}

/** Goes to a key and presses it. */
export async function press_key(page, locator, key = "Enter") {
  await go_to(page, locator);
  await page.keyboard.press(key);
}

/** Goes to the sheet of this name: the tabs are one stop, with arrow keys between them. */
export async function open_sheet(page, name) {
  await go_to(page, page.locator("[role=tab][aria-selected=true]"));
  const wanted = page.getByRole("tab", { name, exact: true });
  for (let turn = 0; turn < 12 && !(await has_focus(wanted)); turn += 1) await page.keyboard.press("ArrowRight");
  assert.ok(await has_focus(wanted), `sheet ${name}`);
}

/** The keys and fields of a page that are smaller than WCAG 2.2 AA wants them, 24 by 24 CSS pixels. */
export function small_targets(page) {
  return page.evaluate(() => [...document.querySelectorAll("button, a[href], select, input, summary, [role=tab], [role=switch], [role=slider], [tabindex='0']")]
    .filter((one) => one.checkVisibility({ checkVisibilityCSS: true, checkOpacity: true }))
    .map((one) => ({ one, box: one.getBoundingClientRect() }))
    .filter(({ one, box }) => box.width > 0 && (box.width < 23.5 || box.height < 23.5) && getComputedStyle(one).display !== "inline")
    // A line between two panes is taken hold of beside it, too: by its `::after`, of 24 pixels.
    .filter(({ one }) => one.getAttribute("role") !== "separator")
    .map(({ one, box }) => `${one.tagName} ${one.getAttribute("aria-label") ?? one.textContent.slice(0, 30)}: ${box.width.toFixed(0)} x ${box.height.toFixed(0)}`));
}

/** What axe finds that is serious or moderate. */
export async function found_by_axe(page, source) {
  await page.evaluate(source);
  const { violations } = await page.evaluate(() => window.axe.run(document));
  return violations.filter((one) => ["critical", "serious", "moderate"].includes(one.impact)).map((one) => `${one.id} (${one.impact}): ${one.nodes.map((node) => node.target).join(", ")}`);
}
