// A run that was over before anybody looked: its page stays, shows the whole run, and lets other sessions go on from it.
// `node e2e/ending.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { join } from "node:path";
import { begin, browse, open } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const browser = await browse();
const words = ["run", join(scenarios, "shear"), "--web", "--no-await-viewer", "--stay", "--pace", "max"];
const session = await begin(program, words, ["the session"]);
try {
  const { page, errors } = await open(browser, session.urls[0]);
  const ending = page.locator("#ending");
  await ending.getByText(/^The run is over at 6/).waitFor();
  await ending.getByRole("button", { name: "Run again" }).waitFor();
  assert.equal(await page.evaluate(() => window.onescan.picture().t_ns), 6e9, "the last step is shown");
  for (const name of ["Hold", "Step", "Go"]) assert.ok(await page.getByRole("button", { name, exact: true }).isDisabled(), name);
  if (folder !== null) await page.screenshot({ path: `${folder}/ending.png` });

  // The past, by keyboard alone.
  const slider = page.getByRole("slider", { name: "Time that is shown" });
  await slider.focus();
  await page.keyboard.press("Home");
  await page.waitForFunction(() => window.onescan.picture().isPast && window.onescan.picture().step === 0);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => window.onescan.picture().step === 1);

  // Another session goes on from the end.
  await ending.getByRole("button", { name: "Go on for" }).click();
  const link = page.getByRole("link", { name: /^Session from 6/ });
  await link.waitFor();
  const other = await open(browser, await link.getAttribute("href"));
  await other.page.waitForFunction(() => window.onescan.picture().t_ns > 6e9);
  await other.page.close();

  await ending.getByRole("button", { name: "Close" }).click();
  assert.equal(await session.over, 0, session.said.err);
  assert.match(session.said.out, /digest/);
  assert.deepEqual([...errors, ...other.errors], []);
} finally {
  await browser.close();
}
console.log("the page of a run that is over: looked back, gone on from, closed");
