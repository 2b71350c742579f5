// What of a session does not change while it runs: types and decoders. Nothing that arrives is trusted.

import { Field, flag, nullableText, number, text } from "./field";

export type Vec3 = readonly [number, number, number];
/** x, y, z, w. */
export type Quaternion = readonly [number, number, number, number];

export interface Signal {
  readonly name: string;
  readonly type: string;
  readonly writer: string;
  readonly unit: string | null;
  readonly about: string;
  readonly names: ReadonlyMap<number, string>;
}

export type Shape =
  | { readonly kind: "box"; readonly size_m: Vec3 }
  | { readonly kind: "cylinder" | "capsule"; readonly radius_m: number; readonly length_m: number }
  | { readonly kind: "round"; readonly radius_m: number; readonly top_radius_m: number; readonly length_m: number; readonly isOpen: boolean }
  | { readonly kind: "sphere"; readonly radius_m: number }
  | { readonly kind: "mesh"; readonly positions_m: readonly number[]; readonly indices: readonly number[] }
  | { readonly kind: "none" };

export interface Body {
  readonly name: string;
  readonly kind: string;
  readonly shape: Shape;
  readonly colour: string | null;
  readonly position_m: Vec3;
  readonly rotation: Quaternion;
  readonly visible: boolean;
  /** The body in whose frame it is; places are in the world's without one. */
  readonly on: number | null;
  /** How much one sees through it, 0 to 1. */
  readonly transparent: number;
}

export interface Parameter {
  readonly name: string;
  readonly value: string;
  readonly unit: string | null;
}

export interface Component {
  readonly name: string;
  readonly kind: string;
  readonly body: string | null;
  readonly signals: readonly string[];
  readonly parameters: readonly Parameter[];
  readonly failures: readonly string[];
  /** The signal that is true while a sensor sees something. */
  readonly senses: string | null;
}

export interface View {
  readonly name: string;
  readonly position_m: Vec3;
  readonly target_m: Vec3;
}

/** How bodies look while a condition holds, always without one, or by the value of the signal that it follows. */
export interface Look {
  readonly bodies: readonly number[];
  readonly when: string | null;
  readonly colour: string | null;
  readonly hidden: boolean;
  readonly transparent: number | null;
  readonly scale: number | null;
  readonly follows: number | null;
  readonly over: readonly [number, number] | null;
  readonly takes_s: number | null;
  readonly move_m: Vec3 | null;
  readonly turn_deg: Vec3 | null;
  readonly turn_about_m: Vec3 | null;
  readonly grow: "x" | "y" | "z" | null;
  readonly colours: readonly [string, string] | null;
  readonly run_m_s: Vec3 | null;
}

export const ELEMENT_KINDS = [
  "button", "switch", "selector", "slider", "joystick", "lamp", "number", "bar", "trend", "alarms",
] as const;
export type ElementKind = (typeof ELEMENT_KINDS)[number];

export interface Choice {
  readonly value: number;
  readonly label: string;
}

export interface PanelElement {
  readonly kind: ElementKind;
  readonly label: string;
  readonly signal: string | null;
  /** The second axis of a joystick. */
  readonly signal_y: string | null;
  /** The component and its mode of failure, in place of a signal. */
  readonly failure: readonly [string, string] | null;
  /** The number of a fault on the way of signals, in place of a signal. */
  readonly disturbance: number | null;
  /** Column and row, from 0. */
  readonly at: readonly [number, number];
  readonly span: readonly [number, number];
  readonly min: number;
  readonly max: number;
  readonly colour: string | null;
  readonly choices: readonly Choice[];
  readonly toggles: boolean;
}

/** A panel that is shown while a signal has a value. */
export interface PanelPage {
  readonly signal: string;
  readonly value: number;
}

export interface Panel {
  readonly name: string;
  readonly seat: string;
  /** Nothing for a panel that is always shown. */
  readonly page: PanelPage | null;
  readonly columns: number;
  readonly rows: number;
  /** Where the picture is that lies behind it. */
  readonly picture: string | null;
  readonly elements: readonly PanelElement[];
}

export interface SourceLine {
  /** From 1. */
  readonly line: number;
  readonly variables: readonly string[];
  /** Numbers of variables of the PLC. */
  readonly inner: readonly number[];
}

/** A PLC whose variables can be looked at. Variables of all PLCs are numbered through. */
export interface Plc {
  readonly client: string;
  readonly variables: readonly { readonly path: string; readonly type: string }[];
}

export interface Source {
  readonly path: string;
  readonly text: string;
  readonly lines: readonly SourceLine[];
}

/** The lesson that a session is, on the page of one of its two people. */
export interface Lesson {
  readonly role: "trainee" | "trainer";
  readonly lesson: string;
  readonly about: string | null;
  readonly starts: readonly string[];
}

export interface DrawingPin {
  readonly name: string;
  readonly isOutput: boolean;
  readonly marks: readonly string[];
  /** The path of the variable that it gives, within the unit. */
  readonly state: string | null;
  readonly at: readonly [number, number];
}

export interface DrawingElement {
  readonly id: string;
  readonly kind: string;
  readonly text: string;
  readonly instance: string | null;
  /** The path of the variable that tells its state, within the unit. */
  readonly state: string | null;
  readonly marks: readonly string[];
  readonly at: readonly [number, number];
  readonly size: readonly [number, number];
  readonly pins: readonly DrawingPin[];
  readonly line: number;
}

/** From an output to an input, each an element and a pin. */
export interface DrawingWire {
  readonly from: readonly [number, number];
  readonly to: readonly [number, number];
  readonly points: readonly (readonly [number, number])[];
  readonly line: number;
}

/** A body that is drawn, as it is laid out in its file. */
export interface Drawing {
  readonly path: string;
  readonly unit: string;
  readonly part: string | null;
  readonly language: "ladder" | "blocks" | "chart";
  readonly elements: readonly DrawingElement[];
  readonly wires: readonly DrawingWire[];
  /** What there is of its unit. */
  readonly instances: readonly { readonly client: string; readonly path: string }[];
  /** The paths of all states, in the order of their values. */
  readonly states: readonly string[];
}

/** A map, as far as it is known before it is seen. */
export interface MapInfo {
  readonly name: string;
  readonly title: string;
  readonly unit: string;
  readonly client: string;
  /** The values of the scale's ends; those of the map without them. */
  readonly scale: readonly [number, number] | null;
  /** From the least value to the greatest, as `#rrggbb`. */
  readonly colours: readonly string[];
}

/** The parts of a session that do not change while it runs. */
export interface Session {
  readonly title: string;
  readonly scenario: string;
  readonly step_ns: number;
  readonly until_ns: number | null;
  readonly live: boolean;
  readonly training: Lesson | null;
  readonly signals: readonly Signal[];
  readonly bodies: readonly Body[];
  readonly components: readonly Component[];
  readonly views: readonly View[];
  readonly looks: readonly Look[];
  readonly panels: readonly Panel[];
  readonly expectations: readonly { readonly name: string; readonly text: string }[];
  readonly sources: readonly Source[];
  readonly drawings: readonly Drawing[];
  readonly plcs: readonly Plc[];
  readonly maps: readonly MapInfo[];
}

const vec3 = (field: Field): Vec3 => field.numbers(3) as unknown as Vec3;

function shape(field: Field): Shape {
  const kind = field.at("kind").text();
  switch (kind) {
    case "box":
      return { kind, size_m: vec3(field.at("size_m")) };
    case "cylinder":
    case "capsule":
      return { kind, radius_m: field.at("radius_m").number(), length_m: field.at("length_m").number() };
    case "round":
      return {
        kind, radius_m: field.at("radius_m").number(), top_radius_m: field.at("top_radius_m").number(),
        length_m: field.at("length_m").number(), isOpen: field.at("open").or(false, flag),
      };
    case "sphere":
      return { kind, radius_m: field.at("radius_m").number() };
    case "mesh":
      return mesh(field);
    case "none":
      return { kind };
    default:
      return field.fail(`has the shape \`${kind}\`, which this page does not draw`);
  }
}

function mesh(field: Field): Shape {
  const positions_m = field.at("positions_m").list(number);
  const indices = field.at("indices").list(number);
  const vertices = positions_m.length / 3;
  if (!Number.isInteger(vertices)) field.fail("has positions that are not triples");
  if (indices.length % 3 !== 0) field.fail("has indices that are not triangles");
  for (const index of indices) {
    if (!Number.isInteger(index) || index < 0 || index >= vertices) field.fail(`has no vertex ${index}`);
  }
  return { kind: "mesh", positions_m, indices };
}

function signal(field: Field): Signal {
  return {
    name: field.at("name").text(),
    type: field.at("type").text(),
    writer: field.at("writer").text(),
    unit: nullableText(field.at("unit")),
    about: field.at("about").or("", text),
    names: new Map(field.at("names").or<[number, string][]>([], (names) =>
      names.entries((key, item) => [Number(key), item.text()]))),
  };
}

/** A body where the scene has it. */
export function body(field: Field): Body {
  return {
    name: field.at("name").text(),
    kind: field.at("kind").text(),
    shape: shape(field.at("shape")),
    colour: nullableText(field.at("colour")),
    position_m: vec3(field.at("position_m")),
    rotation: field.at("rotation").or<Quaternion>([0, 0, 0, 1], (item) => item.numbers(4) as unknown as Quaternion),
    visible: field.at("visible").or(true, flag),
    on: field.at("on").or<number | null>(null, number),
    transparent: field.at("transparent").or(0, number),
  };
}

function axis(field: Field): "x" | "y" | "z" {
  const one = field.text();
  return one === "x" || one === "y" || one === "z" ? one : field.fail(`is \`${one}\`: x, y or z`);
}

function look(field: Field): Look {
  const maybe = <T>(key: string, read: (item: Field) => T): T | null => field.at(key).or<T | null>(null, read);
  const colours = maybe("colours", (all) => all.list(text));
  const [begin, end] = colours ?? [];
  return {
    bodies: field.at("bodies").list(number),
    when: maybe("when", text),
    colour: maybe("colour", text),
    hidden: field.at("hidden").or(false, flag),
    transparent: maybe("transparent", number),
    scale: maybe("scale", number),
    follows: maybe("follows", number),
    over: maybe("over", (item) => item.numbers(2) as unknown as [number, number]),
    takes_s: maybe("takes_s", number),
    move_m: maybe("move_m", vec3),
    turn_deg: maybe("turn_deg", vec3),
    turn_about_m: maybe("turn_about_m", vec3),
    grow: maybe("grow", axis),
    colours: begin === undefined || end === undefined ? null : [begin, end],
    run_m_s: maybe("run_m_s", vec3),
  };
}

function component(field: Field): Component {
  return {
    name: field.at("name").text(),
    kind: field.at("kind").text(),
    body: nullableText(field.at("body")),
    signals: field.at("signals").or<string[]>([], (all) => all.list(text)),
    parameters: field.at("parameters").or<Parameter[]>([], (all) => all.list((item) => ({
      name: item.at("name").text(),
      value: item.at("value").shown(),
      unit: nullableText(item.at("unit")),
    }))),
    failures: field.at("failures").or<string[]>([], (all) => all.list((item) => item.at("name").text())),
    senses: nullableText(field.at("senses")),
  };
}

function element(field: Field): PanelElement {
  const kind = field.at("kind").text();
  const known = ELEMENT_KINDS.find((one) => one === kind);
  return {
    kind: known ?? field.fail(`is a \`${kind}\`, which this page does not have`),
    label: field.at("label").text(),
    signal: nullableText(field.at("signal")),
    signal_y: nullableText(field.at("signal_y")),
    failure: field.at("failure").or<readonly [string, string] | null>(null, failure),
    disturbance: field.at("disturbance").or<number | null>(null, number),
    at: field.at("at").numbers(2) as unknown as [number, number],
    span: field.at("span").or<readonly [number, number]>([1, 1], (item) => item.numbers(2) as unknown as [number, number]),
    min: field.at("min").or(0, number),
    max: field.at("max").or(1, number),
    colour: nullableText(field.at("colour")),
    choices: field.at("choices").or<Choice[]>([], (all) => all.list((item) => ({
      value: item.at("value").number(),
      label: item.at("label").text(),
    }))),
    toggles: field.at("mode").or("momentary", text) === "toggle",
  };
}

function failure(field: Field): readonly [string, string] {
  const [component, mode, ...more] = field.list(text);
  if (component === undefined || mode === undefined || more.length > 0) field.fail("is not a component and a mode");
  return [component, mode];
}

function lesson(field: Field): Lesson {
  const role = field.at("role").text();
  return {
    role: role === "trainee" || role === "trainer" ? role : field.at("role").fail(`is \`${role}\`: trainee or trainer`),
    lesson: field.at("lesson").text(),
    about: nullableText(field.at("about")),
    starts: field.at("starts").or<string[]>([], (all) => all.list(text)),
  };
}

function panel(field: Field): Panel {
  return {
    name: field.at("name").text(),
    seat: field.at("seat").text(),
    page: field.at("page").or<PanelPage | null>(null, (item) => ({ signal: item.at("signal").text(), value: item.at("value").number() })),
    columns: field.at("columns").number(),
    rows: field.at("rows").number(),
    picture: nullableText(field.at("picture")),
    elements: field.at("elements").list(element),
  };
}

const texts = (field: Field): string[] => field.list(text);
const pair = (field: Field): [number, number] => field.numbers(2) as unknown as [number, number];

function drawing(field: Field): Drawing {
  const language = field.at("language").text();
  const elements = field.at("elements").list<DrawingElement>((item) => ({
    id: item.at("id").text(), kind: item.at("kind").text(), text: item.at("text").or("", text),
    instance: nullableText(item.at("instance")), state: nullableText(item.at("state")),
    marks: item.at("marks").or<string[]>([], texts), at: pair(item.at("at")), size: pair(item.at("size")),
    pins: item.at("pins").list((pin) => ({
      name: pin.at("name").or("", text), isOutput: pin.at("output").or(false, flag), marks: pin.at("marks").or<string[]>([], texts),
      state: nullableText(pin.at("state")), at: pair(pin.at("at")),
    })),
    line: item.at("line").number(),
  }));
  const end = (item: Field): [number, number] => {
    const [element, pin] = pair(item);
    return elements[element]?.pins[pin] === undefined ? item.fail("names a pin that is not there") : [element, pin];
  };
  return {
    path: field.at("path").text(),
    unit: field.at("unit").text(),
    part: nullableText(field.at("part")),
    language: language === "ladder" || language === "blocks" || language === "chart" ? language : field.at("language").fail(`is \`${language}\``),
    elements,
    wires: field.at("wires").list((item) => ({
      from: end(item.at("from")), to: end(item.at("to")), points: item.at("points").list(pair), line: item.at("line").number(),
    })),
    instances: field.at("instances").list((item) => ({ client: item.at("client").text(), path: item.at("path").text() })),
    states: field.at("states").list(text),
  };
}

/** A colour of a map: of this form and no other, as it becomes a style. */
function colour(field: Field): string {
  const one = field.text();
  return /^#[0-9a-f]{6}$/.test(one) ? one : field.fail(`is \`${one}\`: a colour is written as #0a1a52`);
}

function map(field: Field): MapInfo {
  return {
    name: field.at("name").text(),
    title: field.at("title").text(),
    unit: field.at("unit").or("", text),
    client: field.at("client").text(),
    scale: field.at("scale").or<readonly [number, number] | null>(null, pair),
    colours: field.at("colours").list(colour),
  };
}

/** Reads the structure of a session; throws [`ProtocolError`] with the place that is wrong. */
export function decodeSession(value: unknown): Session {
  const root = new Field(value, "");
  const version = root.at("protocol").number();
  if (version !== 1) root.at("protocol").fail(`is ${version}; this page speaks 1`);
  const list = <T>(key: string, read: (item: Field) => T): T[] => root.at(key).or<T[]>([], (all) => all.list(read));
  return {
    title: root.at("title").text(),
    scenario: root.at("scenario").text(),
    step_ns: root.at("step_ns").number(),
    until_ns: root.at("until_ns").or<number | null>(null, number),
    live: root.at("live").or(true, flag),
    training: root.at("training").or<Lesson | null>(null, lesson),
    signals: root.at("signals").list(signal),
    bodies: list("bodies", body),
    components: list("components", component),
    views: list("views", (item) => ({
      name: item.at("name").text(),
      position_m: vec3(item.at("position_m")),
      target_m: vec3(item.at("target_m")),
    })),
    looks: list("looks", look),
    panels: list("panels", panel),
    expectations: list("expectations", (item) => ({ name: item.at("name").text(), text: item.at("text").or("", text) })),
    sources: list("sources", (item) => ({
      path: item.at("path").text(),
      text: item.at("text").text(),
      lines: item.at("lines").or<SourceLine[]>([], (all) => all.list((line) => ({
        line: line.at("line").number(),
        variables: line.at("variables").list(text),
        inner: line.at("inner").or<number[]>([], (all) => all.list(number)),
      }))),
    })),
    drawings: list("drawings", drawing),
    plcs: list("plcs", (item) => ({
      client: item.at("client").text(),
      variables: item.at("variables").list((one) => ({ path: one.at("path").text(), type: one.at("type").text() })),
    })),
    maps: list("maps", map),
  };
}
