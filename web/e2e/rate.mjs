// The step rate of a session with viewers of all signals, bodies and 60 pictures a second, beside one without a page.
// `node e2e/rate.mjs PROGRAM SCENARIO [VIEWERS] [UNTIL] [ROUNDS] [never]` prints both, and their ratio, for each round, and the middle of
// the ratios; with `never`, of viewers that never read.

import { spawn } from "node:child_process";
import { look } from "./viewers.mjs";

const [program, scenario, viewers = "4", until = "40min", rounds = "3", reads = "always"] = process.argv.slice(2);

/** How long a run takes by its own report, s; with so many viewers, if any. */
async function run(count) {
  const child = spawn(program, ["run", scenario, "--pace", "max", "--until", until, "--format", "json", ...(count > 0 ? ["--web", "--await-viewer"] : [])],
    { stdio: ["ignore", "pipe", "pipe"] });
  let [said, out] = ["", ""];
  let bytes = 0;
  const heard = reads === "never" ? null : (data) => (bytes += data.length);
  child.stdout.on("data", (data) => (out += data));
  child.stderr.on("data", (data) => {
    const had = said.includes("the session is at");
    said += data;
    const line = /the session is at http:\/\/([^/\s]+)/.exec(said);
    if (!had && line !== null) for (let viewer = 0; viewer < count; viewer += 1) look(line[1], { heard });
  });
  await new Promise((ended) => child.on("exit", ended));
  const report = JSON.parse(out);
  return { wall_s: report.wall_time_s, steps: report.steps, digest: report.digest, bytes };
}

const ratios = [];
for (let round = 1; round <= Number(rounds); round += 1) {
  const [alone, seen] = [await run(0), await run(Number(viewers))];
  if (alone.digest !== seen.digest) throw new Error(`${alone.digest} without viewers, ${seen.digest} with them`);
  const rate = ({ steps, wall_s }) => Math.round(steps / wall_s);
  ratios.push((100 * alone.wall_s) / seen.wall_s);
  console.log(`round ${round}: ${rate(alone)} steps/s without a page, ${rate(seen)} with ${viewers} viewers (${(seen.bytes / 1e6 / seen.wall_s).toFixed(1)} MB/s): ${ratios.at(-1).toFixed(1)} %`);
}
ratios.sort((a, b) => a - b);
console.log(`in the middle: ${ratios[Math.floor(ratios.length / 2)].toFixed(1)} %`);
