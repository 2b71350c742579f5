// The step rate of a session with viewers of all signals, bodies and 60 pictures a second, beside one without a page.
// `node e2e/rate.mjs PROGRAM SCENARIO [VIEWERS] [UNTIL] [ROUNDS] [never]` prints both, and their ratio, for each round, and the middle of
// the ratios; with `never`, of viewers that never read.

import { spawnSync } from "node:child_process";
import { begin } from "./pulpit.mjs";
import { look } from "./viewers.mjs";

const [program, scenario, viewers = "4", until = "40min", rounds = "3", reads = "always"] = process.argv.slice(2);
const words = ["run", scenario, "--pace", "max", "--until", until, "--format", "json"];

/** The report of a run that so many viewers see, and how many bytes they took. */
async function seen(count) {
  let bytes = 0;
  const received = reads === "never" ? null : (data) => (bytes += data.length);
  const session = await begin(program, [...words, "--web", "--await-viewer"], ["the session"]);
  const { host } = new URL(session.urls[0]);
  await Promise.all(Array.from({ length: count }, () => look(host, { received })));
  await session.over;
  return { ...JSON.parse(session.said.out), bytes };
}

const ratios = [];
for (let round = 1; round <= Number(rounds); round += 1) {
  const alone = JSON.parse(spawnSync(program, words, { encoding: "utf8" }).stdout);
  const watched = await seen(Number(viewers));
  if (alone.digest !== watched.digest) throw new Error(`${alone.digest} without viewers, ${watched.digest} with them`);
  const rate = ({ steps, wall_time_s }) => Math.round(steps / wall_time_s);
  ratios.push((100 * alone.wall_time_s) / watched.wall_time_s);
  const taken = (watched.bytes / 1e6 / watched.wall_time_s).toFixed(1);
  console.log(`round ${round}: ${rate(alone)} steps/s without a page, ${rate(watched)} with ${viewers} viewers (${taken} MB/s): ${ratios.at(-1).toFixed(1)} %`);
}
ratios.sort((a, b) => a - b);
console.log(`in the middle: ${ratios[Math.floor(ratios.length / 2)].toFixed(1)} %`);
