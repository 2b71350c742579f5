// A heat of the arc furnace before the program itself: driven at the pulpit, recorded, and repeated to its digest.
// `node e2e/heat.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open, panel, press, sit, turn, until } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const furnace = join(scenarios, "arc-furnace");
const room = await mkdtemp(join(tmpdir(), "heat-"));
const [taken, again] = [join(room, "taken"), join(room, "again")];
const run = (...more) => ["run", furnace, "--until", "68min", "--format", "json", ...more];
const browser = await browse();
// Slow enough for a browser without a graphics card, in which each step at the pulpit takes a second.
const { child, said, over, urls } = await begin(program, run("--web", "--pace", "60", "--record", taken), ["the session"]);

/** Shows a page of the pulpit, and no other. */
async function leaf(page, name) {
  await panel(page, "pulpit").getByLabel("Page").selectOption(name);
  for (const one of ["water", "hydraulics", "electrics"]) await panel(page, one).waitFor({ state: one === name ? "visible" : "hidden" });
}

/** Moves a slider of the pulpit by keys, and waits until its signal has the value. */
async function slide(page, label, signal, value) {
  const slider = panel(page, "pulpit").getByRole("slider", { name: label, exact: true });
  await slider.fill(String(value));
  await until(page, [signal, "=", value]);
}

try {
  const { page, errors } = await open(browser, urls[0]);
  await sit(page, "pulpit");
  // less voltage while the electrodes bore down
  await until(page, ["Heat_step", "=", 6]);
  await slide(page, "Tap", "Tap_selector", 3);
  await until(page, ["Heat_step", "=", 7]);
  await slide(page, "Tap", "Tap_selector", 0);
  for (const name of ["water", "hydraulics", "electrics"]) await leaf(page, name);
  if (folder !== null) await page.screenshot({ path: `${folder}/heat.png` });
  await leaf(page, "none");
  // the flat bath: electrodes by hand for a moment, which stay where they are
  await until(page, ["Heat_step", "=", 8]);
  await turn(page, "pulpit", "Electrodes automatic", false);
  await turn(page, "pulpit", "Electrodes automatic", true);
  await press(page, "Acknowledge", "Acknowledge");
  // no further heat behind this one
  await until(page, ["Heat_step", "=", 14]);
  await turn(page, "pulpit", "Heats", false);
  const code = await over;
  assert.deepEqual(errors, []);
  assert.ok(code === 0 || code === 1, `${said.out}${said.err}`);
  const report = JSON.parse(said.out);
  const events = await readFile(join(taken, "run-1", "events.jsonl"), "utf8");
  const written = events.split("\n").filter((line) => line.includes('"event":"operator"'));
  assert.ok(written.length >= 11, events);

  const repeated = (source, ...more) => {
    const { stdout, stderr } = spawnSync(program, run("--replay-operator", source, ...more));
    const report = JSON.parse(String(stdout) || `"${String(stderr)}"`);
    assert.equal(report.expectations.find((one) => one.name === "steel is tapped hot enough")?.verdict, "met");
    return report.digest;
  };
  assert.equal(repeated(taken, "--record", again), report.digest, "in process");
  assert.equal(repeated(taken, "--transport", "tcp"), report.digest, "over TCP");
  assert.equal(repeated(again), report.digest, "from the recording of the repetition");
  console.log(`a heat is driven at the pulpit: ok; ${written.length} inputs, ${report.digest}`);
} finally {
  child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
