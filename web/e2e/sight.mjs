// What is in sight of the machine: computed from where the page draws it, not from pixels.

import assert from "node:assert/strict";

export const SIZES = [[1280, 720], [1920, 1080], [768, 1024], [390, 844]];

/** The bodies that are framed lie in the free part of the pane, and fill it from one side to the other. */
export async function sees_whole(page, what) {
  // A pane that has changed is drawn again at the next picture.
  await page.waitForTimeout(150);
  const { free, bodies } = await page.evaluate(() => window.onescan.sight());
  const machine = bodies.filter((one) => one.isFramed);
  assert.ok(machine.length > 0, `${what}: nothing is framed`);
  for (const { name, box } of machine) {
    assert.ok(box !== null, `${what}: ${name} is behind the camera`);
    const isInside = box[0] >= free[0] - 1 && box[1] >= free[1] - 1 && box[2] <= free[2] + 1 && box[3] <= free[3] + 1;
    assert.ok(isInside, `${what}: ${name} is cut: ${box} in ${free}`);
  }
  const reach = (side, of) => of(...machine.map(({ box }) => box[side]));
  const [left, top] = [reach(0, Math.min), reach(1, Math.min)];
  const filled = [(reach(2, Math.max) - left) / (free[2] - free[0]), (reach(3, Math.max) - top) / (free[3] - free[1])];
  assert.ok(Math.max(...filled) > 0.8, `${what}: the machine fills only ${filled.map((share) => share.toFixed(2))} of the pane`);
}
