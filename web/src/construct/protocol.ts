// What the editor's server says and what the page wants of it. Nothing that arrives is trusted.

import { Field, ProtocolError } from "../field";
import { body, type Body } from "../session";

export type Json = string | number | boolean | readonly Json[] | { readonly [key: string]: Json } | null;

/** A value that a key is given. */
export type Given = string | number | boolean | readonly number[] | readonly string[];

export interface Finding {
  readonly isError: boolean;
  readonly message: string;
  readonly help: string | null;
  readonly file: string | null;
  readonly line: number | null;
}

export interface Client {
  readonly name: string;
  readonly kind: string;
  readonly scene: string | null;
}

/** One client's part of a signal. */
export interface Hook {
  readonly client: string;
  readonly at: readonly string[];
}

export interface Wired {
  readonly name: string;
  readonly type: string;
  readonly unit: string | null;
  readonly writer: Hook;
  readonly readers: readonly Hook[];
}

export interface Trouble {
  readonly kind: string;
  readonly signal: string;
  readonly message: string;
}

export interface Wiring {
  readonly signals: readonly Wired[];
  readonly troubles: readonly Trouble[];
}

/** What can be connected. */
export interface End {
  readonly client: string;
  readonly at: string;
  readonly type: string;
  readonly gives: boolean;
  readonly signals: readonly string[];
  readonly isFixed: boolean;
}

export interface Table {
  readonly sort: string;
  readonly name: string;
  readonly line: number;
  readonly keys: ReadonlyMap<string, Json>;
}

export interface SceneState {
  readonly file: string;
  /** Nothing while the scene is wrong. */
  readonly bodies: readonly Body[] | null;
  readonly tables: readonly Table[];
}

export interface EditState {
  readonly scenario: string;
  readonly revision: number;
  readonly undo: string | null;
  readonly redo: string | null;
  readonly changed: readonly string[];
  readonly findings: readonly Finding[];
  readonly clients: readonly Client[];
  readonly signals: readonly string[];
  readonly map: Wiring | null;
  readonly ends: readonly End[];
  readonly scenes: readonly SceneState[];
}

export type Form =
  | { readonly kind: "number"; readonly least: number | null; readonly most: number | null }
  | { readonly kind: "whole"; readonly least: number; readonly most: number }
  | { readonly kind: "flag" }
  | { readonly kind: "choice"; readonly words: readonly string[] }
  | { readonly kind: "text" | "texts"; readonly names: string | null }
  | { readonly kind: "numbers"; readonly count: number };

export const PARTS = ["parameter", "binding", "input", "output", "wire"] as const;
export type Part = (typeof PARTS)[number];

/** A key that a table may have. */
export interface FieldInfo {
  readonly key: string;
  readonly name: string;
  readonly unit: string | null;
  readonly about: string;
  readonly form: Form;
  readonly needed: boolean;
  readonly preset: Json;
  readonly part: Part;
}

export interface Kind {
  readonly name: string;
  readonly about: string;
  /** The types of signals, by the keys that name them. */
  readonly types: ReadonlyMap<string, string>;
  readonly fields: readonly FieldInfo[];
}

export interface Library {
  readonly kinds: readonly Kind[];
  readonly sorts: ReadonlyMap<string, readonly FieldInfo[]>;
}

export interface Refusal {
  readonly message: string;
  readonly file: string | null;
  readonly line: number | null;
  readonly references: readonly { readonly by: string; readonly file: string; readonly line: number }[];
}

export interface Answer {
  readonly error: Refusal | null;
  readonly state: EditState | null;
}

/** An end of a client, or a signal. */
export type Tip = { readonly client: string; readonly at: string } | { readonly signal: string };

export type Edit =
  | { readonly do: "declare"; readonly signal: string; readonly type: string; readonly writer: string }
  | { readonly do: "add"; readonly scene: string; readonly sort: string; readonly name: string; readonly keys: readonly (readonly [string, Given])[] }
  | { readonly do: "set"; readonly scene: string; readonly sort: string; readonly name: string; readonly key: string; readonly value: Given | null }
  | { readonly do: "move"; readonly scene: string; readonly body: string; readonly position_m: readonly [number, number, number] }
  | { readonly do: "rename"; readonly scene: string; readonly sort: string; readonly name: string; readonly to: string }
  | { readonly do: "remove"; readonly scene: string; readonly sort: string; readonly name: string };

export type Want =
  | { readonly want: "change"; readonly edits: readonly Edit[] }
  | { readonly want: "join"; readonly one: Tip; readonly other: Tip }
  | { readonly want: "part"; readonly tip: Tip }
  | { readonly want: "undo" }
  | { readonly want: "redo" }
  | { readonly want: "reload" };

const text = (field: Field): string => field.text();
const nullableText = (field: Field): string | null => field.or<string | null>(null, text);
const nullableNumber = (field: Field): number | null => field.or<number | null>(null, (item) => item.number());

/** Any value of a key; a table may say more than this page shows. */
function json(field: Field): Json {
  const value = field.value;
  if (value === undefined) return null;
  if (value === null || typeof value === "string" || typeof value === "boolean") return value;
  if (typeof value === "number") return field.number();
  if (Array.isArray(value)) return field.list(json);
  return Object.fromEntries(field.entries((key, item) => [key, json(item)]));
}

function hook(field: Field): Hook {
  return { client: field.at("client").text(), at: field.at("at").list(text) };
}

function wiring(field: Field): Wiring {
  return {
    signals: field.at("signals").list((item) => ({
      name: item.at("name").text(),
      type: item.at("type").text(),
      unit: nullableText(item.at("unit")),
      writer: hook(item.at("writer")),
      readers: item.at("readers").list(hook),
    })),
    troubles: field.at("troubles").list((item) => ({
      kind: item.at("kind").text(),
      signal: item.at("signal").text(),
      message: item.at("message").text(),
    })),
  };
}

function end(field: Field): End {
  return {
    client: field.at("client").text(),
    at: field.at("at").text(),
    type: field.at("type").text(),
    gives: field.at("gives").flag(),
    signals: field.at("signals").list(text),
    isFixed: field.at("hand").at("kind").text() === "fixed",
  };
}

function version(root: Field): void {
  const spoken = root.at("protocol").number();
  if (spoken !== 1) root.at("protocol").fail(`is ${spoken}; this page speaks 1`);
}

function state(root: Field): EditState {
  version(root);
  return {
    scenario: root.at("scenario").text(),
    revision: root.at("revision").number(),
    undo: nullableText(root.at("undo")),
    redo: nullableText(root.at("redo")),
    changed: root.at("changed").list(text),
    findings: root.at("findings").list((item) => ({
      isError: item.at("is_error").flag(),
      message: item.at("message").text(),
      help: nullableText(item.at("help")),
      file: nullableText(item.at("file")),
      line: nullableNumber(item.at("line")),
    })),
    clients: root.at("clients").list((item) => ({
      name: item.at("name").text(),
      kind: item.at("kind").text(),
      scene: nullableText(item.at("scene")),
    })),
    signals: root.at("signals").list(text),
    map: root.at("map").or<Wiring | null>(null, wiring),
    ends: root.at("ends").list(end),
    scenes: root.at("scenes").list((item) => ({
      file: item.at("file").text(),
      bodies: item.at("bodies").or<Body[] | null>(null, (all) => all.list(body)),
      tables: item.at("tables").list((table) => ({
        sort: table.at("sort").text(),
        name: table.at("name").text(),
        line: table.at("line").number(),
        keys: new Map(table.at("keys").entries((key, value) => [key, json(value)] as const)),
      })),
    })),
  };
}

/** Reads what is known of a scenario; throws [`ProtocolError`] with the place that is wrong. */
export function decodeState(value: unknown): EditState {
  return state(new Field(value, ""));
}

/** Reads the answer to a request. */
export function decodeAnswer(value: unknown): Answer {
  const root = new Field(value, "");
  return {
    error: root.at("error").or<Refusal | null>(null, (error) => ({
      message: error.at("message").text(),
      file: nullableText(error.at("file")),
      line: nullableNumber(error.at("line")),
      references: error.at("references").list((item) => ({
        by: item.at("by").text(),
        file: item.at("file").text(),
        line: item.at("line").number(),
      })),
    })),
    state: root.at("state").or<EditState | null>(null, state),
  };
}

function form(field: Field): Form {
  const kind = field.at("kind").text();
  switch (kind) {
    case "number":
      return { kind, least: nullableNumber(field.at("least")), most: nullableNumber(field.at("most")) };
    case "whole":
      return { kind, least: field.at("least").number(), most: field.at("most").number() };
    case "flag":
      return { kind };
    case "choice":
      return { kind, words: field.at("words").list(text) };
    case "text":
    case "texts":
      return { kind, names: nullableText(field.at("names")) };
    case "numbers":
      return { kind, count: field.at("count").number() };
    default:
      throw new ProtocolError(field.place, `is a \`${kind}\`, which this page does not have`);
  }
}

function fieldInfo(field: Field): FieldInfo {
  const part = field.at("part").text();
  return {
    key: field.at("key").text(),
    name: field.at("name").text(),
    unit: nullableText(field.at("unit")),
    about: field.at("about").text(),
    form: form(field.at("form")),
    needed: field.at("needed").flag(),
    preset: json(field.at("preset")),
    part: PARTS.find((one) => one === part) ?? field.at("part").fail(`is a \`${part}\`, which this page does not have`),
  };
}

/** Reads what can be placed. */
export function decodeLibrary(value: unknown): Library {
  const root = new Field(value, "");
  version(root);
  return {
    kinds: root.at("kinds").list((item) => ({
      name: item.at("name").text(),
      about: item.at("about").text(),
      types: new Map(item.at("types").entries((key, type) => [key, type.text()] as const)),
      fields: item.at("fields").list(fieldInfo),
    })),
    sorts: new Map(root.at("sorts").list((item) => [item.at("sort").text(), item.at("fields").list(fieldInfo)] as const)),
  };
}
