// The pictures of pages in docs/tutorials, of what their walk has left, and what the reader does on the page there.
// `tests/tutorials --keep KEPT`, then `node e2e/tutorials.mjs PROGRAM KEPT [FOLDER]`; FOLDER takes the pictures.

import assert from "node:assert/strict";
import { join } from "node:path";
import { begin, browse, panel, until } from "./pulpit.mjs";

const [program, kept, folder = null] = process.argv.slice(2);
const browser = await browse();
const shoot = async (page, name, options = {}) => {
  if (folder !== null) await page.screenshot({ path: join(folder, name), ...options });
};

/** A reader of cell.md presses Start, sees boxes stamped, and Stop. */
async function commission() {
  const { child, over, urls } = await begin(program, ["run", join(kept, "cell/stamp"), "--until", "10min", "--web"], ["the session"]);
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "light" });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(urls[0]);
  await page.waitForFunction(() => window.onescan?.picture().step > 5);
  const key = (label) => panel(page, "desk").getByRole("button", { name: label, exact: true });
  await key("Start").click({ delay: 100 });
  await until(page, ["Running", "=", 1]);
  await until(page, ["Stamped", "=", 2]);
  await until(page, ["Stamp_Way", ">", 0.1]);
  await page.getByRole("tab", { name: "Panels" }).click();
  await shoot(page, "cell-page.png");
  await key("Stop").click({ delay: 100 });
  await until(page, ["Running", "=", 0]);
  child.kill("SIGINT");
  assert.equal(await over, 130);
  assert.deepEqual(errors, []);
}

/** The report that a reader of ci.md sends to somebody. */
async function report() {
  const page = await browser.newPage({ viewport: { width: 1000, height: 700 }, colorScheme: "light" });
  await page.goto(`file://${join(kept, "ci/tests.html")}`);
  assert.match(await page.locator("body").innerText(), /TEST_Neither_runs_dry/);
  await shoot(page, "ci-report.png");
}

try {
  await commission();
  await report();
  console.log("tutorials: their pages do what they say");
} finally {
  await browser.close();
}
