// The editor before the program itself: a connection is drawn, and a machine is built in the page alone and run.
// `node e2e/edit.mjs PROGRAM [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import axe from "axe-core";
import { found_by_axe, small_targets } from "./keys.mjs";
import { chromium } from "playwright-core";

const [named, folder = null] = process.argv.slice(2);
// the program is started in another folder
const program = resolve(named);
const children = [];
const room = await mkdtemp(join(tmpdir(), "edit-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

function typed(...words) {
  const said = spawnSync(program, words, { cwd: room, encoding: "utf8" });
  return { code: said.status, out: said.stdout, err: said.stderr };
}

/** Makes a scenario of a template and opens its editor. */
async function edit(name, template, prepare = async () => {}) {
  assert.equal(typed("new", name, "--template", template).code, 0);
  await prepare(join(room, name));
  const child = spawn(program, ["edit", name], { cwd: room, stdio: ["ignore", "ignore", "pipe"] });
  children.push(child);
  let said = "";
  const url = await new Promise((found, lost) => {
    child.stderr.on("data", (data) => {
      said += data;
      const line = /the editor is at (http:\S+)/.exec(said);
      if (line !== null) found(line[1]);
    });
    child.on("exit", () => lost(new Error(`no editor: ${said}`)));
  });
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "light" });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => window.onescanEdit !== undefined);
  const text = (file) => readFile(join(room, name, file), "utf8");
  /** Does something, and waits until the files are changed. */
  const change = async (act) => {
    const before = await page.evaluate(() => window.onescanEdit.revision());
    await act();
    await page.waitForFunction((revision) => window.onescanEdit.revision() > revision, before);
  };
  return { page, errors, text, change, name };
}

/** The lines that were taken away and those that came. */
function diff(before, after) {
  const [one, other] = [before.split("\n"), after.split("\n")];
  const gone = one.filter((line) => !other.includes(line)).map((line) => `-${line}`);
  const come = other.filter((line) => !one.includes(line)).map((line) => `+${line}`);
  return { lines: [...gone, ...come], grown: other.length - one.length };
}

async function shoot(page, name) {
  if (folder !== null) await page.screenshot({ path: `${folder}/${name}.png` });
}

const tip = (page, label) => page.getByRole("button", { name: new RegExp(`^${label.replaceAll(".", "\\.")}(,| :)`) });

/** Draws from one end to another. */
async function draw(page, from, to) {
  const [one, other] = [await tip(page, from).locator(".end").boundingBox(), await tip(page, to).locator(".end").boundingBox()];
  await page.mouse.move(one.x + one.width / 2, one.y + one.height / 2);
  await page.mouse.down();
  await page.mouse.move(other.x - 40, other.y, { steps: 5 });
  await page.mouse.move(other.x + other.width / 2, other.y + other.height / 2, { steps: 5 });
  await page.mouse.up();
}

async function draw_a_connection() {
  const otherwise = async (at) => {
    const source = join(at, "plc/main.st");
    await writeFile(source, (await readFile(source, "utf8")).replaceAll("Box_There", "Box_Seen"));
  };
  const { page, errors, text, change } = await edit("drawn", "cell", otherwise);
  const before = await text("scenario.toml");
  const line = '+bind = { Box_There = "Main.Box_Seen" }';
  await tip(page, "barrier.detected").scrollIntoViewIfNeeded();
  await shoot(page, "edit-wiring-before");
  await change(() => draw(page, "barrier.detected", "Main.Box_Seen"));
  assert.deepEqual(diff(before, await text("scenario.toml")), { lines: [line], grown: 1 });
  await shoot(page, "edit-wiring");
  assert.equal(typed("run", "drawn").code, 0);
  await change(() => page.keyboard.press("Control+z"));
  assert.equal(await text("scenario.toml"), before);

  // The same by keyboard: an end, Enter, the other end, Enter; Delete lets it go.
  await tip(page, "Main.Box_Seen").focus();
  await page.keyboard.press("Enter");
  await page.getByText("Main.Box_Seen: choose the other end").waitFor();
  await tip(page, "barrier.detected").focus();
  await change(() => page.keyboard.press("Enter"));
  assert.deepEqual(diff(before, await text("scenario.toml")), { lines: [line], grown: 1 });
  await tip(page, "Main.Box_Seen").focus();
  await change(() => page.keyboard.press("Delete"));
  assert.equal(await text("scenario.toml"), before);

  // What cannot be connected is reported, and nothing is written.
  await draw(page, "cylinder.position_m", "Main.Box_Seen");
  await page.getByRole("alert").filter({ hasText: "is LREAL" }).waitFor();
  assert.equal(await text("scenario.toml"), before);

  // Somebody else's change is not written over.
  const theirs = before.replace('until = "30s"', 'until = "20s"');
  await writeFile(join(room, "drawn/scenario.toml"), theirs);
  await draw(page, "barrier.detected", "Main.Box_Seen");
  await page.getByRole("alert").filter({ hasText: "else has changed" }).waitFor();
  assert.equal(await text("scenario.toml"), theirs);
  await change(() => page.getByRole("alert").getByRole("button", { name: "Read again" }).click());
  await change(() => draw(page, "barrier.detected", "Main.Box_Seen"));
  assert.deepEqual(diff(theirs, await text("scenario.toml")), { lines: [line], grown: 1 });
  assert.deepEqual(errors, []);
}

/** Fills in the form of something new and adds it. */
async function place(page, change, ware, name, fill) {
  await page.getByRole("button", { name: `Place ${ware}`, exact: true }).click();
  const form = page.getByRole("region", { name: "What is chosen" });
  await form.getByLabel("Name", { exact: true }).fill(name);
  for (const [label, value] of Object.entries(fill)) {
    const field = form.getByLabel(label, { exact: true }).first();
    for (let at = 0; at < 3 && !(await field.isVisible()); at += 1) await form.locator("details:not([open]) > summary").first().click();
    const tag = await field.evaluate((element) => `${element.tagName} ${element.type ?? ""} ${element.getAttribute("role") ?? ""}`);
    if (tag.includes("group")) for (const one of value) await field.getByLabel(one, { exact: true }).check();
    else if (tag.startsWith("SELECT")) await field.selectOption(value);
    else {
      await field.fill(String(value));
      await field.press("Tab");
    }
  }
  await change(() => form.getByRole("button", { name: "Add" }).click());
}

/** The library is in sight: so many things at once, all of them in groups, found by a word; what is wrong is marked where it is. */
async function see_the_library() {
  const { page, errors, change, name } = await edit("seen", "cell");
  await page.getByRole("tab", { name: "Machine" }).click();
  const in_sight = () => page.evaluate(() => {
    const room = document.querySelector(".shelf").getBoundingClientRect();
    return [...document.querySelectorAll(".ware")].filter((one) => one.getBoundingClientRect().bottom <= room.bottom).length;
  });
  await page.waitForTimeout(300);
  await shoot(page, "edit-library");
  assert.ok((await in_sight()) >= 20, `${await in_sight()} things in sight`);
  assert.equal(await page.getByRole("heading", { name: "Your own" }).count(), 0, "each kind of the library has its group and its picture");
  const pictures = await page.locator(".ware").evaluateAll((all) => all.map((one) => one.querySelector("path").getAttribute("d").length));
  assert.ok(pictures.length > 45 && pictures.every((length) => length > 8));
  await page.waitForTimeout(300);
  await shoot(page, "edit-library");
  // Nothing of the machine is cut off, and it takes much of the stage.
  const [stage, spots] = await page.evaluate(() => {
    const { left, top, right, bottom } = document.querySelector(".stage").getBoundingClientRect();
    return [{ left, top, right, bottom }, window.onescanEdit.corners()];
  });
  assert.ok(spots.every(({ x, y }) => x > stage.left && x < stage.right && y > stage.top + 40 && y < stage.bottom), JSON.stringify([stage, spots]));
  const [width, height] = ["x", "y"].map((axis) => Math.max(...spots.map((one) => one[axis])) - Math.min(...spots.map((one) => one[axis])));
  assert.ok(width > 0.6 * (stage.right - stage.left) || height > 0.6 * (stage.bottom - stage.top - 44), `${width} by ${height}`);
  await page.getByRole("button", { name: "Dark or light" }).click();
  await page.waitForTimeout(200);
  await shoot(page, "edit-library-dark");
  await page.getByLabel("Filter what can be placed").fill("beam");
  assert.deepEqual(await page.locator(".ware span").allTextContents(), ["light barrier", "laser distance", "light curtain"]);
  await page.getByLabel("Filter what can be placed").fill("");
  // A finding stands where it is: at the thing in the list and in its form.
  await page.getByRole("button", { name: /^barrier/ }).click();
  await change(() => page.getByRole("region", { name: "What is chosen" }).getByLabel("detected_signal", { exact: true }).fill("Nowhere").then(() => page.keyboard.press("Tab")));
  await page.locator(".inspector .found").getByText("Nowhere read by nobody").waitFor();
  await page.locator(".item", { hasText: "barrier" }).locator(".mark").waitFor();
  await page.locator("#check").getByText("1 wrong").waitFor();
  await shoot(page, "edit-finding");
  // axe finds nothing, with a form and a finding open.
  assert.deepEqual(await found_by_axe(page, axe.source), []);
  assert.deepEqual(await small_targets(page), []);
  await page.setViewportSize({ width: 390, height: 844 });
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  await shoot(page, "edit-phone");
  assert.deepEqual(errors, []);
  assert.ok(name);
}

async function build_a_machine() {
  const { page, errors, text, change, name } = await edit("built", "blank");
  await page.getByRole("tab", { name: "Machine" }).click();
  await place(page, change, "belt", "belt", {});
  await place(page, change, "box", "box[0..3]", { "mass_kg in kg": 0.5 });
  await place(page, change, "box", "pusher", {
    "x of size_m in m": 0.16, "y of size_m in m": 0.02, "z of size_m in m": 0.08,
    "x of position_m in m": 0.3, "y of position_m in m": -0.17, "z of position_m in m": 0.06, "mass_kg in kg": 2,
  });
  await place(page, change, "slide", "slide", { child: "pusher", "x of axis": 0, "y of axis": 1 });
  await place(page, change, "zone", "infeed", { "x of position_m in m": -0.8, "z of position_m in m": 0.051 });
  await place(page, change, "zone", "chute", { "x of size_m in m": 0.6, "y of size_m in m": 0.4, "z of size_m in m": 0.2, "x of position_m in m": 0.35, "y of position_m in m": 0.45, "z of position_m in m": -0.4 });
  await place(page, change, "conveyor", "conveyor", { belt: "belt", "speed_m_s in m/s": 0.3, run_signal: "Belt_On" });
  await place(page, change, "pneumatic cylinder", "cylinder", { joint: "slide", "stroke_m in m": 0.35, extend_signal: "Push", extended_signal: "Cylinder_Out", retracted_signal: "Cylinder_In" });
  await place(page, change, "light barrier", "barrier", { "x of point_m in m": 0.36, "y of point_m in m": -0.145, "z of point_m in m": 0.09, "x of direction": 0, "y of direction": 1, targets: ["box[0..3]"], detected_signal: "Box_At_Cylinder" });
  await place(page, change, "workpiece source", "source", { body: "infeed", targets: ["box[0..3]"], "interval_s in s": 4, enable_signal: "Belt_On", count_signal: "Boxes_In" });
  await place(page, change, "workpiece sink", "sink", { body: "chute", targets: ["box[0..3]"], count_signal: "Boxes_Out" });

  // A number outside of its range is reported, and not written.
  const scene = await text("plant.toml");
  await page.getByRole("button", { name: /^cylinder/ }).click();
  const stroke = page.getByLabel("stroke_m in m");
  await stroke.fill("99");
  await stroke.press("Tab");
  assert.equal(await text("plant.toml"), scene);
  await stroke.fill("0.35");

  // A body is dragged on the grid, and moved by keys.
  await page.getByRole("button", { name: /^pusher/ }).click();
  const at = await page.evaluate(() => window.onescanEdit.screen("pusher"));
  await change(async () => {
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x + 12, at.y, { steps: 4 });
    await page.mouse.move(at.x + 24, at.y, { steps: 4 });
    await page.mouse.up();
  });
  const place_of = async (body) => {
    const table = (await text("plant.toml")).split("[[").find((one) => one.includes(`name = "${body}"`));
    return JSON.parse(/position_m = (\[.*\])/.exec(table)[1]);
  };
  const [x_m, , z_m] = await place_of("pusher");
  assert.ok(x_m > 0.3 && Math.abs(x_m * 20 - Math.round(x_m * 20)) < 1e-9 && z_m === 0.06, `on the grid: ${x_m} ${z_m}`);
  for (const [axis, value] of [["x", "0.35"], ["y", "-0.17"]]) {
    const field = page.getByLabel(`${axis} of position_m in m`);
    if ((await field.inputValue()) === value) continue;
    await change(async () => {
      await field.fill(value);
      await field.press("Tab");
    });
  }
  assert.deepEqual(await place_of("pusher"), [0.35, -0.17, 0.06]);
  await shoot(page, "edit-machine");

  // What others need stays; who needs it is reported.
  await page.getByRole("button", { name: "Delete", exact: true }).click();
  await page.getByRole("alert").filter({ hasText: "is needed by joint `slide`, child" }).waitFor();

  // The barrier's signal is called otherwise than the program's variable: drawn.
  await page.getByRole("tab", { name: "Wiring" }).click();
  await tip(page, "Main.Box_There").scrollIntoViewIfNeeded();
  await change(() => draw(page, "barrier.detected", "Main.Box_There"));
  assert.match(await text("scenario.toml"), /^bind = \{ Box_At_Cylinder = "Main\.Box_There" \}$/m);
  await page.getByRole("button", { name: "Dark or light" }).click();
  await shoot(page, "edit-wiring-dark");
  assert.deepEqual(errors, []);

  // What the page has built, the command line runs.
  const wiring = typed("wiring", name);
  assert.equal(wiring.code, 0, wiring.out + wiring.err);
  const run = typed("run", name, "--record", "run");
  assert.equal(run.code, 0, run.out + run.err);
  const signals = ["Box_At_Cylinder", "Cylinder_Out", "Boxes_Out"];
  const exported = typed("export", "run", "-o", "run.csv", ...signals.flatMap((signal) => ["--signals", signal]));
  assert.equal(exported.code, 0, exported.err);
  const rows = (await readFile(join(room, "run.csv"), "utf8")).trim().split("\n").map((row) => row.split(","));
  const most = (signal) => Math.max(...rows.slice(1).map((row) => Number(row[rows[0].indexOf(signal)].replace("TRUE", "1").replace("FALSE", "0"))));
  for (const signal of signals) assert.ok(most(signal) >= 1, `${signal}: ${most(signal)}`);
  console.log(`boxes pushed off: ${most("Boxes_Out")}`);
}

try {
  await draw_a_connection();
  await see_the_library();
  await build_a_machine();
  console.log("the page edits a scenario: ok");
} finally {
  for (const child of children) child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
