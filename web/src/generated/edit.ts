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
  readonly name: string;
  readonly kind: string;
  readonly shape: Shape;
  readonly position_m: readonly [number, number, number];
  readonly colour: string | null;
  /** What it is made of, as its density says; nothing of one that no force moves. */
  readonly density_kg_m3: number | null;
  /** The body in whose frame it is; its place is in the world's without one. */
  readonly on: number | null;
  /** x, y, z, w. */
  readonly rotation: readonly [number, number, number, number];
  /** How much one sees through it, 0 to 1. */
  readonly transparent: number;
}

export function readBody(field: Field): Body {
  return {
    name: text(field.at("name")),
    kind: text(field.at("kind")),
    shape: readShape(field.at("shape")),
    position_m: tuple(number, number, number)(field.at("position_m")),
    colour: nullable(text)(field.at("colour")),
    density_kg_m3: nullable(number)(field.at("density_kg_m3")),
    on: nullable(whole)(field.at("on")),
    rotation: tuple(number, number, number, number)(field.at("rotation", [0.0,0.0,0.0,1.0])),
    transparent: number(field.at("transparent", 0)),
  };
}

/** A client, as far as its file says it. */
export interface Client {
  readonly name: string;
  readonly kind: string;
  readonly scene: string | null;
}

export function readClient(field: Field): Client {
  return {
    name: text(field.at("name")),
    kind: text(field.at("kind")),
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
  | { readonly do: "declare"; readonly signal: string; readonly type: string; readonly writer: string; readonly about?: string | null; readonly unit?: string | null }
  /** A signal goes that nobody refers to. */
  | { readonly do: "withdraw"; readonly signal: string }
  /** A body, a joint, a component, … */
  | { readonly do: "add"; readonly scene: string; readonly sort: Sort; readonly name: string; readonly keys: readonly (readonly [string, Given])[] }
  /** A key gets another value, or goes. */
  | { readonly do: "set"; readonly scene: string; readonly sort: Sort; readonly name: string; readonly key: string; readonly value?: Given | null }
  /** A body gets another place. */
  | { readonly do: "move"; readonly scene: string; readonly body: string; readonly position_m: readonly [number, number, number] }
  /** A thing gets another name, with all that refers to it. */
  | { readonly do: "rename"; readonly scene: string; readonly sort: Sort; readonly name: string; readonly to: string }
  /** A thing goes that nobody refers to. */
  | { readonly do: "remove"; readonly scene: string; readonly sort: Sort; readonly name: string };

/** What is known of the files as they are. */
export interface EditState {
  readonly protocol: number;
  readonly scenario: string;
  readonly revision: number;
  /** Files that somebody else has changed since. */
  readonly changed: readonly string[];
  readonly findings: readonly Finding[];
  readonly clients: readonly Client[];
  /** The signals that are declared, arrays and structures as they are written. */
  readonly signals: readonly string[];
  readonly ends: readonly End[];
  readonly scenes: readonly SceneState[];
  /** None while something keeps the wiring from being known. */
  readonly map: Wiring | null;
  readonly redo: string | null;
  /** What would be taken back, and done again. */
  readonly undo: string | null;
}

export function readEditState(field: Field): EditState {
  return {
    protocol: whole(field.at("protocol")),
    scenario: text(field.at("scenario")),
    revision: whole(field.at("revision")),
    changed: list(text)(field.at("changed")),
    findings: list(readFinding)(field.at("findings")),
    clients: list(readClient)(field.at("clients")),
    signals: list(text)(field.at("signals")),
    ends: list(readEnd)(field.at("ends")),
    scenes: list(readSceneState)(field.at("scenes")),
    map: nullable(readWiring)(field.at("map")),
    redo: nullable(text)(field.at("redo")),
    undo: nullable(text)(field.at("undo")),
  };
}

/** Where a connection can begin or end. */
export interface End {
  /** The client. */
  readonly client: string;
  /** What it is there: an input or output of a component, a variable. */
  readonly at: string;
  /** Its type. */
  readonly type: string;
  /** Whether it writes. */
  readonly gives: boolean;
  /** The signals that it is connected to. */
  readonly signals: readonly string[];
  /** What says so. */
  readonly hand: Hand;
}

export function readEnd(field: Field): End {
  return {
    client: text(field.at("client")),
    at: text(field.at("at")),
    type: text(field.at("type")),
    gives: flag(field.at("gives")),
    signals: list(text)(field.at("signals")),
    hand: readHand(field.at("hand")),
  };
}

/** A key. */
export interface FieldInfo {
  /** As it is written. */
  readonly key: string;
  /** What it is called, without unit and ending. */
  readonly name: string;
  /** What it means. */
  readonly about: string;
  /** What it may be. */
  readonly form: Form;
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
    key: text(field.at("key")),
    name: text(field.at("name")),
    about: text(field.at("about")),
    form: readForm(field.at("form")),
    needed: flag(field.at("needed")),
    part: readPart(field.at("part")),
    preset: json(field.at("preset")),
    unit: nullable(text)(field.at("unit")),
  };
}

/** Something that is wrong. */
export interface Finding {
  /** Whether a session could not start. */
  readonly is_error: boolean;
  /** What is wrong. */
  readonly message: string;
  /** The file. */
  readonly file: string | null;
  /** What to do. */
  readonly help: string | null;
  /** Its line, from 1. */
  readonly line: number | null;
}

export function readFinding(field: Field): Finding {
  return {
    is_error: flag(field.at("is_error")),
    message: text(field.at("message")),
    file: nullable(text)(field.at("file")),
    help: nullable(text)(field.at("help")),
    line: nullable(whole)(field.at("line")),
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
  | { readonly kind: "key"; readonly scene: string; readonly sort: Sort; readonly name: string; readonly key: string }
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
        scene: text(field.at("scene")),
        sort: readSort(field.at("sort")),
        name: text(field.at("name")),
        key: text(field.at("key")),
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
  /** The client. */
  readonly client: string;
  /** Outputs, inputs or variables; empty if they are not known. */
  readonly at: readonly string[];
}

export function readHook(field: Field): Hook {
  return { client: text(field.at("client")), at: list(text)(field.at("at")) };
}

export interface Kind {
  readonly name: string;
  readonly about: string;
  /** Types of inputs and outputs, by the keys that name their signals. */
  readonly types: ReadonlyMap<string, string>;
  readonly fields: readonly FieldInfo[];
}

export function readKind(field: Field): Kind {
  return {
    name: text(field.at("name")),
    about: text(field.at("about")),
    types: map(text)(field.at("types")),
    fields: list(readFieldInfo)(field.at("fields")),
  };
}

/** What can be placed: the kinds of components, and the keys of every sort of table. */
export interface Library {
  readonly protocol: number;
  readonly kinds: readonly Kind[];
  readonly sorts: readonly SortFields[];
}

export function readLibrary(field: Field): Library {
  return {
    protocol: whole(field.at("protocol")),
    kinds: list(readKind)(field.at("kinds")),
    sorts: list(readSortFields)(field.at("sorts")),
  };
}

/** A client. */
export interface Member {
  /** Its name. */
  readonly name: string;
  /** Its kind, as the scenario has it. */
  readonly kind: string;
  /** Whether what it reads and writes is known before it joins. */
  readonly known: boolean;
}

export function readMember(field: Field): Member {
  return { name: text(field.at("name")), kind: text(field.at("kind")), known: flag(field.at("known")) };
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
  readonly message: string;
  readonly references: readonly Reference[];
  readonly file: string | null;
  readonly line: number | null;
}

export function readRefusal(field: Field): Refusal {
  return {
    message: text(field.at("message")),
    references: list(readReference)(field.at("references")),
    file: nullable(text)(field.at("file")),
    line: nullable(whole)(field.at("line")),
  };
}

/** A scene, for the machine and for the forms. */
export interface SceneState {
  readonly file: string;
  readonly tables: readonly Table[];
  /** None while the scene is wrong. */
  readonly bodies: readonly Body[] | null;
}

export function readSceneState(field: Field): SceneState {
  return {
    file: text(field.at("file")),
    tables: list(readTable)(field.at("tables")),
    bodies: nullable(list(readBody))(field.at("bodies")),
  };
}

/** The shape of a body; a cylinder and a capsule lie along z. */
export type Shape =
  | { readonly kind: "none" }
  | { readonly kind: "box"; readonly size_m: readonly [number, number, number] }
  | { readonly kind: "sphere"; readonly radius_m: number }
  | { readonly kind: "cylinder"; readonly radius_m: number; readonly length_m: number }
  /** A cylinder or a cone, without ends if it is open. */
  | { readonly kind: "round"; readonly radius_m: number; readonly top_radius_m: number; readonly length_m: number; readonly open: boolean }
  | { readonly kind: "capsule"; readonly radius_m: number; readonly length_m: number }
  /** Positions are flat triples, indices flat triangles. */
  | { readonly kind: "mesh"; readonly positions_m: readonly number[]; readonly indices: readonly number[] };

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
      return check_shape(field, { kind, radius_m: number(field.at("radius_m")), length_m: number(field.at("length_m")) });
    case "round":
      return check_shape(field, {
        kind,
        radius_m: number(field.at("radius_m")),
        top_radius_m: number(field.at("top_radius_m")),
        length_m: number(field.at("length_m")),
        open: flag(field.at("open", false)),
      });
    case "capsule":
      return check_shape(field, { kind, radius_m: number(field.at("radius_m")), length_m: number(field.at("length_m")) });
    case "mesh":
      return check_shape(field, {
        kind,
        positions_m: list(number)(field.at("positions_m")),
        indices: list(whole)(field.at("indices")),
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
  readonly sort: Sort;
  readonly fields: readonly FieldInfo[];
}

export function readSortFields(field: Field): SortFields {
  return { sort: readSort(field.at("sort")), fields: list(readFieldInfo)(field.at("fields")) };
}

/** A table of a scene as it is written. */
export interface Table {
  readonly sort: Sort;
  readonly name: string;
  readonly line: number;
  readonly keys: ReadonlyMap<string, Json>;
}

export function readTable(field: Field): Table {
  return {
    sort: readSort(field.at("sort")),
    name: text(field.at("name")),
    line: whole(field.at("line")),
    keys: map(json)(field.at("keys")),
  };
}

/** What a line is drawn to. */
export type Tip = { readonly client: string; readonly at: string } | { readonly signal: string };

/** Something that is wrong with the wiring. */
export interface Trouble {
  /** What sort of trouble. */
  readonly kind: TroubleKind;
  /** The signal. */
  readonly signal: string;
  /** What is wrong with it, and what could be done. */
  readonly message: string;
}

export function readTrouble(field: Field): Trouble {
  return {
    kind: readTroubleKind(field.at("kind")),
    signal: text(field.at("signal")),
    message: text(field.at("message")),
  };
}

/** Sorts of trouble. */
export type TroubleKind = "unconnected" | "written-twice" | "unequal-type" | "unread";

export function readTroubleKind(field: Field): TroubleKind {
  return one_of("unconnected", "written-twice", "unequal-type", "unread")(field);
}

/** An input of a soft PLC that nobody drives. */
export interface UndrivenInput {
  /** The PLC. */
  readonly client: string;
  /** The file that declares the input. */
  readonly file: string;
  /** The line there, from 1. */
  readonly line: number;
  /** Which input it is, what it stays, and what could be done. */
  readonly message: string;
}

export function readUndrivenInput(field: Field): UndrivenInput {
  return {
    client: text(field.at("client")),
    file: text(field.at("file")),
    line: whole(field.at("line")),
    message: text(field.at("message")),
  };
}

/** What a page wants. */
export type Want =
  /** These changes, together. */
  | { readonly want: "change"; readonly revision: number; readonly edits: readonly Edit[] }
  /** Two ends connected. */
  | { readonly want: "join"; readonly revision: number; readonly one: Tip; readonly other: Tip }
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
  /** Its declared type. */
  readonly type: string;
  /** Who writes it, and from where. */
  readonly writer: Hook;
  /** Who reads it, and where to. */
  readonly readers: readonly Hook[];
  /** Its unit, if it has one. */
  readonly unit: string | null;
}

export function readWired(field: Field): Wired {
  return {
    name: text(field.at("name")),
    type: text(field.at("type")),
    writer: readHook(field.at("writer")),
    readers: list(readHook)(field.at("readers")),
    unit: nullable(text)(field.at("unit")),
  };
}

/** The wiring of a scenario. */
export interface Wiring {
  /** The declared signals by name. */
  readonly signals: readonly Wired[];
  /** What is wrong, signal by signal. */
  readonly troubles: readonly Trouble[];
  /** The clients by name. */
  readonly clients: readonly Member[];
  /** Inputs of a plant's components that nobody drives: no fault, but a reason to look. */
  readonly open: readonly OpenInput[];
  /** Inputs of soft PLCs that nobody drives: most often one of two names was changed. */
  readonly undriven: readonly UndrivenInput[];
}

export function readWiring(field: Field): Wiring {
  return {
    signals: list(readWired)(field.at("signals")),
    troubles: list(readTrouble)(field.at("troubles")),
    clients: list(readMember)(field.at("clients", [])),
    open: list(readOpenInput)(field.at("open", [])),
    undriven: list(readUndrivenInput)(field.at("undriven", [])),
  };
}
