// A new user's path, timed: from `new` and `run --web` to a parameter that was changed and an effect that is seen, in at most five
// actions. `node e2e/first.mjs PROGRAM [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, browse } from "./pulpit.mjs";

const [program, folder = null] = process.argv.slice(2);
const ACTIONS_MOST = 5;
const room = await mkdtemp(join(tmpdir(), "first-"));
const cell = join(room, "my-cell");
const browser = await browse();
const made = spawnSync(program, ["new", cell]);
assert.equal(made.status, 0, String(made.stderr));
const started = performance.now();
const { child, over, urls } = await begin(program, ["run", cell, "--until", "1h", "--web"], ["the session"]);
let actions = 0;
const act = async (deed) => {
  actions += 1;
  await deed();
};

/** How fast the first box goes along the belt, m/s, over some pictures. */
async function speed(page) {
  return page.evaluate(async () => {
    const read = () => {
      for (let box = 0; box < 4; box += 1) {
        const at = window.onescan.position_m(`box[${box}]`);
        if (at !== null && Math.abs(at[1]) < 0.05 && at[0] > -0.7 && at[0] < 0.2) return { box, x: at[0], t_ns: window.onescan.picture().t_ns };
      }
      return null;
    };
    for (;;) {
      const from = read();
      await new Promise((done) => setTimeout(done, 250));
      const to = read();
      if (from !== null && to !== null && from.box === to.box && to.t_ns > from.t_ns) return ((to.x - from.x) * 1e9) / (to.t_ns - from.t_ns);
    }
  });
}

try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "light" });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error.stack)));
  // What a person does is counted: opening the page is the first.
  await act(() => page.goto(urls[0]));
  await page.waitForFunction(() => window.onescan?.picture().step > 50);
  // Boxes that wait for their source are out of the world, and are not drawn.
  const seen = await page.evaluate(() => window.onescan.sight().bodies.map((one) => one.name));
  assert.ok(seen.filter((name) => name.startsWith("box[")).length < 4, seen.join(", "));
  if (folder !== null) await page.screenshot({ path: join(folder, "first-opened.png") });
  const before = await speed(page);
  // The belt, by a click on it.
  const at = await page.evaluate(() => {
    const { bodies } = window.onescan.sight();
    const { left, top } = document.querySelector("#canvas canvas").getBoundingClientRect();
    const [x0, y0, x1, y1] = bodies.find((one) => one.name === "belt").box;
    return [left + x0 + 0.25 * (x1 - x0), top + y0 + 0.36 * (y1 - y0)];
  });
  await act(() => page.mouse.click(at[0], at[1]));
  await page.getByRole("heading", { name: "belt", exact: true }).waitFor();
  await act(() => page.getByRole("button", { name: "Change speed", exact: true }).click());
  await act(() => page.keyboard.type("0.6"));
  if (folder !== null) await page.screenshot({ path: join(folder, "first-changing.png") });
  await act(() => page.keyboard.press("Enter"));
  await page.getByText("0.6 m/s, changed").waitFor();
  await page.waitForTimeout(500);
  const after = await speed(page);
  assert.ok(after > 1.5 * before, `${before} m/s, then ${after} m/s`);
  const took_s = (performance.now() - started) / 1000;
  if (folder !== null) await page.screenshot({ path: join(folder, "first-changed.png") });
  assert.ok(actions <= ACTIONS_MOST, `${actions} actions`);
  // And as the scene has it again.
  await page.getByRole("button", { name: "Change speed", exact: true }).click();
  await page.getByRole("button", { name: "As in the scene" }).click();
  await page.getByRole("row", { name: /^speed 0\.3 m\/s/ }).waitFor();
  assert.deepEqual(errors, []);
  console.log(`from \`run --web\` to the effect of a changed parameter: ${actions} actions, ${took_s.toFixed(1)} s by a script; ${before.toFixed(2)} m/s, then ${after.toFixed(2)} m/s`);
} finally {
  child.kill("SIGINT");
  await over;
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
