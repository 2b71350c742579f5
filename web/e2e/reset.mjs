// A key of a panel that resets the session, before the program itself: the filling machine begins again with its program, trends
// and past with it, and what was done is repeated to the digest. No cell of the monitor is broken at any size or theme.
// `node e2e/reset.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open, panel, sit, until } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const machine = join(scenarios, "filling-machine");
const room = await mkdtemp(join(tmpdir(), "reset-"));
const record = join(room, "record");
const browser = await browse();
const run = (...more) => ["run", machine, "--operator", "panel", "--until", "1h", "--format", "json", ...more];
const { child, said, over, urls } = await begin(program, run("--web", "--pace", "2", "--record", record), ["the session"]);

const RESET = "Main_Control.SwitchOutput[2]";
const t_ns = (page) => page.evaluate(() => window.onescan.picture().t_ns);

/** Presses a button of a panel until a signal shows it. */
async function press(page, name, label, signal) {
  const key = panel(page, name).getByRole("button", { name: label, exact: true });
  await key.focus();
  await page.keyboard.down("Space");
  await until(page, [signal, "=", 1]);
  await page.keyboard.up("Space");
  await until(page, [signal, "=", 0]);
}

/** The cells of the monitor in which a text has more than one line, or is wider than its cell. */
const broken_cells = (page) => page.evaluate(() => {
  const cells = [...document.querySelectorAll('[aria-label="Panel monitor"] .element')];
  const texts = (cell) => {
    const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    const all = [];
    while (walker.nextNode() !== null) if (walker.currentNode.textContent.trim() !== "") all.push(walker.currentNode);
    return all;
  };
  return cells.flatMap((cell) => texts(cell).flatMap((text) => {
    const range = document.createRange();
    range.selectNode(text);
    const lines = new Set([...range.getClientRects()].map((rect) => Math.round(rect.top))).size;
    const [inner, outer] = [range.getBoundingClientRect(), cell.getBoundingClientRect()];
    const isOut = inner.left < outer.left - 0.5 || inner.right > outer.right + 0.5;
    return lines > 1 || isOut ? [`${text.textContent}: ${lines} lines, ${inner.width.toFixed(1)} of ${outer.width.toFixed(1)} px`] : [];
  }));
});

try {
  const { page, errors } = await open(browser, urls[0]);
  await sit(page, "main menu");
  await sit(page, "monitor");
  await press(page, "main menu", "Start", "Main_Control.SwitchOutput[0]");
  await until(page, ["MachineStep", "=", 3], ["Packages_In", ">", 3]);
  // The PLC's Reset alone leaves the machine where it is.
  await press(page, "main menu", "Stop", "Main_Control.SwitchOutput[1]");
  await until(page, ["MachineStep", "=", 4]);
  await press(page, "main menu", "Reset", RESET);
  await until(page, ["MachineStep", "=", 0], ["Packages_In", ">", 3]);
  const before = await t_ns(page);
  await press(page, "monitor", "Reset all", RESET);
  assert.ok((await t_ns(page)) < before, "virtual time begins again");
  await until(page, ["MachineStep", "=", 0], ["Packages_In", "=", 0], ["SW_ANGLE", "=", 0]);
  // Nothing is known of what has not happened.
  const later = before / 1e9;
  assert.equal(await page.evaluate((t_s) => window.onescan.trend("Packages_In", t_s), later), 0, "the trend goes on from where it begins");
  await press(page, "main menu", "Start", "Main_Control.SwitchOutput[0]");
  await until(page, ["MachineStep", "=", 3], ["Packages_In", ">", 1]);
  // Who looks at the past presses nothing.
  await page.getByLabel("Time that is shown").focus();
  await page.keyboard.press("Home");
  await page.waitForFunction(() => window.onescan.picture().isPast);
  const key = panel(page, "monitor").getByRole("button", { name: "Reset all", exact: true });
  await key.and(page.locator(":disabled")).waitFor();
  await page.getByRole("button", { name: "Back to now" }).first().click();
  await key.and(page.locator(":enabled")).waitFor();
  for (const [width, height] of [[1280, 720], [1920, 1080]]) {
    for (const theme of ["light", "dark"]) {
      await page.setViewportSize({ width, height });
      await page.emulateMedia({ colorScheme: theme });
      await panel(page, "monitor").getByText("in 0").scrollIntoViewIfNeeded();
      if (folder !== null) {
        // As wide as it is, and as high as the whole panel needs.
        await page.setViewportSize({ width, height: 1500 });
        await panel(page, "monitor").screenshot({ path: `${folder}/monitor-${width}-${theme}.png` });
        await page.setViewportSize({ width, height });
      }
      assert.deepEqual(await broken_cells(page), [], `${width} x ${height}, ${theme}`);
    }
  }
  assert.deepEqual(errors, []);
  child.kill("SIGINT");
  await over;
  const live = JSON.parse(said.out);
  const again = spawnSync(program, run("--replay-operator", record));
  const repeated = JSON.parse(String(again.stdout));
  assert.deepEqual([repeated.digest, repeated.steps], [live.digest, live.steps]);
  console.log("a machine and its program begin again by one key, and are repeated: ok");
} finally {
  child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
