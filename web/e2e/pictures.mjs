// Pictures of all scenarios at four sizes and in two themes, held by what is in sight.
// `node e2e/pictures.mjs PROGRAM SCENARIOS [FOLDER]` writes them to FOLDER.

import assert from "node:assert/strict";
import { readdir } from "node:fs/promises";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { begin, browse } from "./pulpit.mjs";
import { SIZES, sees_whole } from "./sight.mjs";

const [program, scenarios, folder = null] = process.argv.slice(2);
const browser = await browse();

async function look_at(name) {
  const { child, urls } = await begin(program, ["run", join(scenarios, name), "--until", "1h", "--pace", "1", "--web"], ["the session"]);
  try {
    for (const [width, height] of SIZES) {
      const page = await browser.newPage({ viewport: { width, height }, colorScheme: "light" });
      const errors = [];
      page.on("pageerror", (error) => errors.push(String(error.stack ?? error)));
      await page.goto(urls[0]);
      await page.waitForFunction(() => window.onescan?.drawn() > 0 && window.onescan.picture().step > 5);
      for (const theme of ["light", "dark"]) {
        await page.emulateMedia({ colorScheme: theme });
        await page.waitForTimeout(400);
        if (folder !== null) await page.screenshot({ path: join(folder, `${name}-${width}x${height}-${theme}.png`) });
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
  for (const name of (await readdir(scenarios)).sort()) if (existsSync(join(scenarios, name, "scenario.toml"))) await look_at(name);
} finally {
  await browser.close();
}
