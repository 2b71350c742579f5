// A trainer before the program itself: a link is cut and mended by hand, a view is shown to the trainee, who opens a page.
// `node e2e/trainer.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open, panel, sit, turn, until } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const furnace = join(scenarios, "arc-furnace");
const STEP_NS = 20_000_000;
const room = await mkdtemp(join(tmpdir(), "trainer-"));
const [session, starts] = [join(room, "session"), join(room, "starts")];
const browser = await browse();
const train = (...more) => ["train", furnace, "link-lost", "--starts", starts, "--format", "json", ...more];
const words = train("--trainee", "ann", "--web", "--pace", "2", "--record", session);
const { child, said, over, urls } = await begin(program, words, ["trainee's page", "trainer's page"]);
const LINK = "Link of the PLCs lost";

try {
  const [trainee, trainer] = [await open(browser, urls[0]), await open(browser, urls[1])];
  // The trainee sees what the trainer shows; who shows is the trainer.
  assert.equal(await trainee.page.getByRole("button", { name: "Show view" }).count(), 0);
  assert.equal(await trainee.page.getByRole("button", { name: "For all" }).count(), 0);
  await trainer.page.getByRole("combobox", { name: "View", exact: true }).selectOption("bath");
  await trainer.page.getByRole("button", { name: "Show view" }).click();
  await trainee.page.getByRole("button", { name: "bath" }).and(trainee.page.locator("[aria-pressed=true]")).waitFor();

  await sit(trainer.page, "malfunctions");
  await sit(trainee.page, "pulpit");
  await turn(trainer.page, "malfunctions", LINK, true);
  const pulpit = panel(trainee.page, "pulpit");
  await turn(trainee.page, "pulpit", "Automatic", false);
  await pulpit.getByLabel("Page").selectOption("electrics");
  await panel(trainee.page, "electrics").waitFor();
  // The trainer sees which page is open.
  await panel(trainer.page, "electrics").waitFor();
  if (folder !== null) await trainee.page.screenshot({ path: `${folder}/trainer-trainee.png` });
  if (folder !== null) await trainer.page.screenshot({ path: `${folder}/trainer.png` });
  await until(trainee.page, ["Breaker_closed", "=", 1]);
  await turn(trainee.page, "pulpit", "Electrodes automatic", false);
  for (const phase of [1, 2, 3]) {
    // up until there is no arc; it goes back to the middle when it is left
    await pulpit.getByRole("slider", { name: `Electrode ${phase}` }).fill("1");
    await until(trainee.page, [`Current[${phase}]`, "<", 1000]);
  }
  await until(trainee.page, ["Current[1]", "<", 1000], ["Current[2]", "<", 1000], ["Current[3]", "<", 1000]);
  await turn(trainer.page, "malfunctions", LINK, false);
  await until(trainer.page, ["Breaker_closed", "=", 0]);
  await turn(trainee.page, "pulpit", "Electrodes automatic", true);
  await turn(trainee.page, "pulpit", "Automatic", true);
  const code = await over;
  assert.deepEqual([...trainee.errors, ...trainer.errors], []);
  assert.equal(code, 0, `${said.out}${said.err}`);
  const attempt = JSON.parse(said.out).attempts.at(-1);
  const [lost] = attempt.score.malfunctions;
  const events = (await readFile(join(session, "run-1", "events.jsonl"), "utf8")).trim().split("\n").map((line) => JSON.parse(line));
  const image_ns = (found) => events.find((one) => one.event === "operator" && found(one)).t_v_ns + STEP_NS;
  assert.equal(lost.begun_ns, image_ns((one) => one.action === "disturb"));
  assert.equal(lost.identified.at_ns, image_ns((one) => one.signal === "Page"));
  assert.ok(events.every((one) => one.action !== "view"), "a view leaves no trace");

  const again = spawnSync(program, train("--replay-operator", session));
  assert.equal(again.status, 0, `${again.stdout}${again.stderr}`);
  const repeated = JSON.parse(String(again.stdout)).attempts.at(-1);
  assert.deepEqual([repeated.digest, repeated.score], [attempt.digest, attempt.score]);
  const after = (response) => `${(response.after_ns / 1e9).toFixed(2)} s`;
  console.log(`a link is cut, found and mended: ok; identified after ${after(lost.identified)}, acted after ${after(lost.acted)}`);
} finally {
  child.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
