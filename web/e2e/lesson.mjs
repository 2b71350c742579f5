// A lesson before the program itself: three malfunctions are met at the pulpit, and measured to the step.
// `node e2e/lesson.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open, panel, press, sit, until } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const furnace = join(scenarios, "arc-furnace");
const STEP_NS = 20_000_000;
const room = await mkdtemp(join(tmpdir(), "lesson-"));
const [session, starts, report] = [join(room, "session"), join(room, "starts"), join(room, "lesson.html")];
const browser = await browse();
const words = [
  "train", furnace, "three-malfunctions", "--trainee", "ann", "--web", "--pace", "4", "--starts", starts, "--record", session,
  "--html", report, "--format", "json",
];
const { child, said, over, urls } = await begin(program, words, ["trainee's page", "trainer's page"]);

/** Until an alarm is on, or none. */
const rings = (page, name) => page.waitForFunction(
  (name) => (name === null ? window.onescan.alarms().every((one) => !one.isOn) : window.onescan.alarms().some((one) => one.isOn && one.name === name)), name, { timeout: 120_000 });

try {
  const [trainee, trainer] = [await open(browser, urls[0]), await open(browser, urls[1])];
  // What is the trainer's is on the trainer's page alone.
  assert.equal(await panel(trainee.page, "malfunctions").count(), 0);
  assert.equal(await trainee.page.getByRole("button", { name: "Hold" }).count(), 0);
  await sit(trainer.page, "malfunctions");
  // The start twenty times again, and the flat bath in less than a second.
  const at = (page) => page.evaluate(() => window.onescan.picture().t_ns);
  for (let attempt = 0; attempt < 20; attempt += 1) {
    await trainer.page.waitForFunction(() => window.onescan.picture().t_ns > 784e9);
    const before = await at(trainer.page);
    await trainer.page.getByRole("button", { name: "Repeat" }).click();
    await trainer.page.waitForFunction((before) => window.onescan.picture().t_ns < before, before);
  }
  const choose = trainer.page.getByLabel("Prepared state");
  await choose.selectOption("flat bath");
  await trainer.page.getByRole("button", { name: "Jump" }).click();
  await trainer.page.waitForFunction(() => window.onescan.picture().t_ns >= 2880e9);
  // Now it is there: from elsewhere and back again within a second.
  await choose.selectOption("melting");
  await trainer.page.getByRole("button", { name: "Jump" }).click();
  await trainer.page.waitForFunction(() => window.onescan.picture().t_ns < 2000e9);
  await choose.selectOption("flat bath");
  const asked = performance.now();
  await trainer.page.getByRole("button", { name: "Jump" }).click();
  await trainer.page.waitForFunction(() => window.onescan.picture().t_ns >= 2880e9);
  const jumped_ms = performance.now() - asked;
  await choose.selectOption("melting");
  await trainer.page.getByRole("button", { name: "Jump" }).click();
  await trainer.page.waitForFunction(() => window.onescan.picture().t_ns < 2000e9);

  const { page } = trainee;
  await sit(page, "pulpit");
  const pulpit = panel(page, "pulpit");
  // What is asked, and how much time is left.
  const sheet = page.getByRole("region", { name: "Lesson" });
  await sheet.getByText("at most 2 times: acknowledgement without an alarm").waitFor();
  await sheet.getByRole("listitem").filter({ hasText: "the walls stay below 150 °C" }).waitFor();
  await sheet.getByText(/^[0-6]:[0-5][0-9]$/).waitFor();
  // A leak: acknowledged, taken by hand, and given back when the water is there again.
  await rings(page, "water of the walls");
  // The banner names it, and its key is the pulpit's: the program knows.
  const banner = page.getByRole("region", { name: "Most urgent alarm" });
  await banner.getByText("water of the walls").waitFor();
  assert.deepEqual(await page.evaluate(() => window.onescan.alarms()), [{ name: "water of the walls", isOn: true, isSeen: false, isAside: false }]);
  await banner.getByRole("button", { name: "Acknowledge" }).click();
  await page.waitForFunction(() => window.onescan.alarms().every((one) => one.isSeen));
  await until(page, ["Acknowledge", "=", 0]);
  await pulpit.getByRole("switch", { name: /^Automatic/ }).click();
  if (folder !== null) await page.screenshot({ path: `${folder}/lesson.png` });
  if (folder !== null) await trainer.page.screenshot({ path: `${folder}/lesson-trainer.png` });
  await trainer.page.getByRole("switch", { name: /^Water leak, walls/ }).and(trainer.page.locator("[aria-checked=true]")).waitFor();
  await until(page, ["Wall_pressure", ">", 2.5]);
  await press(page, "Acknowledge", "Acknowledge");
  await rings(page, null);
  await pulpit.getByRole("switch", { name: /^Automatic/ }).click();
  // No suction: acknowledged, and again when it is back.
  await rings(page, "pressure in the vessel");
  await press(page, "Acknowledge", "Acknowledge");
  await until(page, ["Vessel_pressure", "<", 10]);
  await press(page, "Acknowledge", "Acknowledge");
  await rings(page, null);
  await until(page, ["Breaker_closed", "=", 1]);
  // An electrode breaks: a new piece.
  await until(page, ["Electrode_broken[1]", "=", 1]);
  await press(page, "New electrode", "Join_electrode");
  const code = await over;
  // What came of it, on the trainee's own page.
  await sheet.getByRole("heading", { name: "Passed", exact: true }).waitFor();
  await sheet.getByRole("cell", { name: "water leak" }).waitFor();
  assert.equal(await page.locator("#link").textContent(), "over");
  if (folder !== null) await page.screenshot({ path: `${folder}/lesson-result.png` });
  assert.deepEqual([...trainee.errors, ...trainer.errors], []);
  assert.equal(code, 0, `${said.out}${said.err}`);
  const record = JSON.parse(said.out);
  assert.equal(record.attempts.length, 25);
  const melting = record.attempts.filter((attempt) => attempt.start === "melting");
  for (const attempt of melting) assert.equal(attempt.begin_digest, melting[0].begin_digest);

  // Its times are those of the recording, to the step.
  const last = record.attempts.at(-1);
  const run = join(session, `run-${last.number}`);
  const events = (await readFile(join(run, "events.jsonl"), "utf8")).trim().split("\n").map((line) => JSON.parse(line));
  const names = ["Acknowledge", "Automatic", "Join_electrode", "Alarm", "Breaker_closed"];
  const table = join(room, "run.csv");
  const exported = spawnSync(program, ["export", run, "-o", table, ...names.flatMap((name) => ["--signals", name])]);
  assert.equal(exported.status, 0, String(exported.stderr));
  const [head, ...rows] = (await readFile(table, "utf8")).trim().split("\n").map((line) => line.split(","));
  const column = (name) => head.indexOf(name);
  const image = (row, name) => Number(row[column(name)]);
  const first = (from_ns, is) => {
    const index = rows.findIndex((row, index) => Number(row[0]) > from_ns && is(row, rows[index - 1]));
    return Number(rows[index][0]);
  };
  const rose = (name) => (row, before) => image(row, name) === 1 && image(before, name) === 0;
  const expected = [
    ["wall", rose("Acknowledge"), (row) => image(row, "Automatic") === 0],
    ["bath", rose("Acknowledge"), null],
    ["mast_1", (row, before) => rose("Join_electrode")(row, before) || rose("Acknowledge")(row, before), rose("Join_electrode")],
  ];
  for (const [index, [component, identify, act]] of expected.entries()) {
    const handled = last.score.malfunctions[index];
    const event = events.find((one) => one.event === "timeline" && one.action === "fail" && one.component === component);
    assert.equal(handled.begun_ns, event.t_v_ns + STEP_NS, component);
    assert.equal(handled.identified.at_ns, first(handled.begun_ns, identify), component);
    if (act !== null) assert.equal(handled.acted.at_ns, first(handled.begun_ns, act), component);
  }
  assert.match(await readFile(report, "utf8"), /water leak/);

  // All attempts once more, without a page.
  const again = spawnSync(program, ["train", furnace, "three-malfunctions", "--starts", starts, "--format", "json", "--replay-operator", session]);
  assert.equal(again.status, 0, `${again.stdout}${again.stderr}`);
  const repeated = JSON.parse(String(again.stdout));
  assert.deepEqual(repeated.attempts.map((one) => one.digest), record.attempts.map((one) => one.digest));
  assert.deepEqual(repeated.attempts.at(-1).score, last.score);
  console.log(`a lesson is taken at the pulpit: ok; jump to the flat bath ${jumped_ms.toFixed(0)} ms`);
} finally {
  child.kill();
  // It writes until it has ended.
  await over;
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
