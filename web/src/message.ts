// What session and page say to each other while it runs. Types and readers are generated from those of the server.

import { Field, ProtocolError } from "./field";
import { readMessage, type Message } from "./generated/session";

export type { Ask, Message, SeatState } from "./generated/session";

/** What is new of the PLC's variables. */
export type Variables = Extract<Message, { readonly type: "variables" }>;

/** Reads a message of the server; throws [`ProtocolError`]. */
export function decodeMessage(raw: string): Message {
  let value: unknown;
  try {
    value = JSON.parse(raw);
  } catch (error) {
    throw new ProtocolError("message", `is not JSON (${String(error)})`);
  }
  return readMessage(new Field(value, ""));
}
