// What the page draws, before the program itself: looks of the arc furnace, the ladder of the shear, a chart.
// `node e2e/drawn.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [program, scenarios, folder = null] = process.argv.slice(2);
const children = [];
const room = await mkdtemp(join(tmpdir(), "drawn-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

/** Starts a session with a page, and says where it is. */
async function start(words) {
  const child = spawn(program, ["run", ...words, "--web"], { stdio: ["ignore", "ignore", "pipe"] });
  children.push(child);
  let said = "";
  return new Promise((found, lost) => {
    child.stderr.on("data", (data) => {
      said += data;
      const line = /the session is at (http:\S+)/.exec(said);
      if (line !== null) found(line[1]);
    });
    child.on("exit", () => lost(new Error(`no page: ${said}`)));
  });
}

async function open(url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  // A machine that others use, too, may take long for a furnace at pace 60.
  page.setDefaultTimeout(120_000);
  const begin = performance.now();
  await page.goto(url);
  await page.waitForFunction(() => window.onescan?.drawn() > 0 && window.onescan.picture().step !== null);
  return { page, errors, first_ms: performance.now() - begin };
}

/** A picture of the page, or of a part of it. */
async function shoot(part, name) {
  if (folder !== null) await part.screenshot({ path: `${folder}/${name}.png` });
}

/** Figures are where the signals have them, and looks are on while their condition holds. */
async function watch_the_furnace() {
  const url = await start([join(scenarios, "arc-furnace"), "--pace", "60"]);
  const { page, errors } = await open(url);
  await page.getByRole("button", { name: "front", exact: true }).click();
  await page.waitForFunction(() => window.onescan.style("wall[0]")?.transparent === 0.7, null, { timeout: 120_000 });
  await page.getByRole("button", { name: "Hold" }).click();
  await page.waitForFunction(() => window.onescan.picture().isHeld);
  await page.getByRole("tab", { name: "Signals" }).click();
  await page.waitForFunction(() => window.onescan.value("Tilt_angle") !== null && window.onescan.value("Scrap") !== null);
  const read = await page.evaluate(() => ({
    mast: window.onescan.value("Mast[1]"), scrap: window.onescan.value("Scrap"), roof: window.onescan.value("Roof_height"),
    drawn: window.onescan.drawn_m("mast[1]"), grown: window.onescan.style("scrap").grown, current: window.onescan.value("Current[1]"),
    arc: window.onescan.style("arc[1]"),
  }));
  // cradle 5.6, roof 4.4 over it, mast 2.2 below that
  assert.ok(Math.abs(read.drawn[2] - (5.6 + 4.4 - 2.2 + read.roof + read.mast)) < 1e-6, JSON.stringify(read));
  assert.ok(Math.abs(read.grown[2] - Math.min(1, Math.max(1e-4, read.scrap / 123_200))) < 1e-6, JSON.stringify(read));
  assert.equal(read.arc.isHidden, read.current < 1000);
  await shoot(page, "furnace-page");
  // A view that is called is shown to all viewers.
  const other = await open(url);
  await page.getByRole("button", { name: "For all" }).click();
  await page.getByRole("tab", { name: "PLC" }).click();
  await page.getByLabel("Source file").selectOption({ label: "Heat" });
  const active = page.locator(".drawing .step.active").first();
  await active.waitFor({ state: "attached" });
  await active.scrollIntoViewIfNeeded();
  await shoot(page.locator("aside"), "chart");
  assert.deepEqual([...errors, ...other.errors], []);
  await other.page.close();
  await page.close();
}

/** Every element and every wire of the ladder is drawn where the file has it, and lit as its variables are. */
async function read_the_ladder() {
  const url = await start([join(scenarios, "shear", "ladder.toml"), "--pace", "0.2"]);
  const { page, errors } = await open(url);
  await page.getByRole("tab", { name: "PLC" }).click();
  await page.getByLabel("Source file").selectOption({ label: "LowLevel" });
  await page.locator(".drawing .wire.lit").first().waitFor({ state: "attached" });
  const file = await readFile(join(scenarios, "shear", "plc-ld", "shear.xml"), "utf8");
  const body = /<LD>[\s\S]*?<\/LD>/.exec(file)[0];
  const expected = [...body.matchAll(/<(\w+) localId="(\w+)"[^>]*>\s*<position x="(\d+)" y="(\d+)"/g)].map(([, kind, id]) => `${kind} ${id}`);
  const drawn = await page.evaluate(() => [...document.querySelectorAll(".drawing .element")].map((one) => `${one.classList[1]} ${one.dataset.id}`));
  assert.deepEqual(drawn, expected);
  const wires = [...body.matchAll(/<connection refLocalId="(\w+)"/g)].map(([, id]) => id);
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll(".drawing .wire")].map((one) => one.dataset.from)), wires);
  await shoot(page, "ladder");
  assert.deepEqual(errors, []);
  await page.close();
}

/** The first picture of the filling machine, and how long it takes. */
async function open_the_filling_machine() {
  const url = await start([join(scenarios, "filling-machine"), "--pace", "1"]);
  const { page, errors, first_ms } = await open(url);
  console.log(`filling machine: first picture ${Math.round(first_ms)} ms after it was opened`);
  await page.waitForFunction(() => window.onescan.style("belt")?.colour === "5c656c");
  assert.deepEqual(errors, []);
  await page.close();
}

/** `onescan shot` draws the same view without a window. */
async function shoot_without_a_window() {
  const file = join(room, "furnace.png");
  const done = spawnSync(program, ["shot", join(scenarios, "arc-furnace"), "--at", "12min", "--view", "front", "-o", file, "--size", "640x360"]);
  assert.equal(done.status, 0, String(done.stderr));
  const bytes = await readFile(file);
  assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [640, 360]);
  const none = spawnSync(program, ["shot", join(scenarios, "shear"), "-o", file], { env: { ...process.env, CHROMIUM: "/nowhere/chromium" } });
  assert.equal(none.status, 2);
  assert.match(String(none.stderr), /there is no browser/);
}

try {
  await open_the_filling_machine();
  await watch_the_furnace();
  await read_the_ladder();
  await shoot_without_a_window();
  console.log("the page draws: ok");
} finally {
  for (const child of children) child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
