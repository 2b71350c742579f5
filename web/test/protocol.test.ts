import assert from "node:assert/strict";
import { test } from "node:test";
import { ProtocolError } from "../src/field";
import { decodeMessage } from "../src/message";
import { decodePicture } from "../src/picture";
import { decodeSession } from "../src/session";

const SESSION = {
  protocol: 1, title: "t", scenario: "s", step_ns: 10_000_000, until_ns: null,
  signals: [{ name: "Feed", type: "BOOL", writer: "plc", unit: null, about: "", names: { 0: "Off" } }],
  bodies: [{ name: "belt", kind: "fixed", shape: { kind: "box", size_m: [1, 2, 3] }, colour: null, position_m: [0, 0, 0] }],
};

function picture(): ArrayBuffer {
  const data = new ArrayBuffer(24 + 16 + 64);
  const view = new DataView(data);
  view.setUint8(0, 1);
  view.setUint8(1, 3);
  view.setUint16(2, 1, true);
  view.setUint32(4, 2, true);
  view.setBigUint64(8, 7n, true);
  view.setBigUint64(16, 70_000_000n, true);
  view.setUint32(24, 0, true);
  view.setFloat64(32, 1, true);
  view.setUint32(40, 0, true);
  [1, 2, 3, 0, 0, 0, 1].forEach((one, index) => view.setFloat32(44 + 4 * index, one, true));
  view.setUint32(72, 1, true);
  view.setFloat32(76, Number.NaN, true);
  return data;
}

test("a picture is read, with a body that is away", () => {
  const read = decodePicture(picture(), 1, 2);
  assert.deepEqual([read.step, read.t_ns, read.isHeld, read.isPast], [7, 70_000_000, true, true]);
  assert.deepEqual(read.values, [[0, 1]]);
  assert.deepEqual(read.poses[0], { body: 0, place: { position_m: [1, 2, 3], rotation: [0, 0, 0, 1] } });
  assert.equal(read.poses[1]?.place, null);
});

test("a picture that is cut anywhere or names what is not there is refused", () => {
  const whole = picture();
  for (let bytes = 0; bytes < whole.byteLength; bytes += 1) {
    assert.throws(() => decodePicture(whole.slice(0, bytes), 1, 2), ProtocolError);
  }
  assert.throws(() => decodePicture(whole, 0, 2), /names signal 0 of 0/);
  assert.throws(() => decodePicture(whole, 1, 1), /names body 1 of 1/);
});

test("any bytes give a picture or an error of the protocol", () => {
  let state = 1;
  const next = (): number => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0);
  for (let round = 0; round < 2000; round += 1) {
    const bytes = Uint8Array.from({ length: next() % 200 }, () => next() >>> 24);
    try {
      decodePicture(bytes.buffer, 4, 4);
    } catch (error) {
      assert.ok(error instanceof ProtocolError);
    }
  }
});

test("a session is read; an error names its place", () => {
  const session = decodeSession(SESSION);
  assert.equal(session.signals[0]?.names.get(0), "Off");
  assert.deepEqual(session.bodies[0]?.rotation, [0, 0, 0, 1]);
  assert.throws(() => decodeSession({ ...SESSION, protocol: 2 }), /protocol: is 2; this page speaks 1/);
  assert.throws(() => decodeSession({ ...SESSION, signals: [{}] }), /signals\[0\]\.name: is not a text/);
  const open = { kind: "mesh", positions_m: [0, 0, 0], indices: [0, 1, 2] };
  assert.throws(() => decodeSession({ ...SESSION, bodies: [{ ...SESSION.bodies[0], shape: open }] }), /bodies\[0\]\.shape: has no vertex 1/);
  for (const garbage of [null, 3, "x", [], {}]) assert.throws(() => decodeSession(garbage), ProtocolError);
});

test("a fork comes with the address of a page, and nothing else becomes a link", () => {
  const forked = decodeMessage('{"type":"forked","t_ns":5,"url":"http://127.0.0.1:8080/"}');
  assert.ok(forked.type === "forked" && forked.t_ns === 5 && forked.url.endsWith("8080/"));
  for (const url of ["javascript:alert(1)", "http://a b", "", 'http://x"onclick="']) {
    assert.throws(() => decodeMessage(JSON.stringify({ type: "forked", t_ns: 5, url })), ProtocolError);
  }
});

test("variables of the PLC are read, in a session and as they change", () => {
  const plcs = [{ client: "plc", variables: [{ path: "Main.x", type: "INT" }, { path: "Main.axis[1].on", type: "BOOL" }] }];
  const session = decodeSession({ ...SESSION, plcs, sources: [{ path: "a.st", text: "", lines: [{ line: 1, variables: [], inner: [0] }] }] });
  assert.deepEqual([session.plcs[0]?.variables[1]?.path, session.sources[0]?.lines[0]?.inner], ["Main.axis[1].on", [0]]);
  assert.throws(() => decodeSession({ ...SESSION, plcs: [{ client: "plc" }] }), /plcs\[0\]\.variables: is not a list/);
  const seen = decodeMessage('{"type":"variables","values":[[1,"TRUE"]],"forced":[1],"executed":[["a.st",3]]}');
  assert.ok(seen.type === "variables" && seen.values[0]?.[1] === "TRUE" && seen.forced[0] === 1 && seen.executed[0]?.[1] === 3);
  for (const garbage of ['{"values":[[1]],"forced":[]}', '{"values":[["1","x"]],"forced":[]}', '{"values":[]}', '{"values":[[1,"a",2]],"forced":[]}']) {
    assert.throws(() => decodeMessage(garbage.replace("{", '{"type":"variables",')), ProtocolError);
  }
});

test("messages are read; garbage is an error", () => {
  const status = decodeMessage('{"type":"status","state":"run","pace":"1","seat":{"desk":"free"},"past_ns":[0,5]}');
  assert.ok(status.type === "status" && status.seat.get("desk") === "free" && status.past_ns?.[1] === 5);
  for (const garbage of ["", "{", "null", '{"type":"x"}', '{"type":"status"}', '{"type":"status","state":"run","seat":{"a":"b"}}']) {
    assert.throws(() => decodeMessage(garbage), ProtocolError);
  }
});
