// A lesson with a PLC that is a process of its own, before the program itself: both pages say how far it is driven, in the
// language of the reader, and keys rest until it is there.
// `node e2e/driven.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, panel } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const furnace = join(scenarios, "arc-furnace");
const room = await mkdtemp(join(tmpdir(), "driven-"));
const browser = await browse();

const plc = spawn(program, ["plc", furnace, "--client", "process", "--cycle", "2ms", "--s7", "127.0.0.1:0"], { stdio: ["pipe", "pipe", "ignore"] });
const gateway = await new Promise((found, lost) => {
  let said = "";
  plc.stdout.on("data", (data) => {
    const url = /serving (s7:\S+)/.exec((said += data));
    if (url !== null) found(`process=${url[1]}`);
  });
  plc.on("exit", () => lost(new Error(`no PLC: ${said}`)));
});
const words = ["train", furnace, "blind", "--gateway", gateway, "--web", "--pace", "4", "--format", "json", "--record", join(room, "session")];
const { child, over, urls } = await begin(program, words, ["trainee's page", "trainer's page"]);

/** A page in a language, from the moment at which it can be asked. */
async function reader(url, locale) {
  const context = await browser.newContext({ locale, viewport: { width: 1280, height: 720 } });
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => window.onescan !== undefined);
  return { page, errors };
}

/** How far the PLC is, as the page has it. */
const share = (page) => page.locator(".lesson-drive progress").evaluate((bar) => bar.value);

/** While the PLC is on its way: what both read, and that nothing can be pressed. */
async function is_driven(trainee, trainer) {
  await trainee.page.getByText(/^PLC process is being driven from its cold start by way of melting to 13:00: it is at [0-9:]+, [0-9]+ %\.$/).waitFor();
  await trainer.page.getByText(/^Die SPS process wird von ihrem Kaltstart über Schmelzen bis 13:00 gefahren: Sie ist bei [0-9:]+, [0-9]+ %\.$/).waitFor();
  await trainee.page.getByText("the PLC is driven", { exact: true }).waitFor();
  const key = panel(trainee.page, "pulpit").getByRole("switch", { name: /^Automatic/ });
  await key.and(trainee.page.locator(":disabled")).waitFor();
  assert.match(await key.getAttribute("title"), /being driven/);
  for (const name of ["Halt", "Weiter", "Wiederholen"]) {
    const one = trainer.page.getByRole("button", { name, exact: true });
    await one.and(trainer.page.locator(":disabled")).waitFor();
    assert.match(await one.getAttribute("title"), /wird dorthin gefahren/);
  }
  const first = await share(trainee.page);
  await trainee.page.waitForFunction((first) => document.querySelector(".lesson-drive progress").value > first, first);
}

/** Until the attempt is under way, and keys work. */
async function is_there(trainee, trainer) {
  for (const { page } of [trainee, trainer]) {
    await page.locator(".lesson-drive").waitFor({ state: "hidden", timeout: 300_000 });
    await page.waitForFunction(() => window.onescan.picture().t_ns >= 780e9);
  }
  await panel(trainee.page, "pulpit").getByRole("switch", { name: /^Automatic/ }).and(trainee.page.locator(":enabled")).waitFor();
  await trainer.page.getByRole("button", { name: "Wiederholen", exact: true }).and(trainer.page.locator(":enabled")).waitFor();
}

try {
  const [trainee, trainer] = [await reader(urls[0], "en-GB"), await reader(urls[1], "de-DE")];
  // The first attempt, and one again.
  await is_driven(trainee, trainer);
  if (folder !== null) await trainee.page.screenshot({ path: `${folder}/driven.png` });
  if (folder !== null) await trainer.page.screenshot({ path: `${folder}/driven-de.png` });
  await is_there(trainee, trainer);
  await trainer.page.getByRole("button", { name: "Wiederholen", exact: true }).click();
  await is_driven(trainee, trainer);
  if (folder !== null) await trainer.page.screenshot({ path: `${folder}/driven-again.png` });
  await is_there(trainee, trainer);
  assert.deepEqual([...trainee.errors, ...trainer.errors], []);
  child.kill("SIGINT");
  await over;
  console.log("a PLC is driven to where a lesson begins, and the pages say so: ok");
} finally {
  child.kill();
  plc.kill();
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
