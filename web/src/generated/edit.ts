// Generated from the types of the server; see web/README.md. Do not edit.

import { flag, json, list, map, nullable, number, one_of, text, tuple, whole, type Field, type Json } from "../field";
import { check_shape } from "../checks";

export const PROTOCOL = 1;

/** The answer to what a page wants. */
export interface Answer {
  readonly error: Refusal | null;
  readonly state: EditState | null;
}

export function readAnswer(field: Field): Answer {
  return {
    error: nullable(readRefusal)(field.at("error")),
    state: nullable(readEditState)(field.at("state")),
  };
}

/** A body, or a shape of one, where the scene has it. */
export interface Body {
  readonly colour: string | null;
  readonly kind: string;
  readonly name: string;
  /** The body in whose frame it is; its place is in the world's without one. */
  readonly on: number | null;
  readonly position_m: readonly [number, number, number];
  /** x, y, z, w. */
  readonly rotation: readonly [number, number, number, number];
  readonly shape: Shape;
  /** How much one sees through it, 0 to 1. */
  readonly transparent: number;
}

export function readBody(field: Field): Body {
  return {
    colour: nullable(text)(field.at("colour")),
    kind: text(field.at("kind")),
    name: text(field.at("name")),
    on: nullable(whole)(field.at("on")),
    position_m: tuple(number, number, number)(field.at("position_m")),
    rotation: tuple(number, number, number, number)(field.at("rotation", [0.0,0.0,0.0,1.0])),
    shape: readShape(field.at("shape")),
    transparent: number(field.at("transparent", 0)),
  };
}

/** A client, as far as its file says it. */
export interface Client {
  readonly kind: string;
  readonly name: string;
  readonly scene: string | null;
}

export function readClient(field: Field): Client {
  return {
    kind: text(field.at("kind")),
    name: text(field.at("name")),
    scene: nullable(text)(field.at("scene")),
  };
}

/** A change of the files. */
export type Edit =
  /** A signal is this variable of the PLC, by a line of its `bind`. */
  | { readonly do: "connect"; readonly client: string; readonly signal: string; readonly variable: string }
  /** That line goes. */
  | { readonly do: "disconnect"; readonly client: string; readonly signal: string }
  /** A signal of the session. */
  | { readonly do: "declare"; readonly about?: string | null; readonly signal: string; readonly type: string; readonly unit?: string | null; readonly writer: string }
  /** A signal goes that nobody refers to. */
  | { readonly do: "withdraw"; readonly signal: string }
  /** A body, a joint, a component, … */
  | { readonly do: "add"; readonly keys: readonly (readonly [string, Given])[]; readonly name: string; readonly scene: string; readonly sort: Sort }
  /** A key gets another value, or goes. */
  | { readonly do: "set"; readonly key: string; readonly name: string; readonly scene: string; readonly sort: Sort; readonly value?: Given | null }
  /** A body gets another place. */
  | { readonly do: "move"; readonly body: string; readonly position_m: readonly [number, number, number]; readonly scene: string }
  /** A thing gets another name, with all that refers to it. */
  | { readonly do: "rename"; readonly name: string; readonly scene: string; readonly sort: Sort; readonly to: string }
  /** A thing goes that nobody refers to. */
  | { readonly do: "remove"; readonly name: string; readonly scene: string; readonly sort: Sort };

/** What is known of the files as they are. */
export interface EditState {
  /** Files that somebody else has changed since. */
  readonly changed: readonly string[];
  readonly clients: readonly Client[];
  readonly ends: readonly End[];
  readonly findings: readonly Finding[];
  /** None while something keeps the wiring from being known. */
  readonly map: Wiring | null;
  readonly protocol: number;
  readonly redo: string | null;
  readonly revision: number;
  readonly scenario: string;
  readonly scenes: readonly SceneState[];
  /** The signals that are declared, arrays and structures as they are written. */
  readonly signals: readonly string[];
  /** What would be taken back, and done again. */
  readonly undo: string | null;
}

export function readEditState(field: Field): EditState {
  return {
    changed: list(text)(field.at("changed")),
    clients: list(readClient)(field.at("clients")),
    ends: list(readEnd)(field.at("ends")),
    findings: list(readFinding)(field.at("findings")),
    map: nullable(readWiring)(field.at("map")),
    protocol: whole(field.at("protocol")),
    redo: nullable(text)(field.at("redo")),
    revision: whole(field.at("revision")),
    scenario: text(field.at("scenario")),
    scenes: list(readSceneState)(field.at("scenes")),
    signals: list(text)(field.at("signals")),
    undo: nullable(text)(field.at("undo")),
  };
}

/** Where a connection can begin or end. */
export interface End {
  /** What it is there: an input or output of a component, a variable. */
  readonly at: string;
  /** The client. */
  readonly client: string;
  /** Whether it writes. */
  readonly gives: boolean;
  /** What says so. */
  readonly hand: Hand;
  /** The signals that it is connected to. */
  readonly signals: readonly string[];
  /** Its type. */
  readonly type: string;
}

export function readEnd(field: Field): End {
  return {
    at: text(field.at("at")),
    client: text(field.at("client")),
    gives: flag(field.at("gives")),
    hand: readHand(field.at("hand")),
    signals: list(text)(field.at("signals")),
    type: text(field.at("type")),
  };
}

/** A key. */
export interface FieldInfo {
  /** What it means. */
  readonly about: string;
  /** What it may be. */
  readonly form: Form;
  /** As it is written. */
  readonly key: string;
  /** What it is called, without unit and ending. */
  readonly name: string;
  /** Whether nothing goes without it. */
  readonly needed: boolean;
  /** What part it has in its table. */
  readonly part: Part;
  /** What it is where it is absent. */
  readonly preset: Json;
  /** Its unit, as people write it. */
  readonly unit: string | null;
}

export function readFieldInfo(field: Field): FieldInfo {
  return {
    about: text(field.at("about")),
    form: readForm(field.at("form")),
    key: text(field.at("key")),
    name: text(field.at("name")),
    needed: flag(field.at("needed")),
    part: readPart(field.at("part")),
    preset: json(field.at("preset")),
    unit: nullable(text)(field.at("unit")),
  };
}

/** Something that is wrong. */
export interface Finding {
  /** The file. */
  readonly file: string | null;
  /** What to do. */
  readonly help: string | null;
  /** Whether a session could not start. */
  readonly is_error: boolean;
  /** Its line, from 1. */
  readonly line: number | null;
  /** What is wrong. */
  readonly message: string;
}

export function readFinding(field: Field): Finding {
  return {
    file: nullable(text)(field.at("file")),
    help: nullable(text)(field.at("help")),
    is_error: flag(field.at("is_error")),
    line: nullable(whole)(field.at("line")),
    message: text(field.at("message")),
  };
}

/** What may be written. */
export type Form =
  /** A number, bounds included. */
  | { readonly kind: "number"; readonly least: number | null; readonly most: number | null }
  /** A whole number, bounds included. */
  | { readonly kind: "whole"; readonly least: number; readonly most: number }
  /** `true` or `false`. */
  | { readonly kind: "flag" }
  /** One word of these. */
  | { readonly kind: "choice"; readonly words: readonly string[] }
  /** A text; `names` says of what it is the name. */
  | { readonly kind: "text"; readonly names: Sort | null }
  /** So many numbers. */
  | { readonly kind: "numbers"; readonly count: number }
  /** Names. */
  | { readonly kind: "texts"; readonly names: Sort | null };

export function readForm(field: Field): Form {
  const kind = field.at("kind").text();
  switch (kind) {
    case "number":
      return { kind, least: nullable(number)(field.at("least")), most: nullable(number)(field.at("most")) };
    case "whole":
      return { kind, least: whole(field.at("least")), most: whole(field.at("most")) };
    case "flag":
      return { kind };
    case "choice":
      return { kind, words: list(text)(field.at("words")) };
    case "text":
      return { kind, names: nullable(readSort)(field.at("names")) };
    case "numbers":
      return { kind, count: whole(field.at("count")) };
    case "texts":
      return { kind, names: nullable(readSort)(field.at("names")) };
    default:
      return field.unknown("kind", kind);
  }
}

/** A value that a key is given. */
export type Given = boolean | number | string | readonly number[] | readonly string[];

/** What is written to connect an end. */
export type Hand =
  /** A key of a table of a scene. */
  | { readonly kind: "key"; readonly key: string; readonly name: string; readonly scene: string; readonly sort: Sort }
  /** A line of `bind`. */
  | { readonly kind: "variable"; readonly path: string }
  /** Nothing that the editor writes: an element of an array, a part of a kind of the user's own. */
  | { readonly kind: "fixed" };

export function readHand(field: Field): Hand {
  const kind = field.at("kind").text();
  switch (kind) {
    case "key":
      return {
        kind,
        key: text(field.at("key")),
        name: text(field.at("name")),
        scene: text(field.at("scene")),
        sort: readSort(field.at("sort")),
      };
    case "variable":
      return { kind, path: text(field.at("path")) };
    case "fixed":
      return { kind };
    default:
      return field.unknown("kind", kind);
  }
}

/** One client's part of a signal. */
export interface Hook {
  /** Outputs, inputs or variables; empty if they are not known. */
  readonly at: readonly string[];
  /** The client. */
  readonly client: string;
}

export function readHook(field: Field): Hook {
  return { at: list(text)(field.at("at")), client: text(field.at("client")) };
}

export interface Kind {
  readonly about: string;
  readonly fields: readonly FieldInfo[];
  readonly name: string;
  /** Types of inputs and outputs, by the keys that name their signals. */
  readonly types: ReadonlyMap<string, string>;
}

export function readKind(field: Field): Kind {
  return {
    about: text(field.at("about")),
    fields: list(readFieldInfo)(field.at("fields")),
    name: text(field.at("name")),
    types: map(text)(field.at("types")),
  };
}

/** What can be placed: the kinds of components, and the keys of every sort of table. */
export interface Library {
  readonly kinds: readonly Kind[];
  readonly protocol: number;
  readonly sorts: readonly SortFields[];
}

export function readLibrary(field: Field): Library {
  return {
    kinds: list(readKind)(field.at("kinds")),
    protocol: whole(field.at("protocol")),
    sorts: list(readSortFields)(field.at("sorts")),
  };
}

/** A client. */
export interface Member {
  /** Its kind, as the scenario has it. */
  readonly kind: string;
  /** Whether what it reads and writes is known before it joins. */
  readonly known: boolean;
  /** Its name. */
  readonly name: string;
}

export function readMember(field: Field): Member {
  return { kind: text(field.at("kind")), known: flag(field.at("known")), name: text(field.at("name")) };
}

/** An input of a component that nobody drives. */
export interface OpenInput {
  /** The plant that has the component. */
  readonly client: string;
  /** Component and input, as in `heater.on`. */
  readonly input: string;
  /** What it is all the time. */
  readonly preset: Json;
}

export function readOpenInput(field: Field): OpenInput {
  return {
    client: text(field.at("client")),
    input: text(field.at("input")),
    preset: json(field.at("preset")),
  };
}

/** The part of a key in its table. */
export type Part = "parameter" | "binding" | "input" | "output" | "wire";

export function readPart(field: Field): Part {
  return one_of("parameter", "binding", "input", "output", "wire")(field);
}

/** Something that refers to a thing. */
export interface Reference {
  /** What refers to it, as in "component `cylinder`, joint". */
  readonly by: string;
  /** The file, as the scenario names it. */
  readonly file: string;
  /** The line. */
  readonly line: number;
}

export function readReference(field: Field): Reference {
  return { by: text(field.at("by")), file: text(field.at("file")), line: whole(field.at("line")) };
}

/** Why nothing was done. */
export interface Refusal {
  readonly file: string | null;
  readonly line: number | null;
  readonly message: string;
  readonly references: readonly Reference[];
}

export function readRefusal(field: Field): Refusal {
  return {
    file: nullable(text)(field.at("file")),
    line: nullable(whole)(field.at("line")),
    message: text(field.at("message")),
    references: list(readReference)(field.at("references")),
  };
}

/** A scene, for the machine and for the forms. */
export interface SceneState {
  /** None while the scene is wrong. */
  readonly bodies: readonly Body[] | null;
  readonly file: string;
  readonly tables: readonly Table[];
}

export function readSceneState(field: Field): SceneState {
  return {
    bodies: nullable(list(readBody))(field.at("bodies")),
    file: text(field.at("file")),
    tables: list(readTable)(field.at("tables")),
  };
}

/** The shape of a body; a cylinder and a capsule lie along z. */
export type Shape =
  | { readonly kind: "none" }
  | { readonly kind: "box"; readonly size_m: readonly [number, number, number] }
  | { readonly kind: "sphere"; readonly radius_m: number }
  | { readonly kind: "cylinder"; readonly length_m: number; readonly radius_m: number }
  /** A cylinder or a cone, without ends if it is open. */
  | { readonly kind: "round"; readonly length_m: number; readonly open: boolean; readonly radius_m: number; readonly top_radius_m: number }
  | { readonly kind: "capsule"; readonly length_m: number; readonly radius_m: number }
  /** Positions are flat triples, indices flat triangles. */
  | { readonly kind: "mesh"; readonly indices: readonly number[]; readonly positions_m: readonly number[] };

export function readShape(field: Field): Shape {
  const kind = field.at("kind").text();
  switch (kind) {
    case "none":
      return check_shape(field, { kind });
    case "box":
      return check_shape(field, { kind, size_m: tuple(number, number, number)(field.at("size_m")) });
    case "sphere":
      return check_shape(field, { kind, radius_m: number(field.at("radius_m")) });
    case "cylinder":
      return check_shape(field, { kind, length_m: number(field.at("length_m")), radius_m: number(field.at("radius_m")) });
    case "round":
      return check_shape(field, {
        kind,
        length_m: number(field.at("length_m")),
        open: flag(field.at("open", false)),
        radius_m: number(field.at("radius_m")),
        top_radius_m: number(field.at("top_radius_m")),
      });
    case "capsule":
      return check_shape(field, { kind, length_m: number(field.at("length_m")), radius_m: number(field.at("radius_m")) });
    case "mesh":
      return check_shape(field, {
        kind,
        indices: list(whole)(field.at("indices")),
        positions_m: list(number)(field.at("positions_m")),
      });
    default:
      return field.unknown("kind", kind);
  }
}

/** Sorts of tables of a scene. */
export type Sort = "body" | "shape" | "joint" | "fitting" | "coupling" | "axis" | "sensor" | "component";

export function readSort(field: Field): Sort {
  return one_of("body", "shape", "joint", "fitting", "coupling", "axis", "sensor", "component")(field);
}

export interface SortFields {
  readonly fields: readonly FieldInfo[];
  readonly sort: Sort;
}

export function readSortFields(field: Field): SortFields {
  return { fields: list(readFieldInfo)(field.at("fields")), sort: readSort(field.at("sort")) };
}

/** A table of a scene as it is written. */
export interface Table {
  readonly keys: ReadonlyMap<string, Json>;
  readonly line: number;
  readonly name: string;
  readonly sort: Sort;
}

export function readTable(field: Field): Table {
  return {
    keys: map(json)(field.at("keys")),
    line: whole(field.at("line")),
    name: text(field.at("name")),
    sort: readSort(field.at("sort")),
  };
}

/** What a line is drawn to. */
export type Tip = { readonly at: string; readonly client: string } | { readonly signal: string };

/** Something that is wrong with the wiring. */
export interface Trouble {
  /** What sort of trouble. */
  readonly kind: TroubleKind;
  /** What is wrong with it, and what could be done. */
  readonly message: string;
  /** The signal. */
  readonly signal: string;
}

export function readTrouble(field: Field): Trouble {
  return {
    kind: readTroubleKind(field.at("kind")),
    message: text(field.at("message")),
    signal: text(field.at("signal")),
  };
}

/** Sorts of trouble. */
export type TroubleKind = "unconnected" | "written-twice" | "unequal-type" | "unread";

export function readTroubleKind(field: Field): TroubleKind {
  return one_of("unconnected", "written-twice", "unequal-type", "unread")(field);
}

/** What a page wants. */
export type Want =
  /** These changes, together. */
  | { readonly want: "change"; readonly edits: readonly Edit[]; readonly revision: number }
  /** Two ends connected. */
  | { readonly want: "join"; readonly one: Tip; readonly other: Tip; readonly revision: number }
  /** An end, or a signal that nobody uses, disconnected. */
  | { readonly want: "part"; readonly revision: number; readonly tip: Tip }
  /** The last change taken back. */
  | { readonly want: "undo"; readonly revision: number }
  /** The same made again. */
  | { readonly want: "redo"; readonly revision: number }
  /** The files read again, whatever was done to them. */
  | { readonly want: "reload" };

/** A declared signal. */
export interface Wired {
  /** Its name. */
  readonly name: string;
  /** Who reads it, and where to. */
  readonly readers: readonly Hook[];
  /** Its declared type. */
  readonly type: string;
  /** Its unit, if it has one. */
  readonly unit: string | null;
  /** Who writes it, and from where. */
  readonly writer: Hook;
}

export function readWired(field: Field): Wired {
  return {
    name: text(field.at("name")),
    readers: list(readHook)(field.at("readers")),
    type: text(field.at("type")),
    unit: nullable(text)(field.at("unit")),
    writer: readHook(field.at("writer")),
  };
}

/** The wiring of a scenario. */
export interface Wiring {
  /** The clients by name. */
  readonly clients: readonly Member[];
  /** Inputs of a plant's components that nobody drives: no fault, but a reason to look. */
  readonly open: readonly OpenInput[];
  /** The declared signals by name. */
  readonly signals: readonly Wired[];
  /** What is wrong, signal by signal. */
  readonly troubles: readonly Trouble[];
}

export function readWiring(field: Field): Wiring {
  return {
    clients: list(readMember)(field.at("clients", [])),
    open: list(readOpenInput)(field.at("open", [])),
    signals: list(readWired)(field.at("signals")),
    troubles: list(readTrouble)(field.at("troubles")),
  };
}
