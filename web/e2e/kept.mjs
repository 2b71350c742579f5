// What an operator did on the page becomes a case, which has the digest of the session.
// `node e2e/kept.mjs PROGRAM SCENARIOS [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cp, mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse, open } from "./pulpit.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const room = await mkdtemp(join(tmpdir(), "kept-"));
const machine = join(room, "robot-cell");
await cp(join(scenarios, "robot-cell"), machine, { recursive: true });
const browser = await browse();
const cases = () => readFile(join(machine, "cases.toml"), "utf8");

/** An operator at the cell; what they did is shown as a case, and saved where that is allowed. */
async function operate(words, name) {
  const session = await begin(program, ["run", machine, "--until", "6s", "--web", "--await-viewer", "--stay", "--format", "json", ...words], ["the session"]);
  const { page, errors } = await open(browser, session.urls[0]);
  await page.waitForFunction(() => window.onescan.picture().t_ns > 1e9);
  // A force, a failure and a changed parameter.
  await page.getByRole("tab", { name: "Part" }).click();
  const { bodies, components } = await (await fetch(`${session.urls[0]}api/session`)).json();
  const { body } = components.find((one) => one.name === "cup");
  await page.getByRole("listbox", { name: "Part" }).selectOption({ index: bodies.findIndex((one) => one.name === body) });
  await page.getByRole("heading", { name: /^cup / }).waitFor();
  await page.getByRole("button", { name: /^Fail cup: clogged/ }).click();
  await page.getByRole("button", { name: /^Change / }).first().click();
  await page.getByRole("dialog").getByRole("textbox").press("End");
  await page.keyboard.type("1");
  await page.keyboard.press("Enter");
  await page.getByText(/, changed$/).first().waitFor();
  await page.waitForFunction(() => window.onescan.picture().t_ns > 2.5e9);
  await page.getByRole("button", { name: /^Repair cup: clogged/ }).click();
  await page.locator("#ending").getByText(/^The run is over at 6/).waitFor({ timeout: 60_000 });
  // After the end nothing can be gone back to.
  assert.equal(await page.getByText("go back to now to operate").count(), 0);
  await page.getByRole("button", { name: "Save as a case" }).click();
  const dialog = page.getByRole("dialog", { name: "Save as a case" });
  await dialog.getByLabel("Name of the case").fill("with blanks");
  await dialog.getByText("A name has letters").waitFor();
  await dialog.getByLabel("Name of the case").fill(name);
  await dialog.getByText(`name = "${name}"`).waitFor();
  const shown = await dialog.locator("pre").textContent();
  if (folder !== null) await page.screenshot({ path: join(folder, `${name}.png`) });
  return { session, page, errors, dialog, shown };
}

try {
  const before = await cases();
  // Where the run does not allow it, one sees the case and copies it.
  const looked = await operate([], "looked-at");
  assert.ok(await looked.dialog.getByRole("button", { name: "Save", exact: true }).isDisabled());
  await looked.dialog.getByText("this run was not begun with --save-cases").waitFor();
  await looked.dialog.getByRole("button", { name: "Close" }).click();
  await looked.page.locator("#ending").getByRole("button", { name: "Close" }).click();
  await looked.session.over;
  assert.equal(await cases(), before, "nothing was written");

  const { session, page, errors, dialog, shown } = await operate(["--save-cases"], "cup-by-hand");
  await dialog.getByRole("button", { name: "Save", exact: true }).click();
  await dialog.getByText("It is saved. Run it with --case cup-by-hand.").waitFor();
  // Once only: two cases of a name there cannot be.
  assert.ok(await dialog.getByRole("button", { name: "Save", exact: true }).isDisabled());
  await dialog.getByRole("button", { name: "Close" }).click();
  await page.locator("#ending").getByRole("button", { name: "Close" }).click();
  await session.over;
  assert.equal(await cases(), `${before.trimEnd()}\n\n${shown}`);
  const { digest } = JSON.parse(session.said.out);
  const again = spawnSync(program, ["run", machine, "--case", "cup-by-hand", "--format", "json"]);
  assert.equal(JSON.parse(String(again.stdout)).digest, digest, `${again.stdout}${again.stderr}\n${shown}`);
  assert.match(shown, /fault = \[[^]*parameter = \[/, "the case has what the operator did");
  assert.deepEqual([...errors, ...looked.errors], []);
  console.log("what an operator did is a case with the digest of the session");
} finally {
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
