// The films of the README, of real runs: the shear free-wheeling beside the shear in lockstep, and the robot cell.
// `node e2e/films.mjs PROGRAM SCENARIOS [FOLDER]` writes them to FOLDER, the one that has them in the repository by default.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [program, scenarios, folder = join(import.meta.dirname, "../../docs")] = process.argv.slice(2);
const BYTES_MOST = 1_000_000;
const room = await mkdtemp(join(tmpdir(), "films-"));

async function film(scenario, name, words) {
  const path = join(room, `${name}.webp`);
  const made = spawnSync(program, ["shot", join(scenarios, scenario), "--film", "-o", path, ...words]);
  assert.equal(made.status, 0, String(made.stderr));
  return readFile(path);
}

/** The chunks of a film behind its head: name, content. */
function* chunks(bytes) {
  for (let at = 12; at < bytes.length; ) {
    const length = bytes.readUInt32LE(at + 4);
    yield [bytes.toString("latin1", at, at + 4), bytes.subarray(at + 8, at + 8 + length)];
    at += 8 + length + (length % 2);
  }
}

function chunk(name, content) {
  const head = Buffer.alloc(8);
  head.write(name, "latin1");
  head.writeUInt32LE(content.length, 4);
  return Buffer.concat([head, content, Buffer.alloc(content.length % 2)]);
}

/** Two films of one size and length, one beside the other: their pictures in turn, each for half of its time. */
function beside(left, right) {
  const [one, other] = [[...chunks(left)], [...chunks(right)]];
  const head = Buffer.from(one.find(([name]) => name === "VP8X")[1]);
  const width = head.readUIntLE(4, 3) + 1;
  head.writeUIntLE(2 * width - 1, 4, 3);
  const pictures = [one, other].map((all) => all.filter(([name]) => name === "ANMF").map(([, content]) => Buffer.from(content)));
  assert.equal(pictures[0].length, pictures[1].length);
  // An offset counts in twos.
  assert.equal(width % 2, 0);
  const frames = pictures[0].flatMap((_, at) => pictures.map((side, place) => {
    const content = side[at];
    content.writeUIntLE((place * width) / 2, 0, 3);
    content.writeUIntLE(Math.round(content.readUIntLE(12, 3) / 2), 12, 3);
    return chunk("ANMF", content);
  }));
  const body = Buffer.concat([Buffer.from("WEBP"), chunk("VP8X", head), chunk("ANIM", one.find(([name]) => name === "ANIM")[1]), ...frames]);
  return chunk("RIFF", body);
}

async function keep(name, bytes, pictures) {
  assert.equal([...chunks(bytes)].filter(([kind]) => kind === "ANMF").length, pictures, name);
  assert.ok(bytes.length <= BYTES_MOST, `${name} has ${bytes.length} bytes`);
  await writeFile(join(folder, name), bytes);
  console.log(`${name}: ${pictures} pictures, ${Math.round(bytes.length / 1000)} kB`);
}

try {
  const shear = ["--until", "5900ms", "--rate", "10", "--size", "448x252"];
  const [free, lockstep] = [await film("shear", "free", [...shear, "--freewheel", "2"]), await film("shear", "lockstep", shear)];
  assert.notDeepEqual(free, lockstep);
  await keep("film-shear.webp", beside(free, lockstep), 120);
  await keep("film-robot-cell.webp", await film("robot-cell", "cell", ["--until", "23800ms", "--rate", "10", "--speed", "2", "--size", "720x405"]), 120);
} finally {
  await rm(room, { recursive: true, force: true });
}
