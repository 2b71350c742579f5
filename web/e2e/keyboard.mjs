// A whole lesson, and a session that goes on from the past, by the keyboard alone; what axe finds on the pages of a lesson; their
// targets; 200 % zoom. `node e2e/keyboard.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import axe from "axe-core";
import { begin, browse, open, panel, until } from "./pulpit.mjs";
import { found_by_axe, go_to, open_sheet, press_key, small_targets } from "./keys.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const browser = await browse();
const shoot = async (page, name) => {
  if (folder !== null) await page.screenshot({ path: join(folder, `${name}.png`) });
};

/** No mouse: a click of a script would be one. */
function without_mouse(page) {
  for (const name of ["click", "dblclick", "tap", "hover"]) page[name] = page.mouse[name] = () => assert.fail("the keyboard alone");
}

/** Three malfunctions are met by whoever has no mouse. */
async function take_a_lesson() {
  const room = await mkdtemp(join(tmpdir(), "keyboard-"));
  const words = ["train", join(scenarios, "arc-furnace"), "three-malfunctions", "--trainee", "kim", "--web", "--pace", "2", "--starts", join(room, "starts"), "--format", "json"];
  const { child, said, over, urls } = await begin(program, words, ["trainee's page", "trainer's page"]);
  try {
    const { page, errors } = await open(browser, urls[0]);
    without_mouse(page);
    const pulpit = panel(page, "pulpit");
    await press_key(page, pulpit.getByRole("button", { name: "Take seat" }));
    await pulpit.getByRole("button", { name: "Leave seat" }).waitFor();
    const rings = (name) => page.waitForFunction(
      (name) => (name === null ? window.onescan.alarms().every((one) => !one.isOn) : window.onescan.alarms().some((one) => one.isOn && one.name === name)), name, { timeout: 120_000 });
    const hold = async (label, signal) => {
      await go_to(page, pulpit.getByRole("button", { name: label, exact: true }));
      await page.keyboard.down("Space");
      await until(page, [signal, "=", 1]);
      await page.keyboard.up("Space");
      await until(page, [signal, "=", 0]);
    };
    const acknowledge = pulpit.getByRole("button", { name: "Acknowledge", exact: true });
    const automatic = pulpit.getByRole("switch", { name: /^Automatic/ });
    // The hand is on the key: the first alarm is to be acknowledged within 20 s of the machine, and Tab takes its time here.
    await go_to(page, acknowledge);
    await rings("water of the walls");
    await hold("Acknowledge", "Acknowledge");
    await press_key(page, automatic, "Space");
    await until(page, ["Automatic", "=", 0]);
    await shoot(page, "keyboard-lesson");
    await until(page, ["Wall_pressure", ">", 2.5]);
    await hold("Acknowledge", "Acknowledge");
    await rings(null);
    await press_key(page, automatic, "Space");
    // All is well for half a minute: time for what is no part of the lesson.
    assert.deepEqual(await found_by_axe(page, axe.source), [], "the trainee's page");
    const trainer = await open(browser, urls[1]);
    assert.deepEqual(await found_by_axe(trainer.page, axe.source), [], "the trainer's page");
    // Nobody looks at it any more, and a second machine drawn without a graphics card makes a trainee late.
    await trainer.page.close();
    assert.deepEqual(trainer.errors, []);
    assert.deepEqual(await small_targets(page), []);
    await rings("pressure in the vessel");
    await press_key(page, page.getByRole("region", { name: "Most urgent alarm" }).getByRole("button", { name: "Acknowledge" }));
    await page.waitForFunction(() => window.onescan.alarms().every((one) => one.isSeen));
    await until(page, ["Acknowledge", "=", 0]);
    await until(page, ["Vessel_pressure", "<", 10]);
    await hold("Acknowledge", "Acknowledge");
    await rings(null);
    await until(page, ["Electrode_broken[1]", "=", 1]);
    await hold("New electrode", "Join_electrode");
    const code = await over;
    assert.equal(code, 0, `${said.out}${said.err}`);
    await page.getByRole("heading", { name: "Passed", exact: true }).waitFor();
    assert.deepEqual(await found_by_axe(page, axe.source), [], "the trainee's page with its result");
    assert.deepEqual(errors, []);
    console.log("a lesson with three malfunctions: passed by the keyboard alone");
  } finally {
    child.kill();
    await over;
    await rm(room, { recursive: true, force: true });
  }
}

/** The past is shown, another session goes on from it, a parameter is changed there, at 200 % zoom. */
async function fork_the_past() {
  const { child, over, urls } = await begin(program, ["run", join(scenarios, "filling-machine"), "--operator", "panel", "--until", "1h", "--web"], ["the session"]);
  try {
    // 200 % of 1280 x 720
    const page = await browser.newPage({ viewport: { width: 640, height: 360 }, deviceScaleFactor: 2 });
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error.stack)));
    await page.goto(urls[0]);
    await page.waitForFunction(() => window.onescan?.picture().step > 200);
    without_mouse(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 640, "nothing is to be scrolled sideways");
    await shoot(page, "zoom-200");
    for (const name of await page.getByRole("tab").allTextContents()) {
      await open_sheet(page, name);
      assert.deepEqual(await small_targets(page), [], name);
    }
    const slider = page.getByRole("slider", { name: "Time that is shown" });
    await go_to(page, slider);
    await page.keyboard.press("Home");
    await page.waitForFunction(() => window.onescan.picture().isPast && window.onescan.picture().step === 0);
    for (let step = 1; step <= 3; step += 1) {
      await page.keyboard.press("ArrowRight");
      await page.waitForFunction((step) => window.onescan.picture().step === step, step);
    }
    await press_key(page, page.getByRole("button", { name: "Go on from here" }));
    const link = page.getByRole("link", { name: /^Session from 0/ });
    await go_to(page, link);
    const other = await open(browser, await link.getAttribute("href"));
    await other.page.waitForFunction(() => window.onescan.picture().step > 5);
    await press_key(page, page.getByRole("button", { name: "Back to now" }));
    await page.waitForFunction(() => !window.onescan.picture().isPast);
    assert.deepEqual([...errors, ...other.errors], []);
    console.log("a session goes on from the past: by the keyboard alone, at 200 %");
  } finally {
    child.kill("SIGINT");
    await over;
  }
}

try {
  await fork_the_past();
  await take_a_lesson();
} finally {
  await browser.close();
}
