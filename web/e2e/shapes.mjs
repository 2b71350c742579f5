// The shapes of components in a Chromium: what stands by itself, on a machine and without one, and what follows its signals.
// `node e2e/shapes.mjs [FOLDER]` writes its pictures to FOLDER.

import assert from "node:assert/strict";
import { browse } from "./pulpit.mjs";
import { sees_whole } from "./sight.mjs";
import { serve, structure } from "./stand-in.mjs";

const folder = process.argv[2] ?? null;
const browser = await browse();

const component = (name, kind, point_m, pins, parameters = []) => ({
  name, kind, body: null, senses: null, signals: pins.map(([, signal]) => signal), failures: [], pins, place: { point_m },
  parameters: parameters.map(([key, value, unit]) => ({ name: key.replace(/_\w+$/, ""), key, value, unit, type: "LREAL" })),
});
const STANDING = [
  component("tank", "tank", [-3.2, 0.3, 0], [["level_m", "Speed"]], [["area_m2", "0.4", "m²"], ["height_m", "1.2", "m"], ["initial_m", "0.3", "m"]]),
  component("green_lamp", "lamp", [2.4, 0.4, 1.1], [["on", "Belt_On"]]),
  component("yellow_lamp", "lamp", [2.4, 0.4, 1.17], [["on", "Eye"]]),
  component("red_lamp", "lamp", [2.4, 0.4, 1.24], [["on", "Start"]]),
  component("start", "push_button", [1.2, -0.7, 0.9], [["make", "Start"]]),
  component("stop_all", "emergency_stop", [1.45, -0.7, 0.9], [["hit", "Start"]]),
  component("oven", "heater", [2.9, -0.4, 0.6], [["temperature_degc", "Setpoint"]]),
  component("tower", "stack_light", [1.9, 0.5, 1.1], [["red", "Start"], ["green", "Belt_On"]]),
  component("mode", "key_switch", [1.7, -0.7, 0.9], [["at_1", "Belt_On"]]),
  component("hands", "two_hand_station", [0.6, -0.9, 0.9], [["left", "Start"], ["valid", "Belt_On"]]),
  component("codes", "barcode_reader", [0.2, 0.4, 1.2], [["good", "Eye"]]),
  component("tags", "rfid_head", [-0.3, 0.4, 1.0], [["present", "Eye"]]),
  component("weight", "weighing_cell", [-1.2, -0.7, 0.9], [["stable", "Belt_On"]]),
  component("oil", "hydraulic_unit", [-2.2, 0.9, 0], [["pump", "Belt_On"]]),
];
// A glowing block: the stand-in's set point is its temperature.
const { components } = structure(8);

async function look(name, more, changes = () => {}) {
  const session = await serve({ packages: 8, more });
  changes(session);
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "light" });
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error.stack)));
  await page.goto(session.url);
  await page.waitForFunction(() => window.onescan?.picture().step > 5 && window.onescan.drawn() > 0);
  await page.getByRole("button", { name: "Whole" }).click();
  await sees_whole(page, name);
  await page.waitForTimeout(1500);
  if (folder !== null) await page.screenshot({ path: `${folder}/${name}.png` });
  const { bodies } = await page.evaluate(() => window.onescan.sight());
  for (const { name: one } of STANDING) assert.ok(bodies.some((body) => body.name === one && body.isFramed), one);
  // One that no body stands for is chosen from the list, without a mouse.
  await page.getByRole("tab", { name: "Part" }).click();
  await page.getByRole("listbox", { name: "Part" }).selectOption({ label: "tank (tank)" });
  await page.getByRole("heading", { name: "tank (tank)" }).waitFor();
  assert.deepEqual(errors, []);
  await page.close();
  await session.close();
}

try {
  await look("shapes-machine", { components: [...components, ...STANDING], views: [] }, (session) => {
    [session.state.start, session.state.setpoint] = [1, 1050];
  });
  await look("shapes-alone", { bodies: [], components: STANDING, views: [] }, (session) => (session.state.setpoint = 800));
  console.log("shapes of components: seen, and followed");
} finally {
  await browser.close();
}
