import assert from "node:assert/strict";
import { test } from "node:test";
import { Tracks, slerp } from "../src/interpolation";
import type { Quaternion } from "../src/session";

const STILL: Quaternion = [0, 0, 0, 1];
const about_z = (angle: number): Quaternion => [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];

test("half a turn's half is a quarter turn, whatever the signs", () => {
  const to = about_z(Math.PI / 2);
  const negative = to.map((one) => -one) as unknown as Quaternion;
  for (const end of [to, negative]) {
    const half = slerp(STILL, end, 0.5);
    about_z(Math.PI / 4).forEach((one, axis) => assert.ok(Math.abs(one - (half[axis] as number)) < 1e-12));
  }
});

test("a body is drawn on its way and stops at the last picture", () => {
  const tracks = new Tracks();
  tracks.arrive({ body: 3, place: { position_m: [0, 0, 0], rotation: STILL } }, 0);
  tracks.arrive({ body: 3, place: { position_m: [0.2, 0, 0], rotation: STILL } }, 20);
  assert.equal(tracks.drawn(3, 30)?.position_m[0], 0.1);
  assert.equal(tracks.drawn(3, 900)?.position_m[0], 0.2);
  assert.equal(tracks.exact(3)?.position_m[0], 0.2);
});

test("a body that comes, goes or is put elsewhere is not drawn on its way", () => {
  const tracks = new Tracks();
  tracks.arrive({ body: 0, place: { position_m: [0, 0, 0], rotation: STILL } }, 0);
  tracks.arrive({ body: 0, place: { position_m: [5, 0, 0], rotation: STILL } }, 20);
  assert.equal(tracks.drawn(0, 21)?.position_m[0], 5);
  tracks.arrive({ body: 0, place: null }, 40);
  assert.equal(tracks.drawn(0, 41), null);
  assert.equal(tracks.drawn(1, 41), undefined);
});
