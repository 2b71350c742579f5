// The maps of the kiln on its page, before the program itself: the shell as it is, and the revolution as the PLC has it, each value
// and some colours, at the live edge and in the past. `node e2e/maps.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open, until } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const kiln = join(scenarios, "rotary-kiln", "serial.toml");
const room = await mkdtemp(join(tmpdir(), "maps-"));

/** The maps of a run that ends at a time, row by row without the places of rows and columns. */
async function written(t_ns) {
  const done = spawnSync(program, ["run", kiln, "--until", `${t_ns}ns`, "--maps", room], { encoding: "utf8" });
  // expectations that need more time than that are open, or not met
  assert.ok(done.status === 0 || done.status === 1, done.stderr);
  const rows = async (name) => (await readFile(join(room, `${name}.csv`), "utf8")).trim().split("\n").slice(1).map((line) => line.split(",").slice(1).map(Number));
  return { plc: await rows("plc"), machine: await rows("machine") };
}

/** Every value of the page is that of the file. */
async function compare(page, name, rows) {
  const shown = await page.evaluate((one) => window.onescan.map(one), name);
  assert.deepEqual([shown.rows, shown.columns], [rows.length, rows[0].length], name);
  const all = rows.flat();
  const far = shown.values.findIndex((value, index) => Math.abs(value - all[index]) > 1e-4 + 1e-7 * Math.abs(all[index]));
  assert.equal(far, -1, `${name}: cell ${far} is ${shown.values[far]} on the page and ${all[far]} in the file`);
  assert.equal(shown.greatest.value, Math.max(...shown.values));
  return shown;
}

const moment = (page) => page.evaluate(() => window.onescan.picture());
const browser = await browse();
const session = await begin(program, ["run", kiln, "--web", "--pace", "40"], ["the session"]);
try {
  const { page, errors } = await open(browser, session.urls[0]);
  await page.getByRole("tab", { name: "Maps" }).click();
  const shell = page.getByRole("img", { name: /^The shell as it is: From/ });
  await shell.waitFor();
  await page.getByRole("tab", { name: "Signals" }).click();
  await until(page, ["Rows", "=", 100]);
  await page.getByRole("button", { name: "Hold" }).click();
  await page.waitForFunction(() => window.onescan.picture().isHeld);
  await page.getByRole("tab", { name: "Maps" }).click();
  const live = await moment(page);
  const now = await written(live.t_ns);
  // The page is shown a map ten times a second.
  await page.waitForFunction(([name, greatest]) => Math.abs((window.onescan.map(name)?.greatest?.value ?? 0) - greatest) < 1e-3, ["plc", Math.max(...now.plc.flat())]);
  const plc = await compare(page, "plc", now.plc);
  const machine = await compare(page, "machine", now.machine);
  // The hot spot: 60 K at 22 m and 130°, in the text, under the pointer and in the colours.
  await page.getByText(/which is at position 2[12]\.\d+ m, angle 1[23]\d\.?\d*°\.$/).waitFor();
  const at = { x: (machine.greatest.column + 0.5) / machine.columns, y: (machine.greatest.row + 0.5) / machine.rows };
  const hot = await page.evaluate(([x, y]) => window.onescan.map_pixel("machine", Math.floor(x * 640), Math.floor(y * 320)), [at.x, at.y]);
  assert.ok(hot[0] > 220 && hot[1] > 200 && hot[2] < 100 && hot[3] === 255, `the hottest cell is ${hot}`);
  const frame = await shell.boundingBox();
  await shell.hover({ position: { x: at.x * frame.width, y: at.y * frame.height } });
  const status = page.locator("figure", { has: shell }).getByRole("status");
  const degrees = String(Number(machine.greatest.value.toPrecision(4)));
  // A cell is hardly wider than a pixel here, so the pointer may be on the one beside it.
  await status.filter({ hasText: /^position 2[12]\..* m, angle 1[23]\d.*°: 3\d\d\.?\d* °C$/ }).waitFor();
  // By keyboard: the first arrow goes to the hottest cell, the next one to its neighbour.
  await page.mouse.move(2, 2);
  await shell.focus();
  await page.keyboard.press("ArrowLeft");
  await status.filter({ hasText: `: ${degrees} °C` }).waitFor();
  await page.keyboard.press("ArrowLeft");
  const beside = Number(machine.values[machine.greatest.row * machine.columns + machine.greatest.column - 1].toPrecision(4));
  await status.filter({ hasText: `: ${beside} °C` }).waitFor();
  if (folder !== null) await page.screenshot({ path: join(folder, "maps.png") });
  // The past: the same step, of another run.
  const slider = page.getByLabel("Time that is shown");
  await slider.fill("20000");
  await page.waitForFunction(() => window.onescan.picture().isPast && window.onescan.picture().step >= 20_000);
  const past = await moment(page);
  const then = await written(past.t_ns);
  await page.waitForFunction((greatest) => Math.abs(window.onescan.map("machine").greatest.value - greatest) < 1e-3, Math.max(...then.machine.flat()));
  await compare(page, "machine", then.machine);
  await compare(page, "plc", then.plc);
  assert.notDeepEqual(then.plc, now.plc);
  await page.getByRole("button", { name: "Live" }).click();
  await page.waitForFunction(([greatest, filled]) => {
    const map = window.onescan.map("plc");
    return map.greatest.value === greatest && map.values.filter((value) => value > 0).length === filled;
  }, [plc.greatest.value, plc.values.filter((value) => value > 0).length]);
  assert.deepEqual(errors, []);
  session.child.kill("SIGINT");
  await session.over;
  console.log(`the maps of the kiln are on its page: ok; ${plc.rows} lines, ${machine.rows * machine.columns} cells of the shell`);
} finally {
  session.child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
