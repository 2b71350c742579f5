import assert from "node:assert/strict";
import { test } from "node:test";
import { camera_for, corners, framed, gaze_from, seen_at, together, type Room, type Standing } from "../src/framing";
import type { Vec3 } from "../src/session";

const box = (middle: Vec3, size: Vec3, works = false): Standing => ({
  low: [middle[0] - size[0] / 2, middle[1] - size[1] / 2, middle[2] - size[2] / 2],
  high: [middle[0] + size[0] / 2, middle[1] + size[1] / 2, middle[2] + size[2] / 2],
  works,
});
const HALF = Math.tan(Math.PI / 8);
const GAZE = gaze_from([0.55, -0.95, 0.65]);

/** The machines of scenarios that were framed wrongly, and two of one direction only. */
const MACHINES: Readonly<Record<string, readonly Standing[]>> = {
  shear: [box([0, 0, 2], [3, 0.4, 0.3]), box([-1, 0, 1.55], [0.12, 0.12, 0.6], true), box([0, 0, 1.15], [2.2, 0.06, 0.3], true)],
  gantry: [box([1, 0, 2], [2.6, 0.2, 0.2]), box([0.2, 0.2, 2], [0.3, 0.3, 0.3], true), box([0.2, 0.3, 1.6], [0.1, 0.1, 1.4], true)],
  tower: [box([0, 0, 10], [1, 1, 20])],
  kiln: [box([30, 0, 8], [60, 4, 4])],
};
const PANES: readonly (readonly [number, number])[] = [[812, 380], [1216, 640], [756, 440], [380, 360]];

for (const [name, bodies] of Object.entries(MACHINES)) {
  for (const [width, height] of PANES) {
    test(`the ${name} fills a pane of ${width} by ${height} and nothing of it is cut`, () => {
      const points = bodies.flatMap(corners);
      const aspect = width / height;
      const camera = camera_for(points, GAZE, HALF, aspect);
      const seen = points.map((point) => seen_at(point, camera, GAZE, HALF, aspect) ?? assert.fail("behind the camera"));
      const reach = [0, 1].map((axis) => seen.map((at) => at[axis] as number)).map((all) => [Math.min(...all), Math.max(...all)] as const);
      for (const [low, high] of reach) {
        assert.ok(low >= -0.9201 && high <= 0.9201, `${low} to ${high}`);
        assert.ok(Math.abs(low + high) < 0.9, `not in the middle: ${low} to ${high}`);
      }
      assert.ok(Math.max(...reach.map(([low, high]) => high - low)) > 1.8, "it is as large as it can be");
    });
  }
}

test("a floor is flat, wide and lowest; what only is large is part of the machine", () => {
  const machine = [box([0, 0, 1], [2, 1, 1], true), box([0, 0, 2.5], [6, 0.4, 0.4])];
  const floor = box([0, 0, -0.1], [30, 20, 0.2]);
  assert.deepEqual(framed([floor, ...machine]), [1, 2]);
  assert.deepEqual(framed(machine), [0, 1]);
  // A roof is flat and wide, but above.
  assert.deepEqual(framed([...machine, box([0, 0, 4], [30, 20, 0.2])]), [0, 1, 2]);
  // A belt carries what is on it, and belongs to the machine.
  assert.deepEqual(framed([box([0, 0, 0], [2, 0.5, 0.05], true), box([0, 0, 0.1], [0.1, 0.1, 0.1], true)]), [0, 1]);
  // A table below a small part is narrow beside the rest.
  assert.deepEqual(framed([box([0, 0, 0], [0.5, 0.4, 0.02]), box([1, 1, 1], [0.3, 0.3, 2], true), box([0, 0, 1], [0.3, 0.3, 2], true)]), [0, 1, 2]);
  assert.deepEqual(framed([floor]), [0]);
});

test("the room of nothing is nothing", () => {
  assert.equal(together([]), null);
  const one: Room = box([1, 2, 3], [2, 2, 2]);
  assert.deepEqual(together([one]), { low: [0, 1, 2], high: [2, 3, 4] });
});

test("many bodies are framed, more than a call has arguments", () => {
  const rooms = Array.from({ length: 300_000 }, (_, index): Room => ({ low: [index, 0, 0], high: [index + 1, 1, 1] }));
  assert.deepEqual(together(rooms), { low: [0, 0, 0], high: [300_000, 1, 1] });
});
