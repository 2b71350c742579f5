// What scripts do at the panels of a session that the program serves: begin it, open its pages, sit down, press, wait.

import { spawn } from "node:child_process";
import { chromium } from "playwright-core";

/** A Chromium without a screen. */
export const browse = () => chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

/** A command that serves pages, each called as it is announced: `the session`, `trainee's page`. */
export async function begin(program, words, called) {
  const child = spawn(program, words, { stdio: ["ignore", "pipe", "pipe"] });
  const said = { out: "", err: "" };
  child.stdout.on("data", (data) => (said.out += data));
  const over = new Promise((ended) => child.on("exit", (code) => ended(code)));
  const urls = await new Promise((found, lost) => {
    child.stderr.on("data", (data) => {
      said.err += data;
      const lines = called.map((name) => new RegExp(`${name} is at (http:\\S+)`).exec(said.err)?.[1]);
      if (lines.every((line) => line !== undefined)) found(lines);
    });
    child.on("exit", () => lost(new Error(`no pages: ${said.err}`)));
  });
  return { child, said, over, urls };
}

/** A page, once it has shown some steps, and what went wrong on it. */
export async function open(browser, url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.waitForFunction(() => window.onescan?.picture().step > 5);
  return { page, errors };
}

export const panel = (page, name) => page.getByRole("region", { name: `Panel ${name}` });

/** Takes the seat of a panel. */
export async function sit(page, name) {
  await panel(page, name).getByRole("button", { name: "Take seat" }).click();
  await panel(page, name).getByRole("button", { name: "Leave seat" }).waitFor();
}

/** Until the signals of the page are so: each a name, `=`, `<` or `>`, and a value. */
export async function until(page, ...conditions) {
  const hold = (all) => all.every(([name, relation, value]) => {
    const shown = window.onescan.value(name);
    return shown !== null && (relation === "=" ? shown === value : relation === "<" ? shown < value : shown > value);
  });
  await page.waitForFunction(hold, conditions, { timeout: 120_000 });
}

/** Holds a button of the pulpit down until a signal shows it. */
export async function press(page, label, signal) {
  const key = panel(page, "pulpit").getByRole("button", { name: label, exact: true });
  await key.focus();
  await page.keyboard.down("Space");
  await until(page, [signal, "=", 1]);
  await page.keyboard.up("Space");
  await until(page, [signal, "=", 0]);
}

/** Turns a switch of a panel, and waits until it shows that. */
export async function turn(page, name, label, on) {
  const key = panel(page, name).getByRole("switch", { name: new RegExp(`^${label}`) });
  await key.click();
  await key.and(page.locator(`[aria-checked=${on}]`)).waitFor();
}
