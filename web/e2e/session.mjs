// The page before the program itself: a machine is operated, and what was done is repeated to the digest.
// `node e2e/session.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { WebSocket } from "ws";

const [program, scenarios, folder = null] = process.argv.slice(2);
const children = [];
const room = await mkdtemp(join(tmpdir(), "page-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

/** Starts a session with a page; `url` is where, `over` comes with its exit code and what it wrote. */
function start(words) {
  return started(["run", ...words, "--web"]);
}

/** Starts what has a page. */
async function started(words) {
  const child = spawn(program, words, { stdio: ["ignore", "pipe", "pipe"] });
  children.push(child);
  let [out, said] = ["", ""];
  child.stdout.on("data", (data) => (out += data));
  const url = await new Promise((found, lost) => {
    child.stderr.on("data", (data) => {
      said += data;
      const line = /the (?:session|recording) is at (http:\S+)/.exec(said);
      if (line !== null) found(line[1]);
    });
    child.on("exit", () => lost(new Error(`no page: ${said}`)));
  });
  const over = new Promise((ended) => child.on("exit", (code) => ended({ code, out, said })));
  return { url, over };
}

async function open(url, first = 5) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.waitForFunction((step) => window.onescan?.picture().step > step, first);
  return { page, errors };
}

/** Ends a session, as an operator does. */
async function stop(url) {
  const socket = new WebSocket(url.replace("http", "ws") + "api/live");
  await new Promise((opened) => socket.on("open", opened));
  socket.send(JSON.stringify({ type: "operate", operation: "stop" }));
  await new Promise((closed) => socket.on("close", closed));
}

async function shoot(page, name) {
  if (folder !== null) await page.screenshot({ path: `${folder}/${name}.png` });
}

/** The filling machine by its panel: started, distorted, and repeated. */
async function operate_the_filling_machine() {
  const record = join(room, "filling");
  const words = [join(scenarios, "filling-machine"), "--operator", "panel", "--until", "1h", "--record", record, "--pace", "2"];
  const session = await start(words);
  const { page, errors } = await open(session.url);
  const panel = (name) => page.getByRole("region", { name: `Panel ${name}` });
  for (const name of ["main menu", "monitor"]) {
    await panel(name).getByRole("button", { name: "Take seat" }).click();
    await panel(name).getByRole("button", { name: "Leave seat" }).waitFor();
  }
  // The trends begin with what the scenario plots.
  const trends = await page.evaluate(() => window.onescan.trends());
  for (const name of ["Packages_In", "Packages_Dropped", "SW_ANGLE"]) assert.ok(trends.includes(name), `${name} is not among ${trends}`);
  await panel("monitor").getByRole("switch", { name: /^Skip set-up/ }).click();
  const key = panel("main menu").getByRole("button", { name: "Start", exact: true });
  await key.focus();
  await page.keyboard.down("Space");
  await page.waitForFunction(() => window.onescan.value("Main_Control.SwitchOutput[0]") === 1);
  await page.keyboard.up("Space");
  await page.waitForFunction(() => window.onescan.value("Packages_In") >= 3, null, { timeout: 60_000 });
  await shoot(page, "filling-machine");
  // What the page shows is what the image has, in the same step.
  await page.getByRole("button", { name: "Hold" }).click();
  await page.waitForFunction(() => window.onescan.picture().isHeld);
  const shown = await page.evaluate(() => [window.onescan.picture().t_ns, window.onescan.value("SW_ANGLE"), window.onescan.value("Packages_In")]);
  await page.getByRole("button", { name: "Go", exact: true }).click();
  await panel("monitor").getByRole("switch", { name: /^Distortion/ }).click();
  await page.waitForFunction(() => window.onescan.value("Packages_Dropped") >= 1, null, { timeout: 60_000 });
  await shoot(page, "filling-machine-distorted");
  await stop(session.url);
  const { out, said } = await session.over;
  assert.deepEqual(errors, []);
  const digest = /digest (\S+)/.exec(out)?.[1] ?? assert.fail(`${out}${said}`);

  const again = spawnSync(program, ["run", join(scenarios, "filling-machine"), "--operator", "panel", "--until", "1h", "--replay-operator", record]);
  assert.match(String(again.stdout), new RegExp(digest), String(again.stderr));

  const table = join(room, "filling.csv");
  spawnSync(program, ["export", record, "-o", table, "--signals", "SW_ANGLE", "--signals", "Packages_In"]);
  const rows = (await readFile(table, "utf8")).split("\n").map((line) => line.split(","));
  const row = rows.find(([t_ns]) => t_ns === String(shown[0]));
  const column = (name) => Number(row[rows[0].indexOf(name)]);
  assert.deepEqual([column("SW_ANGLE"), column("Packages_In")], [shown[1], shown[2]]);
}

/** Puts the timeline on a step, as dragging does, and waits until the page shows it. */
async function drag_to(page, step) {
  await page.getByRole("slider", { name: "Time that is shown" }).fill(String(step));
  await page.waitForFunction((step) => window.onescan.picture().isPast && window.onescan.picture().step === step, step);
}

const SHEAR_STEP_NS = 10_000_000;

/** What a signal of the shear is at a step of a recording, by the table that the program exports. */
async function row(record, name, step) {
  const table = join(room, "table.csv");
  spawnSync(program, ["export", record, "-o", table, "--signals", name]);
  const [head, ...rows] = (await readFile(table, "utf8")).trim().split("\n").map((line) => line.split(","));
  const found = rows.find(([t_ns]) => t_ns === String(step * SHEAR_STEP_NS)) ?? assert.fail(`no step ${step}`);
  return Number(found[head.indexOf(name)]);
}

const value = (page, name) => page.evaluate((signal) => window.onescan.value(signal), name);

/** The shear: its timeline dragged back to the second stroke, while it goes on; a session from there; its recording. */
async function look_back_at_the_shear() {
  const shear = join(scenarios, "shear");
  const record = join(room, "shear");
  const plain = spawnSync(program, ["run", shear, "--until", "6s", "--record", record]);
  const digest = /digest (\S+)/.exec(String(plain.stdout))?.[1] ?? assert.fail(String(plain.stderr));
  const session = await start([shear, "--until", "1h", "--pace", "5"]);
  const { page, errors } = await open(session.url, 500);
  await page.getByRole("tab", { name: "Signals" }).click();
  // The second stroke is the last step at which two strokes have begun.
  await drag_to(page, 300);
  let second = 300;
  while ((await value(page, "Strokes")) > 2) await drag_to(page, (second -= 10));
  while ((await value(page, "Strokes")) < 2) await drag_to(page, (second += 10));
  assert.equal(await value(page, "Strokes"), 2);
  assert.equal(await value(page, "Position_1"), await row(record, "Position_1", second));
  await shoot(page, "shear-past");
  // The live one has gone on meanwhile; another one goes on from here.
  await page.getByRole("button", { name: "Go on from here" }).click();
  const link = page.getByRole("link", { name: /^Session from/ });
  await link.waitFor({ timeout: 60_000 });
  const fork = await open(await link.getAttribute("href"), second);
  assert.deepEqual(fork.errors, []);
  await fork.page.close();
  await page.getByRole("button", { name: "Live" }).click();
  await page.waitForFunction((step) => !window.onescan.picture().isPast && window.onescan.picture().step > step, 500);
  // Forced and released from the table, marked as long as it is forced.
  const force = page.getByRole("button", { name: "Force Sensor_1", exact: true });
  const cell = page.getByRole("row").filter({ has: force }).locator("td.value");
  await force.click();
  await page.getByRole("dialog").getByRole("button", { name: "TRUE", exact: true }).click();
  await cell.filter({ hasText: "TRUE (forced)" }).waitFor();
  await page.waitForFunction(() => window.onescan.value("Sensor_1") === 1);
  await force.click();
  await page.getByRole("dialog").getByRole("button", { name: "Release", exact: true }).click();
  await cell.filter({ hasNotText: "forced" }).waitFor();
  assert.deepEqual(errors, []);
  await stop(session.url);
  await session.over;

  const recorded = await started(["view", join(record, "run-1")]);
  const view = await open(recorded.url, -1);
  await view.page.getByRole("tab", { name: "Signals" }).click();
  await drag_to(view.page, second);
  assert.equal(await value(view.page, "Position_1"), await row(record, "Position_1", second));
  await view.page.getByRole("button", { name: "Play" }).click();
  await view.page.waitForFunction((step) => window.onescan.picture().step > step + 50, second);
  assert.deepEqual(view.errors, []);
  await shoot(view.page, "shear-recording");
  await stop(recorded.url);
  const checked = await recorded.over;
  assert.equal(checked.code, 0, checked.said);
  assert.ok(checked.out.includes(digest), checked.out);
}

try {
  await operate_the_filling_machine();
  console.log("the page operates a session: ok");
  await look_back_at_the_shear();
  console.log("the page shows the past: ok");
} finally {
  for (const child of children) child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
