// The page in a real Chromium, before a session that stands in for the server.
// `node e2e/page.mjs [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { chromium } from "playwright-core";
import { SIZES, sees_whole } from "./sight.mjs";
import { place, serve } from "./stand-in.mjs";

const folder = process.argv[2] ?? null;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

async function open(session, options) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(session.url);
  await page.waitForFunction(() => window.onescan?.picture().step > 5);
  return { page, errors };
}

async function shoot(page, name) {
  if (folder !== null) await page.screenshot({ path: `${folder}/${name}.png` });
}

async function operate_the_desk() {
  const session = await serve();
  const { page, errors } = await open(session, { colorScheme: "light" });
  const start = page.getByRole("button", { name: "Start", exact: true });
  assert.ok(await start.isDisabled(), "without the seat nothing is written");
  await page.getByRole("button", { name: "Take seat" }).click();
  await page.getByRole("button", { name: "Leave seat" }).waitFor();
  await start.focus();
  await page.keyboard.down("Space");
  await page.waitForFunction(() => window.onescan.value("Start") === 1);
  await page.keyboard.up("Space");
  await page.waitForFunction(() => window.onescan.value("Start") === 0);
  assert.deepEqual(session.asked.filter((ask) => ask.type === "write").map((ask) => ask.value), [1, 0]);
  await shoot(page, "light-1280x720");

  // Positions that the page has are those of the step that it shows.
  await page.getByRole("button", { name: "Hold" }).click();
  await page.waitForFunction((step) => window.onescan.picture().step === step, session.state.step);
  for (let index = 0; index < 8; index += 1) {
    const read = await page.evaluate((name) => window.onescan.position_m(name), `package[${index}]`);
    assert.deepEqual(read, place(index, session.state.step, 8).map(Math.fround), `package[${index}]`);
  }

  // The timeline shows a moment of the past, and goes back to the live edge.
  const timeline = page.getByRole("slider", { name: "Time that is shown" });
  await timeline.fill("3");
  await page.waitForFunction(() => window.onescan.picture().isPast && window.onescan.picture().step === 3);
  await page.getByRole("button", { name: "Live" }).click();
  await page.waitForFunction(() => !window.onescan.picture().isPast);

  // Garbage is reported, and the page goes on; so it does after a loss.
  session.say("{");
  await page.getByText("cannot be read and is left out").waitFor();
  session.say(Buffer.from([9, 9, 9]));
  session.cut();
  await page.locator("#link.lost, #link.connecting").waitFor();
  await page.locator("#link.connected").waitFor();
  await page.getByRole("button", { name: "Go", exact: true }).click();
  const before = session.state.step;
  await page.waitForFunction((step) => window.onescan.picture().step > step, before);

  // The keyboard goes through the sheets.
  await page.getByRole("tab", { name: "Panels" }).focus();
  for (const name of ["Part", "Signals", "PLC"]) {
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.getByRole("tab", { name }).getAttribute("aria-selected"), "true");
  }
  await page.getByText("Belt_On = TRUE").waitFor();
  await page.getByRole("button", { name: "Dark or light" }).click();
  await shoot(page, "dark-plc-1280x720");
  await page.setViewportSize({ width: 900, height: 1200 });
  await page.getByRole("tab", { name: "Panels" }).click();
  await shoot(page, "dark-900");
  assert.deepEqual(errors, []);
  await page.close();
  await session.close();
}

/** The opening picture and *Whole* show the machine without its floor, at every size and as the pane changes. */
async function frame_the_machine() {
  const session = await serve({ more: { views: [] } });
  for (const [width, height] of SIZES) {
    const { page, errors } = await open(session, { viewport: { width, height } });
    await sees_whole(page, `opened at ${width}x${height}`);
    const floor = await page.evaluate(() => window.onescan.sight().bodies.find((one) => one.name === "floor"));
    assert.equal(floor.isFramed, false);
    assert.deepEqual(errors, []);
    await page.close();
  }
  const { page } = await open(session, {});
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    await sees_whole(page, `turned to ${width}x${height}`);
  }
  await page.setViewportSize({ width: 1280, height: 720 });
  await page.mouse.move(300, 300);
  await page.mouse.wheel(0, -600);
  await page.waitForTimeout(100);
  await assert.rejects(sees_whole(page, "near"), /cut|behind/);
  await page.getByRole("button", { name: "Whole" }).click();
  await sees_whole(page, "Whole");
  await shoot(page, "whole");
  await page.close();
  await session.close();
  // A scenario's first view is the opening one.
  const viewed = await serve();
  const { page: other } = await open(viewed, {});
  assert.equal(await other.getByRole("button", { name: "front", exact: true }).getAttribute("aria-pressed"), "true");
  await other.close();
  await viewed.close();
}

async function draw_many() {
  const session = await serve({ packages: 300 });
  const { page, errors } = await open(session, {});
  const rate = await page.evaluate(async () => {
    const from = window.onescan.drawn();
    const start = performance.now();
    await new Promise((done) => setTimeout(done, 3000));
    return ((window.onescan.drawn() - from) * 1000) / (performance.now() - start);
  });
  console.log(`300 bodies: ${rate.toFixed(1)} pictures a second`);
  await shoot(page, "many");
  assert.deepEqual(errors, []);
  await page.close();
  await session.close();
}

try {
  await operate_the_desk();
  await frame_the_machine();
  await draw_many();
  console.log("page: ok");
} finally {
  await browser.close();
}
