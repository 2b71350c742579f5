// What the server says and what the page asks: types and decoders. Nothing that arrives is trusted.

/** A place that cannot be read, and why. */
export class ProtocolError extends Error {
  constructor(
    readonly place: string,
    readonly reason: string,
  ) {
    super(`${place}: ${reason}`);
    this.name = "ProtocolError";
  }
}

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
}

/** What is new of the PLC's variables. */
export interface Variables {
  readonly values: readonly (readonly [number, string])[];
  readonly forced: readonly number[];
  /** File and line of what has been executed. */
  readonly executed: readonly (readonly [string, number])[];
}

/** A value of JSON with the place that it was found at. */
export class Field {
  constructor(
    readonly value: unknown,
    readonly place: string,
  ) {}

  fail(reason: string): never {
    throw new ProtocolError(this.place, reason);
  }

  at(key: string): Field {
    if (typeof this.value !== "object" || this.value === null || Array.isArray(this.value)) this.fail("is not an object");
    return new Field((this.value as Record<string, unknown>)[key], this.place === "" ? key : `${this.place}.${key}`);
  }

  get isAbsent(): boolean {
    return this.value === undefined || this.value === null;
  }

  text(): string {
    return typeof this.value === "string" ? this.value : this.fail("is not a text");
  }

  number(): number {
    return typeof this.value === "number" && Number.isFinite(this.value) ? this.value : this.fail("is not a number");
  }

  flag(): boolean {
    return typeof this.value === "boolean" ? this.value : this.fail("is not true or false");
  }

  list<T>(read: (item: Field) => T): T[] {
    if (!Array.isArray(this.value)) this.fail("is not a list");
    return this.value.map((item, index) => read(new Field(item, `${this.place}[${index}]`)));
  }

  entries<T>(read: (key: string, item: Field) => T): T[] {
    if (typeof this.value !== "object" || this.value === null) this.fail("is not an object");
    return Object.keys(this.value).map((key) => read(key, this.at(key)));
  }

  /** What `read` makes of it, or `fallback` where the optional field is not there. */
  or<T>(fallback: T, read: (field: Field) => T): T {
    return this.isAbsent ? fallback : read(this);
  }

  /** Exactly `count` numbers. */
  numbers(count: number): number[] {
    const all = this.list((item) => item.number());
    return all.length === count ? all : this.fail(`has ${all.length} numbers instead of ${count}`);
  }

  /** A parameter as it is shown. */
  shown(): string {
    if (typeof this.value === "string") return this.value;
    return JSON.stringify(this.value) ?? this.fail("is not there");
  }
}

const text = (field: Field): string => field.text();
const number = (field: Field): number => field.number();
const flag = (field: Field): boolean => field.flag();
const nullableText = (field: Field): string | null => field.or<string | null>(null, text);
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
  };
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
    case "forked":
      return { type, t_ns: root.at("t_ns").number(), url: page(root.at("url")) };
    case "error":
      return { type, message: root.at("message").text() };
    default:
      return root.at("type").fail(`is \`${type}\`, which this page does not know`);
  }
}

/** Bodies and values of one step. */
export interface Picture {
  readonly isHeld: boolean;
  readonly isPast: boolean;
  readonly step: number;
  readonly t_ns: number;
  /** Pairs of signal and value. */
  readonly values: readonly (readonly [number, number])[];
  readonly poses: readonly Pose[];
}

export interface Pose {
  readonly body: number;
  /** Nothing while the body is away. */
  readonly place: { readonly position_m: Vec3; readonly rotation: Quaternion } | null;
}

const HEAD_BYTES = 24;
const VALUE_BYTES = 16;
const POSE_BYTES = 32;

/** Reads a binary picture of a session with so many signals and bodies; throws [`ProtocolError`]. */
export function decodePicture(data: ArrayBuffer, signals: number, bodies: number): Picture {
  if (data.byteLength < HEAD_BYTES) throw new ProtocolError("picture", `has ${data.byteLength} bytes, its head alone has ${HEAD_BYTES}`);
  const view = new DataView(data);
  if (view.getUint8(0) !== 1) throw new ProtocolError("picture", `is of kind ${view.getUint8(0)}; this page reads 1`);
  const valueCount = view.getUint16(2, true);
  const poseCount = view.getUint32(4, true);
  const expected = HEAD_BYTES + valueCount * VALUE_BYTES + poseCount * POSE_BYTES;
  if (data.byteLength !== expected) throw new ProtocolError("picture", `has ${data.byteLength} bytes instead of ${expected}`);
  const flags = view.getUint8(1);
  const values: (readonly [number, number])[] = [];
  for (let index = 0, at = HEAD_BYTES; index < valueCount; index += 1, at += VALUE_BYTES) {
    const one = view.getUint32(at, true);
    if (one >= signals) throw new ProtocolError("picture", `names signal ${one} of ${signals}`);
    values.push([one, view.getFloat64(at + 8, true)]);
  }
  const poses: Pose[] = [];
  for (let index = 0, at = HEAD_BYTES + valueCount * VALUE_BYTES; index < poseCount; index += 1, at += POSE_BYTES) {
    poses.push(decodePose(view, at, bodies));
  }
  return {
    isHeld: (flags & 1) !== 0,
    isPast: (flags & 2) !== 0,
    step: Number(view.getBigUint64(8, true)),
    t_ns: Number(view.getBigUint64(16, true)),
    values,
    poses,
  };
}

function decodePose(view: DataView, at: number, bodies: number): Pose {
  const body = view.getUint32(at, true);
  if (body >= bodies) throw new ProtocolError("picture", `names body ${body} of ${bodies}`);
  const f = (place: number): number => view.getFloat32(at + 4 + place * 4, true);
  if (Number.isNaN(f(0))) return { body, place: null };
  return { body, place: { position_m: [f(0), f(1), f(2)], rotation: [f(3), f(4), f(5), f(6)] } };
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
  | { readonly type: "variable"; readonly variable: number; readonly action: "write" | "force" | "release"; readonly value: string }
  | { readonly type: "force"; readonly signal: number; readonly value: string | null }
  | { readonly type: "fork"; readonly t_ns: number };
