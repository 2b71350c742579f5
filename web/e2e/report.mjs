// A report in a browser, from its file alone: pictures become charts that are read by a cursor and enlarged.
// `node e2e/report.mjs PROGRAM SCENARIOS [FOLDER]` writes its picture to FOLDER.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [program, scenarios, folder = null] = process.argv.slice(2);
const room = await mkdtemp(join(tmpdir(), "report-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"],
});
try {
  const file = join(room, "report.html");
  const run = spawnSync(program, ["run", join(scenarios, "shear"), "--until", "4s", "--runs", "2", "--html", file]);
  assert.equal(run.status, 0, String(run.stderr));
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  const [errors, loaded] = [[], []];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => loaded.push(request.url()));
  await page.goto(`file://${file}`);
  const chart = page.getByRole("figure", { name: "trajectories" });
  await chart.locator(".chart-lane canvas").first().waitFor();
  const heads = await chart.locator(".chart-head").count();
  const panels = await chart.evaluate((figure) => JSON.parse(figure.querySelector("script").text).panels.length);
  assert.equal(heads, panels);
  assert.equal(await page.locator("figure.charted").count(), await page.locator("figure > script").count(), "each that has data");
  assert.ok(await chart.locator("> svg").first().isHidden(), "the chart stands in the picture's place");

  // The reading under the pointer is the sample of the data.
  const lane = chart.locator(".chart-lane .u-over").first();
  await lane.scrollIntoViewIfNeeded();
  const box = await lane.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => document.querySelector(".charted .chart-tools output").textContent.endsWith(" s"));
  const [t_s, reading] = await chart.evaluate((figure) => [
    parseFloat(figure.querySelector(".chart-tools output").textContent), figure.querySelector(".chart-head output").textContent,
  ]);
  assert.ok(Math.abs(t_s - 2) < 0.05, `${t_s}`);
  const bounds = await chart.evaluate((figure, at_s) => {
    const { t_ns, values } = JSON.parse(figure.querySelector("script").text).panels[0].runs[0];
    const after = t_ns.findIndex((one) => one / 1e9 > at_s);
    return [values[after - 1], values[after]].sort((a, b) => a - b);
  }, t_s);
  assert.ok(parseFloat(reading) >= bounds[0] - 1e-3 && parseFloat(reading) <= bounds[1] + 1e-3, `${reading} in ${bounds}`);

  // Dragged over, all lanes are enlarged; *Whole* shows all again.
  await page.mouse.move(box.x + box.width * 0.25, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 20, { steps: 5 });
  await page.mouse.up();
  await page.mouse.move(box.x + box.width - 2, box.y + 20);
  const read = () => chart.locator(".chart-tools output").textContent().then((text) => parseFloat(text));
  await page.waitForFunction(() => parseFloat(document.querySelector(".charted .chart-tools output").textContent) < 2.1);
  if (folder !== null) await page.screenshot({ path: `${folder}/report.png` });
  await chart.getByRole("button", { name: "Whole" }).click();
  await page.mouse.move(box.x + box.width - 3, box.y + 20);
  await page.waitForFunction(() => parseFloat(document.querySelector(".charted .chart-tools output").textContent) > 3.9);
  assert.ok((await read()) <= 4.01);
  await page.emulateMedia({ media: "print" });
  assert.ok(await chart.locator("> svg").first().isVisible(), "paper has the picture");
  assert.deepEqual(errors, []);
  assert.deepEqual(loaded, [`file://${file}`], "nothing is loaded from elsewhere");
  console.log("a report's charts: ok");
} finally {
  await browser.close();
  await rm(room, { recursive: true, force: true });
}
