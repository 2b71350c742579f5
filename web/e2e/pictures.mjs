// Pictures of all scenarios at four sizes and in two themes, held by what is in sight; those of machines to learn on at the first and
// the last of the sizes, and at all four where pictures are wanted.
// `node e2e/pictures.mjs PROGRAM SCENARIOS [FOLDER]` writes them to FOLDER.

import assert from "node:assert/strict";
import { readdir } from "node:fs/promises";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { begin, browse } from "./pulpit.mjs";
import { SIZES, sees_whole } from "./sight.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const browser = await browse();

async function look_at(name, sizes = SIZES) {
  const { child, urls } = await begin(program, ["run", join(scenarios, name), "--until", "1h", "--pace", "1", "--web"], ["the session"]);
  try {
    for (const [width, height] of sizes) {
      const page = await browser.newPage({ viewport: { width, height }, colorScheme: "light" });
      const errors = [];
      page.on("pageerror", (error) => errors.push(String(error.stack ?? error)));
      await page.goto(urls[0]);
      await page.waitForFunction(() => window.onescan?.drawn() > 0 && window.onescan.picture().step > 5);
      for (const theme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme: theme });
        await page.waitForTimeout(400);
        if (folder !== null) await page.screenshot({ path: join(folder, `${name.replaceAll("/", "-")}-${width}x${height}-${theme}.png`) });
      }
      const bodies = await page.evaluate(() => window.onescan.sight().bodies.length);
      if (bodies > 0) {
        // Machines are moving: what has come meanwhile is framed by the key.
        // One that moves on before it is measured is framed once more.
        for (let turn = 0; ; turn += 1) {
          await page.getByRole("button", { name: "Whole" }).click();
          try {
            await sees_whole(page, `${name} at ${width}x${height}`);
            break;
          } catch (error) {
            if (turn >= 3) throw error;
          }
        }
      }
      assert.deepEqual(errors, []);
      await page.close();
    }
  } finally {
    child.kill();
  }
  console.log(`${name}: ok`);
}

try {
  const machines = async (at) => (await readdir(join(scenarios, at))).sort().map((name) => join(at, name)).filter((name) => existsSync(join(scenarios, name, "scenario.toml")));
  for (const name of await machines(".")) await look_at(name);
  for (const name of await machines("learn")) await look_at(name, folder === null ? [SIZES.at(0), SIZES.at(-1)] : SIZES);
} finally {
  await browser.close();
}
