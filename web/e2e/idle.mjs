// The memory of a session with a viewer that asks for everything and never reads.
// `node e2e/idle.mjs PROGRAM SCENARIO [SECONDS] [WORDS...]` prints the resident memory once a second, in MiB (Linux).

import { spawn } from "node:child_process";
import { readFile } from "node:fs/promises";
import { look } from "./viewers.mjs";

const [program, scenario, seconds = "20", ...words] = process.argv.slice(2);
const child = spawn(program, ["run", scenario, "--web", "--pace", "max", "--until", "1000h", ...words], { stdio: ["ignore", "ignore", "pipe"] });
let said = "";
const { host } = new URL(await new Promise((found, lost) => {
  child.stderr.on("data", (data) => {
    said += data;
    const line = /the session is at (http:\S+)/.exec(said);
    if (line !== null) found(line[1]);
  });
  child.on("exit", () => lost(new Error(said)));
}));

for (let viewer = 0; viewer < 4; viewer += 1) await look(host, { variables: 500 });
for (let second = 0; second < Number(seconds); second += 1) {
  await new Promise((later) => setTimeout(later, 1000));
  const status = await readFile(`/proc/${child.pid}/status`, "utf8");
  console.log(second + 1, (Number(/VmRSS:\s+(\d+)/.exec(status)[1]) / 1024).toFixed(1));
}
child.kill();
process.exit(0);
