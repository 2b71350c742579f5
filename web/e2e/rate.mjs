// The step rate of a session with viewers of all signals, bodies and 60 pictures a second, beside one without a page.
// `node e2e/rate.mjs PROGRAM SCENARIO [VIEWERS] [UNTIL] [ROUNDS] [WORDS...]` prints both, and their ratio, for each round.

import { spawn } from "node:child_process";
import { connect } from "node:net";

const [program, scenario, viewers = "4", until = "40min", rounds = "3", ...words] = process.argv.slice(2);

/** A text as a client's frame, masked with zeros. */
function frame(text) {
  const body = Buffer.from(text);
  const head = Buffer.alloc(8);
  head[0] = 0x81;
  head[1] = 0x80 | 126;
  head.writeUInt16BE(body.length, 2);
  return Buffer.concat([head, body]);
}

/** A viewer that asks for all signals and throws away what it is shown; counts the bytes. */
async function look(host, read) {
  const { port, hostname } = new URL(`http://${host}`);
  const structure = await (await fetch(`http://${host}/api/session`)).json();
  const socket = connect(Number(port), hostname);
  socket.write(`GET /api/live HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n`);
  socket.write(frame(JSON.stringify({ type: "subscribe", signals: structure.signals.map((_, index) => index) }).padEnd(200)));
  socket.on("data", (data) => (read.bytes += data.length));
  socket.on("error", () => {});
}

/** How long a run takes by its own report, s; with so many viewers, if any. */
async function run(count) {
  const child = spawn(program, ["run", scenario, "--pace", "max", "--until", until, "--format", "json", ...words, ...(count > 0 ? ["--web", "--await-viewer"] : [])],
    { stdio: ["ignore", "pipe", "pipe"] });
  let [said, out] = ["", ""];
  const read = { bytes: 0 };
  child.stdout.on("data", (data) => (out += data));
  child.stderr.on("data", (data) => {
    const had = said.includes("the session is at");
    said += data;
    const line = /the session is at http:\/\/([^/\s]+)/.exec(said);
    if (!had && line !== null) for (let viewer = 0; viewer < count; viewer += 1) look(line[1], read);
  });
  await new Promise((ended) => child.on("exit", ended));
  const report = JSON.parse(out);
  return { wall_s: report.wall_time_s, steps: report.steps, digest: report.digest, bytes: read.bytes };
}

for (let round = 1; round <= Number(rounds); round += 1) {
  const [alone, seen] = [await run(0), await run(Number(viewers))];
  if (alone.digest !== seen.digest) throw new Error(`${alone.digest} without viewers, ${seen.digest} with them`);
  const rate = ({ steps, wall_s }) => Math.round(steps / wall_s);
  console.log(`round ${round}: ${rate(alone)} steps/s without a page, ${rate(seen)} with ${viewers} viewers (${(seen.bytes / 1e6 / seen.wall_s).toFixed(1)} MB/s): ${(100 * alone.wall_s / seen.wall_s).toFixed(1)} %`);
}
