// What the editor's server and its page say to each other. Types and readers are generated from those of the server.

import { Field } from "../field";
import { PROTOCOL, readAnswer, readEditState, readLibrary, type Answer, type EditState, type Library, type Want as Asked } from "../generated/edit";
import { check_version } from "../session";

export type * from "../generated/edit";
export type { Json } from "../field";

/** What the page wants; the editor adds the revision of the state that the page shows. */
export type Want = Asked extends infer One ? (One extends unknown ? Omit<One, "revision"> : never) : never;

/** Reads what is known of a scenario; throws [`ProtocolError`] with the place that is wrong. */
export function decodeState(value: unknown): EditState {
  const root = new Field(value, "");
  check_version(root, PROTOCOL);
  return readEditState(root);
}

/** Reads the answer to a request. */
export function decodeAnswer(value: unknown): Answer {
  const root = new Field(value, "");
  const state = root.at("state");
  if (!state.isAbsent) check_version(state, PROTOCOL);
  return readAnswer(root);
}

/** Reads what can be placed. */
export function decodeLibrary(value: unknown): Library {
  const root = new Field(value, "");
  check_version(root, PROTOCOL);
  return readLibrary(root);
}
