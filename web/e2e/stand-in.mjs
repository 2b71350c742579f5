// A session that stands in for the server in the tests of the page: a belt with packages, a light barrier, a desk.
// It keeps what the page asks, so that a test can read it.

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { WebSocketServer } from "ws";

const STEP_NS = 10_000_000;
const TYPES = { "index.html": "text/html", "page.js": "text/javascript", "page.css": "text/css" };
const SIGNALS = [
  ["Start", "BOOL", "operator", null], ["Belt_On", "BOOL", "plc", null], ["Eye", "BOOL", "plant", null],
  ["Speed", "LREAL", "plant", "m/s"], ["Count", "DINT", "plant", null], ["Setpoint", "LREAL", "operator", "m/s"],
];

/** A structure with `packages` packages on a belt of 4 m. */
export function structure(packages, more = {}) {
  const box = (name, kind, size_m, position_m, colour) =>
    ({ name, kind, shape: { kind: "box", size_m }, colour, position_m, rotation: [0, 0, 0, 1] });
  const bodies = [
    box("floor", "fixed", [14, 9, 0.1], [0, 0, -0.05], null),
    box("belt", "kinematic", [4, 0.5, 0.08], [0, 0, 0.8], "#5c656c"),
    ...[-1.8, 1.8].flatMap((x, side) => [-0.2, 0.2].map((y, at) => box(`leg[${2 * side + at}]`, "fixed", [0.06, 0.06, 0.76], [x, y, 0.38], null))),
    { name: "eye", kind: "fixed", shape: { kind: "cylinder", radius_m: 0.04, length_m: 0.3 }, colour: "#39424a", position_m: [0.8, -0.32, 0.98], rotation: [0, 0, 0, 1] },
    ...Array.from({ length: packages }, (_, index) => box(`package[${index}]`, "dynamic", [0.16, 0.2, 0.14], [-1.8, 0, 0.91], "#b88a54")),
  ];
  const element = (kind, label, signal, at, more = {}) => ({ kind, label, signal, at, span: [2, 1], ...more });
  return {
    protocol: 1, title: "Stand-in: a belt with packages", scenario: "stand-in", step_ns: STEP_NS, until_ns: null, live: true,
    signals: SIGNALS.map(([name, type, writer, unit]) => ({ name, type, writer, unit, about: "" })),
    bodies,
    components: [{
      name: "barrier", kind: "light_barrier", body: "eye", signals: ["Eye"], senses: "Eye",
      parameters: [{ name: "range", value: "0.6", unit: "m" }], failures: [{ name: "stuck" }],
      place: { point_m: [0.8, -0.3, 0.93], direction: [0, 1, 0] },
    }, {
      name: "conveyor", kind: "conveyor", body: null, signals: ["Belt_On", "Speed"], pins: [["run", "Belt_On"], ["velocity_m_s", "Speed"]], senses: null,
      parameters: [{ name: "speed", value: "0.5", unit: "m/s" }], failures: [], place: { direction: [1, 0, 0], moves: "belt" },
    }],
    looks: [], views: [{ name: "front", position_m: [0, -4, 1.6], target_m: [0, 0, 0.8] }],
    panels: [{
      name: "desk", seat: "operator", columns: 6, rows: 4,
      elements: [
        element("button", "Start", "Start", [0, 0], { colour: "#1d8a42" }), element("lamp", "Belt runs", "Belt_On", [2, 0], { colour: "#3fbf5f" }),
        element("lamp", "Eye sees", "Eye", [4, 0]), element("number", "Packages", "Count", [0, 1]),
        element("bar", "Speed", "Speed", [2, 1], { span: [4, 1] }), element("slider", "Setpoint", "Setpoint", [0, 2], { span: [6, 1] }),
      ],
    }],
    expectations: [{ name: "no package is lost", text: "always Count >= 0" }],
    sources: [{
      path: "plc/belt.st", text: "PROGRAM Belt\n  IF Start THEN\n    Belt_On := TRUE;\n  END_IF;\n  IF Eye THEN Count := Count + 1; END_IF;\nEND_PROGRAM\n",
      lines: [{ line: 2, variables: ["Start"] }, { line: 3, variables: ["Belt_On"] }, { line: 5, variables: ["Eye", "Count"] }],
    }],
    ...more,
  };
}

/** Where a package is at a step, in metres along the belt; packages after the tenth stand on others. */
export function place(index, step, packages) {
  const row = index % 10;
  const around = (((row * 0.38 + step * 0.005) % 3.8) + 3.8) % 3.8;
  return [around - 1.9, packages > 10 ? ((Math.floor(index / 10) % 6) - 2.5) * 0.22 : 0, 0.91 + Math.floor(index / 60) * 0.16];
}

/** The picture of a step, as the protocol has it. */
export function picture(step, { packages, first, values, isPast, isHeld }) {
  const data = Buffer.alloc(24 + values.length * 16 + packages * 32);
  data.writeUInt8(1, 0);
  data.writeUInt8((isHeld ? 1 : 0) | (isPast ? 2 : 0), 1);
  data.writeUInt16LE(values.length, 2);
  data.writeUInt32LE(packages, 4);
  data.writeBigUInt64LE(BigInt(step), 8);
  data.writeBigUInt64LE(BigInt(step) * BigInt(STEP_NS), 16);
  values.forEach(([signal, value], index) => {
    data.writeUInt32LE(signal, 24 + index * 16);
    data.writeDoubleLE(value, 32 + index * 16);
  });
  for (let index = 0; index < packages; index += 1) {
    const at = 24 + values.length * 16 + index * 32;
    data.writeUInt32LE(first + index, at);
    [...place(index, step, packages), 0, 0, 0, 1].forEach((one, axis) => data.writeFloatLE(one, at + 4 + axis * 4));
  }
  return data;
}

/** Serves the page in `dist` and a session, its structure with `more`; `asked` holds what pages asked, `say` speaks to all of them. */
export async function serve({ packages = 8, more = {} } = {}) {
  const session = structure(packages, more);
  const asked = [];
  const state = { step: 0, isHeld: false, seat: false, start: 0, setpoint: 0.5, forced: new Map(), changed: new Map() };
  // What each viewer looks at.
  const viewers = new Map();
  const http = createServer(async (request, answer) => {
    const name = request.url === "/" ? "index.html" : request.url.slice(1);
    if (name === "api/session") return answer.setHeader("content-type", "application/json").end(JSON.stringify(session));
    if (!(name in TYPES)) return answer.writeHead(404).end();
    answer.setHeader("content-type", TYPES[name]).setHeader("content-security-policy", "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:");
    return answer.end(await readFile(new URL(`../dist/${name}`, import.meta.url)));
  });
  const sockets = new WebSocketServer({ server: http, path: "/api/live" });
  const say = (what) => sockets.clients.forEach((one) => one.send(what));
  const status = () => viewers.forEach(({ shown }, socket) => socket.send(JSON.stringify({
    type: "status", state: state.isHeld ? "hold" : "run", digest: null, pace: "1", seat: { desk: state.seat ? "mine" : "free" },
    shown_ns: shown === null ? null : shown * STEP_NS, past_ns: [0, state.step * STEP_NS], forced: [...state.forced.keys()], changed: Object.fromEntries(state.changed),
  })));
  /** The values of all signals at a step. */
  const at = (step) => {
    const eye = Number(Array.from({ length: packages }, (_, index) => place(index, step, packages)[0]).some((x) => Math.abs(x - 0.8) < 0.1));
    return [state.start, 1, eye, 0.5 + 0.05 * Math.sin(step / 30), Math.floor(step / 76), state.setpoint];
  };
  const show = ({ shown, subscribed }, socket) => {
    const step = shown ?? state.step;
    const all = at(step);
    const values = subscribed.map((signal) => [signal, state.forced.get(signal) ?? all[signal]]);
    const many = session.bodies.length === 0 ? 0 : packages;
    socket.send(picture(step, { packages: many, first: session.bodies.length - many, values, isPast: shown !== null, isHeld: state.isHeld }));
  };
  // The alarms so far; a viewer that comes later reads all of them.
  const changes = [];
  const ring = (change) => {
    changes.push({ t_ns: state.step * STEP_NS, until_ns: null, ...change });
    say(JSON.stringify({ type: "alarms", all: false, changes: changes.slice(-1) }));
  };
  const handle = {
    subscribe: (ask, viewer) => (viewer.subscribed = ask.signals),
    seat: (ask) => (state.seat = ask.take),
    write: (ask) => (ask.signal === 0 ? (state.start = ask.value) : (state.setpoint = ask.value)),
    operate: (ask) => {
      state.isHeld = ask.operation !== "go";
      if (ask.operation === "step") state.step += 1;
    },
    show: (ask, viewer) => (viewer.shown = Math.round(ask.t_ns / STEP_NS)),
    live: (_, viewer) => (viewer.shown = null),
    force: (ask) => (ask.value === null ? state.forced.delete(ask.signal) : state.forced.set(ask.signal, ask.value === "TRUE" ? 1 : Number(ask.value))),
    acknowledge: (ask) => ask.alarms.forEach((alarm) => ring({ alarm, fate: "acknowledged" })),
    shelve: (ask) => ring({ alarm: ask.alarm, fate: ask.for_s === null ? "unshelved" : "shelved", until_ns: ask.for_s === null ? null : state.step * STEP_NS + ask.for_s * 1e9 }),
    // Each step, for there are few.
    trace: ({ signals, from_ns, until_ns }, _, socket) => {
      const steps = Array.from({ length: (until_ns - from_ns) / STEP_NS + 1 }, (_, index) => from_ns / STEP_NS + index);
      const values = signals.map((signal) => steps.map((step) => [step * STEP_NS, at(step)[signal]]));
      socket.send(JSON.stringify({ type: "trace", from_ns, until_ns, values }));
    },
    parameter: ({ component, parameter, value }) => (value === null ? state.changed.delete(`${component}.${parameter}`) : state.changed.set(`${component}.${parameter}`, value)),
    watch: () => {},
    fail: () => {},
    fork: (ask) => say(JSON.stringify({ type: "forked", t_ns: ask.t_ns, url: "http://127.0.0.1:9/" })),
  };
  sockets.on("connection", (socket) => {
    socket.on("message", (data) => {
      const ask = JSON.parse(String(data));
      asked.push(ask);
      handle[ask.type](ask, viewer, socket);
      status();
      show(viewer, socket);
    });
    const viewer = { shown: null, subscribed: [] };
    viewers.set(socket, viewer);
    if (changes.length > 0) socket.send(JSON.stringify({ type: "alarms", all: true, changes }));
    socket.on("close", () => viewers.delete(socket));
    status();
    show(viewer, socket);
  });
  const ticker = setInterval(() => {
    if (!state.isHeld) state.step += 2;
    viewers.forEach(show);
  }, 20);
  await new Promise((ready) => http.listen(0, "127.0.0.1", ready));
  const close = async () => {
    clearInterval(ticker);
    sockets.clients.forEach((one) => one.terminate());
    await new Promise((closed) => http.close(closed));
  };
  return { url: `http://127.0.0.1:${http.address().port}/`, session, asked, state, say, ring, cut: () => sockets.clients.forEach((one) => one.terminate()), close };
}
