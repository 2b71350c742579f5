// What of a session does not change while it runs. Its types and readers are generated from those of the server.

import { Field } from "./field";
import { PROTOCOL, readSession, type Session } from "./generated/session";

export type * from "./generated/session";

export type Vec3 = readonly [number, number, number];
/** x, y, z, w. */
export type Quaternion = readonly [number, number, number, number];

/** Refuses a version of the protocol that this page does not speak, before anything else can be wrong. */
export function check_version(root: Field, protocol: number): void {
  const spoken = root.at("protocol").number();
  if (spoken !== protocol) root.at("protocol").fail(`is ${spoken}; this page speaks ${protocol}`);
}

/** Reads the structure of a session; throws [`ProtocolError`] with the place that is wrong. */
export function decodeSession(value: unknown): Session {
  const root = new Field(value, "");
  check_version(root, PROTOCOL);
  return readSession(root);
}
