// The memory of a session with a viewer that asks for everything and never reads.
// `node e2e/idle.mjs PROGRAM SCENARIO [SECONDS] [WORDS...]` prints the resident memory once a second, in MiB (Linux).

import { readFile } from "node:fs/promises";
import { begin } from "./pulpit.mjs";
import { look } from "./viewers.mjs";

const [program, scenario, seconds = "20", ...words] = process.argv.slice(2);
const { child, urls } = await begin(program, ["run", scenario, "--web", "--pace", "max", "--until", "1000h", ...words], ["the session"]);
const { host } = new URL(urls[0]);
for (let viewer = 0; viewer < 4; viewer += 1) await look(host, { variables: 500 });
for (let second = 0; second < Number(seconds); second += 1) {
  await new Promise((later) => setTimeout(later, 1000));
  const status = await readFile(`/proc/${child.pid}/status`, "utf8");
  console.log(second + 1, (Number(/VmRSS:\s+(\d+)/.exec(status)[1]) / 1024).toFixed(1));
}
child.kill();
process.exit(0);
