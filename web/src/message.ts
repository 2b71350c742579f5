// What session and page say to each other while it runs: types and decoders. Nothing that arrives is trusted.

import { Field, ProtocolError, nullableText, number, text } from "./field";
import type { Axis, Cells } from "./map";

/** What is new of the PLC's variables. */
export interface Variables {
  readonly values: readonly (readonly [number, string])[];
  readonly forced: readonly number[];
  /** File and line of what has been executed. */
  readonly executed: readonly (readonly [string, number])[];
}

export type Seat = "free" | "mine" | "taken";

export type Message =
  | {
      readonly type: "status";
      readonly state: string;
      readonly digest: string | null;
      readonly pace: string;
      readonly seats: ReadonlyMap<string, Seat>;
      /** Failures at work, as `component.mode`. */
      readonly failed: ReadonlySet<string>;
      /** Numbers of the signals that are forced. */
      readonly forced: ReadonlySet<number>;
      /** Numbers of the faults on the way of signals that are at work. */
      readonly disturbed: ReadonlySet<number>;
      /** The time in the past that is shown; nothing at the live edge. */
      readonly shown_ns: number | null;
      readonly past_ns: readonly [number, number] | null;
    }
  | { readonly type: "event"; readonly t_ns: number; readonly kind: string; readonly text: string }
  | {
      readonly type: "verdict";
      readonly name: string;
      readonly verdict: string;
      readonly robustness: number | null;
      readonly t_ns: number;
    }
  | { readonly type: "looks"; readonly active: readonly number[] }
  | { readonly type: "view"; readonly view: string }
  | { readonly type: "states"; readonly drawing: number; readonly instance: number; readonly values: readonly (number | null)[] }
  | ({ readonly type: "variables" } & Variables)
  | ({ readonly type: "map"; readonly map: number } & Cells)
  /** A session goes on from a moment of the past; its page is at `url`. */
  | { readonly type: "forked"; readonly t_ns: number; readonly url: string }
  | { readonly type: "error"; readonly message: string };

function seat(field: Field): Seat {
  const one = field.text();
  return one === "free" || one === "mine" || one === "taken" ? one : field.fail(`is \`${one}\`: free, mine or taken`);
}

function couple<A, B>(field: Field, first: (item: Field) => A, second: (item: Field) => B): readonly [A, B] {
  const [a, b, ...more] = field.list((item) => item);
  return a === undefined || b === undefined || more.length > 0 ? field.fail("is no pair") : [first(a), second(b)];
}

function axis(field: Field): Axis {
  const edges = field.at("edges").list(number);
  if (edges.some((edge, index) => index > 0 && edge < (edges[index - 1] ?? edge))) field.at("edges").fail("do not rise");
  return { name: field.at("name").text(), edges };
}

/** The address of a page: of this kind and no other, as it becomes a link. */
function page(field: Field): string {
  const url = field.text();
  return /^https?:\/\/[^\s"'<>]+$/.test(url) ? url : field.fail("is no address of a page");
}

/** Reads a message of the server; throws [`ProtocolError`]. */
export function decodeMessage(raw: string): Message {
  let value: unknown;
  try {
    value = JSON.parse(raw);
  } catch (error) {
    throw new ProtocolError("message", `is not JSON (${String(error)})`);
  }
  const root = new Field(value, "");
  const type = root.at("type").text();
  switch (type) {
    case "status":
      return {
        type,
        state: root.at("state").text(),
        digest: nullableText(root.at("digest")),
        pace: root.at("pace").or("", (field) => field.shown()),
        seats: new Map(root.at("seat").or<[string, Seat][]>([], (all) => all.entries((key, item) => [key, seat(item)]))),
        failed: new Set(root.at("failed").or<string[]>([], (all) => all.list(text))),
        forced: new Set(root.at("forced").or<number[]>([], (all) => all.list(number))),
        disturbed: new Set(root.at("disturbed").or<number[]>([], (all) => all.list(number))),
        shown_ns: root.at("shown_ns").or<number | null>(null, number),
        past_ns: root.at("past_ns").or<readonly [number, number] | null>(null, (item) => item.numbers(2) as [number, number]),
      };
    case "event":
      return { type, t_ns: root.at("t_ns").number(), kind: root.at("kind").text(), text: root.at("text").text() };
    case "verdict":
      return {
        type,
        name: root.at("name").text(),
        verdict: root.at("verdict").text(),
        robustness: root.at("robustness").or<number | null>(null, number),
        t_ns: root.at("t_ns").number(),
      };
    case "looks":
      return { type, active: root.at("active").list(number) };
    case "view":
      return { type, view: root.at("view").text() };
    case "states":
      return {
        type, drawing: root.at("drawing").number(), instance: root.at("instance").number(),
        values: root.at("values").list((item) => item.or<number | null>(null, number)),
      };
    case "variables":
      return {
        type,
        values: root.at("values").list((item) => couple(item, number, text)),
        forced: root.at("forced").list(number),
        executed: root.at("executed").or<(readonly [string, number])[]>([], (all) => all.list((item) => couple(item, text, number))),
      };
    case "map":
      return { type, map: root.at("map").number(), across: axis(root.at("across")), down: axis(root.at("down")) };
    case "forked":
      return { type, t_ns: root.at("t_ns").number(), url: page(root.at("url")) };
    case "error":
      return { type, message: root.at("message").text() };
    default:
      return root.at("type").fail(`is \`${type}\`, which this page does not know`);
  }
}

/** What the page asks. */
export type Ask =
  | { readonly type: "subscribe"; readonly signals: readonly number[] }
  | { readonly type: "write"; readonly signal: number; readonly value: number }
  | { readonly type: "operate"; readonly operation: "hold" | "go" | "step" | "stop"; readonly steps?: number }
  | { readonly type: "seat"; readonly panel: string; readonly take: boolean }
  | { readonly type: "fail"; readonly component: string; readonly failure: string; readonly active: boolean }
  | { readonly type: "disturb"; readonly disturbance: number; readonly active: boolean }
  | { readonly type: "train"; readonly turn: "repeat" }
  | { readonly type: "train"; readonly turn: "back"; readonly t_ns: number }
  | { readonly type: "train"; readonly turn: "jump"; readonly start: string }
  | { readonly type: "show"; readonly t_ns: number }
  | { readonly type: "view"; readonly view: string }
  | { readonly type: "draw"; readonly drawing: number | null; readonly instance: number }
  | { readonly type: "live" }
  | { readonly type: "watch"; readonly variables: readonly number[] }
  | { readonly type: "maps"; readonly maps: readonly number[] }
  | { readonly type: "variable"; readonly variable: number; readonly action: "write" | "force" | "release"; readonly value: string }
  | { readonly type: "force"; readonly signal: number; readonly value: string | null }
  | { readonly type: "fork"; readonly t_ns: number };
