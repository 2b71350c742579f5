// Viewers over bare sockets, for measurements: they cost the machine less than a browser, so that what is measured is the session.

import { connect } from "node:net";

/** A text as a client's frame, masked with zeros. */
function frame(text) {
  const body = Buffer.from(text);
  const head = Buffer.alloc(8);
  head[0] = 0x81;
  head[1] = 0x80 | 126;
  head.writeUInt16BE(body.length, 2);
  return Buffer.concat([head, body]);
}

/** A viewer of all signals and of so many variables. What it is shown goes to `received`; it never reads without one. */
export async function look(host, { variables = 0, received = null } = {}) {
  const { hostname, port } = new URL(`http://${host}`);
  const structure = await (await fetch(`http://${host}/api/session`)).json();
  const socket = connect(Number(port), hostname);
  if (received === null) socket.pause();
  else socket.on("data", received);
  socket.on("error", () => {});
  socket.write(`GET /api/live HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n`);
  const ask = (what) => socket.write(frame(JSON.stringify(what).padEnd(200)));
  ask({ type: "subscribe", signals: structure.signals.map((_, index) => index) });
  if (variables > 0) ask({ type: "watch", variables: (structure.plcs[0]?.variables ?? []).slice(0, variables).map((_, index) => index) });
}
