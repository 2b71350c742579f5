// The memory of a session with a viewer that asks for everything and never reads.
// `node e2e/idle.mjs PROGRAM SCENARIO [SECONDS] [WORDS...]` prints the resident memory once a second, in MiB (Linux).

import { spawn } from "node:child_process";
import { readFile } from "node:fs/promises";
import { connect } from "node:net";

const [program, scenario, seconds = "20", ...words] = process.argv.slice(2);
const child = spawn(program, ["run", scenario, "--web", "--pace", "max", "--until", "1000h", ...words], { stdio: ["ignore", "ignore", "pipe"] });
let said = "";
const { hostname, port, host } = new URL(await new Promise((found, lost) => {
  child.stderr.on("data", (data) => {
    said += data;
    const line = /the session is at (http:\S+)/.exec(said);
    if (line !== null) found(line[1]);
  });
  child.on("exit", () => lost(new Error(said)));
}));

/** A text as a client's frame, masked with zeros. */
function frame(text) {
  const body = Buffer.from(text);
  const head = Buffer.alloc(8);
  head[0] = 0x81;
  head[1] = 0x80 | 126;
  head.writeUInt16BE(body.length, 2);
  return Buffer.concat([head, body]);
}

const structure = await (await fetch(`http://${host}/api/session`)).json();
for (let viewer = 0; viewer < 4; viewer += 1) {
  const socket = connect(Number(port), hostname);
  socket.pause();
  socket.write(`GET /api/live HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n`);
  const ask = (what) => socket.write(frame(JSON.stringify(what).padEnd(200)));
  ask({ type: "subscribe", signals: structure.signals.map((_, index) => index) });
  ask({ type: "watch", variables: (structure.plcs[0]?.variables ?? []).slice(0, 500).map((_, index) => index) });
  socket.on("error", () => {});
}
for (let second = 0; second < Number(seconds); second += 1) {
  await new Promise((later) => setTimeout(later, 1000));
  const status = await readFile(`/proc/${child.pid}/status`, "utf8");
  console.log(second + 1, (Number(/VmRSS:\s+(\d+)/.exec(status)[1]) / 1024).toFixed(1));
}
child.kill();
process.exit(0);
