// Generated from the types of the server; see web/README.md. Do not edit.

import { flag, list, map, matching, nullable, number, numbered, one_of, set, text, tuple, whole, type Field } from "../field";
import { check_axis, check_drawing, check_shape } from "../checks";

export const PROTOCOL = 1;

/** What is done with a variable. */
export type Action = "write" | "force" | "release";

/** An alarm of the scenario. */
export interface Alarm {
  readonly name: string;
  readonly priority: Priority;
}

export function readAlarm(field: Field): Alarm {
  return { name: text(field.at("name")), priority: readPriority(field.at("priority")) };
}

/** A change of an alarm. */
export interface AlarmChange {
  readonly alarm: number;
  readonly t_ns: number;
  readonly fate: Fate;
  readonly until_ns: number | null;
}

export function readAlarmChange(field: Field): AlarmChange {
  return {
    alarm: whole(field.at("alarm")),
    t_ns: whole(field.at("t_ns")),
    fate: readFate(field.at("fate")),
    until_ns: nullable(whole)(field.at("until_ns")),
  };
}

/** What the page asks. */
export type Ask =
  /** The signals that pictures have from now on; the next picture has all of them. */
  | { readonly type: "subscribe"; readonly signals: readonly number[] }
  /** An operator's input at the next step boundary. */
  | { readonly type: "write"; readonly signal: number; readonly value: number }
  /** Holds virtual time, lets it go on, makes one step; or ends the session. */
  | { readonly type: "operate"; readonly operation: Verb }
  /** Resets the session at the next step boundary, by a key of this panel. */
  | { readonly type: "reset"; readonly panel: string }
  /** Takes or leaves a seat. */
  | { readonly type: "seat"; readonly panel: string; readonly take: boolean }
  /** Fails a component, or repairs it. */
  | { readonly type: "fail"; readonly component: string; readonly failure: string; readonly active: boolean }
  /** Begins a fault on the way of signals, or ends it; all of its signals at one boundary. It is named by its number on the panels. */
  | { readonly type: "disturb"; readonly disturbance: number; readonly active: boolean }
  /** How the lesson continues, on the trainer's page: from its start, from an earlier moment, or from a prepared state. */
  | ({ readonly type: "train" } & ({ readonly turn: "repeat" } | { readonly turn: "back"; readonly t_ns: number } | { readonly turn: "jump"; readonly start: string }))
  /** Shows this viewer a moment of the past: the last step at or before it. What it asked for before counts no more. */
  | { readonly type: "show"; readonly t_ns: number }
  /** Shows a view of the scenario to all viewers; from a trainer's seat where there is one, of a lesson on the trainer's page. */
  | { readonly type: "view"; readonly view: string }
  /** The values of a drawing's instance from now on; `null` for none. */
  | { readonly type: "draw"; readonly instance: number; readonly drawing?: number | null }
  /** The PLCs' own variables that `variables` has from now on. */
  | { readonly type: "watch"; readonly variables: readonly number[] }
  /** These maps from now on. */
  | { readonly type: "maps"; readonly maps: readonly number[] }
  /** Writes, forces or releases a variable of a PLC; the value is a literal of the variable's type. */
  | { readonly type: "variable"; readonly variable: number; readonly action: Action; readonly value: string }
  /** Forces a signal; releases it without a value. */
  | { readonly type: "force"; readonly signal: number; readonly value?: string | null }
  /** Acknowledges these alarms, for all viewers. */
  | { readonly type: "acknowledge"; readonly alarms: readonly number[] }
  /** Puts an alarm aside for so long in virtual time, for all viewers; takes it back without a time. */
  | { readonly type: "shelve"; readonly alarm: number; readonly for_s?: number | null }
  /** A parameter of a component takes another value; that of the scene again without one. */
  | { readonly type: "parameter"; readonly component: string; readonly parameter: string; readonly value?: string | null }
  /** What operators have done so far, as a case of this name; `save` writes it into the scenario's file of cases. */
  | { readonly type: "case"; readonly name: string; readonly save: boolean }
  /** What signals did in a span of the past, in so many parts: of each the first, the least, the greatest and the last value. */
  | { readonly type: "trace"; readonly signals: readonly number[]; readonly from_ns: number; readonly until_ns: number; readonly parts: number }
  /** Shows this viewer the live edge again. */
  | { readonly type: "live" }
  /** Starts a session from a moment of the past, beside this one; it ends as this one does, or at `until_ns`. */
  | { readonly type: "fork"; readonly t_ns: number; readonly until_ns?: number | null };

/** An axis of a map: where each of its cells begins, and where the last one ends, in rising order. */
export interface Axis {
  readonly name: string;
  readonly edges: readonly number[];
}

export function readAxis(field: Field): Axis {
  return check_axis(field, { name: text(field.at("name")), edges: list(number)(field.at("edges")) });
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

/** Whether a button stays where it is put. */
export type ButtonMode = "toggle" | "momentary";

export function readButtonMode(field: Field): ButtonMode {
  return one_of("toggle", "momentary")(field);
}

/** A value of a selector. */
export interface Choice {
  readonly value: number;
  readonly label: string;
}

export function readChoice(field: Field): Choice {
  return { value: whole(field.at("value")), label: text(field.at("label")) };
}

/** A component of a plant. */
export interface Component {
  readonly name: string;
  readonly kind: string;
  readonly body: string | null;
  readonly failures: readonly Failure[];
  readonly parameters: readonly Parameter[];
  /** Its inputs and outputs that have a signal: the key, and the signal's name. */
  readonly pins: readonly (readonly [string, string])[];
  /** Where it is in the scene, for its shape. */
  readonly place: Place | null;
  /** The signal that is true while a sensor sees something; its body is lit then. */
  readonly senses: string | null;
  /** The names of the signals that it reads and writes. */
  readonly signals: readonly string[];
}

export function readComponent(field: Field): Component {
  return {
    name: text(field.at("name")),
    kind: text(field.at("kind")),
    body: nullable(text)(field.at("body")),
    failures: list(readFailure)(field.at("failures", [])),
    parameters: list(readParameter)(field.at("parameters", [])),
    pins: list(tuple(text, text))(field.at("pins", [])),
    place: nullable(readPlace)(field.at("place")),
    senses: nullable(text)(field.at("senses")),
    signals: list(text)(field.at("signals", [])),
  };
}

/** A body of a unit that is drawn, as it is laid out in its file. */
export interface Drawing {
  readonly path: string;
  readonly unit: string;
  readonly language: DrawingLanguage;
  readonly elements: readonly DrawingElement[];
  readonly wires: readonly DrawingWire[];
  /** What there is of its unit. */
  readonly instances: readonly Instance[];
  /** The paths of all states within the unit, in the order of their values. */
  readonly states: readonly string[];
  readonly part: string | null;
}

export function readDrawing(field: Field): Drawing {
  return check_drawing(field, {
    path: text(field.at("path")),
    unit: text(field.at("unit")),
    language: readDrawingLanguage(field.at("language")),
    elements: list(readDrawingElement)(field.at("elements")),
    wires: list(readDrawingWire)(field.at("wires")),
    instances: list(readInstance)(field.at("instances")),
    states: list(text)(field.at("states")),
    part: nullable(text)(field.at("part")),
  });
}

export interface DrawingElement {
  readonly id: string;
  readonly kind: string;
  readonly at: readonly [number, number];
  readonly size: readonly [number, number];
  readonly pins: readonly DrawingPin[];
  readonly line: number;
  readonly instance: string | null;
  readonly marks: readonly string[];
  /** The path of the variable that is its state, within the unit. */
  readonly state: string | null;
  readonly text: string;
}

export function readDrawingElement(field: Field): DrawingElement {
  return {
    id: text(field.at("id")),
    kind: text(field.at("kind")),
    at: tuple(number, number)(field.at("at")),
    size: tuple(number, number)(field.at("size")),
    pins: list(readDrawingPin)(field.at("pins")),
    line: whole(field.at("line")),
    instance: nullable(text)(field.at("instance")),
    marks: list(text)(field.at("marks", [])),
    state: nullable(text)(field.at("state")),
    text: text(field.at("text", "")),
  };
}

/** How a body is drawn. */
export type DrawingLanguage = "ladder" | "blocks" | "chart";

export function readDrawingLanguage(field: Field): DrawingLanguage {
  return one_of("ladder", "blocks", "chart")(field);
}

export interface DrawingPin {
  readonly at: readonly [number, number];
  readonly marks: readonly string[];
  readonly name: string;
  readonly output: boolean;
  /** The path of the variable that it gives, within the unit. */
  readonly state: string | null;
}

export function readDrawingPin(field: Field): DrawingPin {
  return {
    at: tuple(number, number)(field.at("at")),
    marks: list(text)(field.at("marks", [])),
    name: text(field.at("name", "")),
    output: flag(field.at("output", false)),
    state: nullable(text)(field.at("state")),
  };
}

/** From an output to an input, each an element and one of its pins. */
export interface DrawingWire {
  readonly from: readonly [number, number];
  readonly to: readonly [number, number];
  readonly points: readonly (readonly [number, number])[];
  readonly line: number;
}

export function readDrawingWire(field: Field): DrawingWire {
  return {
    from: tuple(whole, whole)(field.at("from")),
    to: tuple(whole, whole)(field.at("to")),
    points: list(tuple(number, number))(field.at("points")),
    line: whole(field.at("line")),
  };
}

/** Real PLCs on their way to where an attempt begins. */
export interface Drive {
  /** Names of the clients that they stand in for, at least one. */
  readonly plcs: readonly string[];
  /** The prepared state from which the attempt begins. */
  readonly start: string;
  /** How far they are, in virtual time from their cold start. */
  readonly at_ns: number;
  /** Where the attempt begins. */
  readonly to_ns: number;
}

export function readDrive(field: Field): Drive {
  return {
    plcs: list(text)(field.at("plcs")),
    start: text(field.at("start")),
    at_ns: whole(field.at("at_ns")),
    to_ns: whole(field.at("to_ns")),
  };
}

/** A joint that a component drives. */
export interface DrivenJoint {
  /** Whether it turns; it slides if not. */
  readonly turns: boolean;
  readonly anchor_m: readonly [number, number, number];
  readonly axis: readonly [number, number, number];
  readonly ahead: number | null;
  /** How far it may go from where the scene has it, m or rad; nothing where it has no end. */
  readonly back: number | null;
  /** The body in whose frame it is; the ground's without one. */
  readonly parent: string | null;
}

export function readDrivenJoint(field: Field): DrivenJoint {
  return {
    turns: flag(field.at("turns")),
    anchor_m: tuple(number, number, number)(field.at("anchor_m")),
    axis: tuple(number, number, number)(field.at("axis")),
    ahead: nullable(number)(field.at("ahead")),
    back: nullable(number)(field.at("back")),
    parent: nullable(text)(field.at("parent")),
  };
}

/** What an element is. */
export type ElementKind = "button" | "emergency-stop" | "switch" | "selector" | "slider" | "joystick" | "lamp" | "number" | "bar" | "trend" | "alarms";

export function readElementKind(field: Field): ElementKind {
  return one_of("button", "emergency-stop", "switch", "selector", "slider", "joystick", "lamp", "number", "bar", "trend", "alarms")(field);
}

/** An expectation of the scenario. */
export interface Expectation {
  readonly name: string;
  readonly text: string;
}

export function readExpectation(field: Field): Expectation {
  return { name: text(field.at("name")), text: text(field.at("text", "")) };
}

/** A mode in which a component can fail. */
export interface Failure {
  readonly name: string;
}

export function readFailure(field: Field): Failure {
  return { name: text(field.at("name")) };
}

/** What has become of an alarm. */
export type Fate = "on" | "off" | "acknowledged" | "shelved" | "unshelved";

export function readFate(field: Field): Fate {
  return one_of("on", "off", "acknowledged", "shelved", "unshelved")(field);
}

/** A mistake, and how many are forgiven. */
export interface Forgiven {
  readonly name: string;
  readonly at_most: number;
}

export function readForgiven(field: Field): Forgiven {
  return { name: text(field.at("name")), at_most: whole(field.at("at_most")) };
}

export interface Instance {
  readonly client: string;
  readonly path: string;
}

export function readInstance(field: Field): Instance {
  return { client: text(field.at("client")), path: text(field.at("path")) };
}

/** What must hold, and whether it did. */
export interface Kept {
  readonly name: string;
  readonly met: boolean;
  /** When it was first violated. */
  readonly at_ns: number | null;
}

export function readKept(field: Field): Kept {
  return {
    name: text(field.at("name")),
    met: flag(field.at("met")),
    at_ns: nullable(whole)(field.at("at_ns")),
  };
}

/** What a key does to the session. */
export type KeyAction = "reset";

export function readKeyAction(field: Field): KeyAction {
  return one_of("reset")(field);
}

/** The lesson that a session is, on the page of one of its two people. */
export interface Lesson {
  readonly role: Role;
  readonly lesson: string;
  readonly about: string | null;
  /** What must hold to pass it, by the names of its expectations. */
  readonly asked: readonly string[];
  /** What must not be done more often than so. */
  readonly mistakes: readonly Forgiven[];
  /** Prepared states to jump to; none on the trainee's page. */
  readonly starts: readonly string[];
}

export function readLesson(field: Field): Lesson {
  return {
    role: readRole(field.at("role")),
    lesson: text(field.at("lesson")),
    about: nullable(text)(field.at("about")),
    asked: list(text)(field.at("asked", [])),
    mistakes: list(readForgiven)(field.at("mistakes", [])),
    starts: list(text)(field.at("starts", [])),
  };
}

/** A cost of the lesson, in its unit. */
export interface LessonCost {
  readonly name: string;
  readonly value: number;
  readonly unit: string | null;
}

export function readLessonCost(field: Field): LessonCost {
  return {
    name: text(field.at("name")),
    value: number(field.at("value")),
    unit: nullable(text)(field.at("unit")),
  };
}

/** What came of an attempt. */
export interface LessonResult {
  readonly passed: boolean;
  readonly lasted_ns: number;
  readonly malfunctions: readonly Met[];
  readonly expectations: readonly Kept[];
  readonly mistakes: readonly Slip[];
  readonly costs: readonly LessonCost[];
  /** Whether it was brought to its end, if it has one. */
  readonly done: boolean | null;
}

export function readLessonResult(field: Field): LessonResult {
  return {
    passed: flag(field.at("passed")),
    lasted_ns: whole(field.at("lasted_ns")),
    malfunctions: list(readMet)(field.at("malfunctions")),
    expectations: list(readKept)(field.at("expectations")),
    mistakes: list(readSlip)(field.at("mistakes")),
    costs: list(readLessonCost)(field.at("costs")),
    done: nullable(flag)(field.at("done")),
  };
}

/** How bodies look while a condition holds, always without one, or by the value of the signal that it follows; bodies and the signal by their places. */
export interface Look {
  readonly bodies: readonly number[];
  readonly colour: string | null;
  readonly colours: readonly [string, string] | null;
  readonly follows: number | null;
  readonly grow: LookAxis | null;
  readonly hidden: boolean;
  readonly move_m: readonly [number, number, number] | null;
  readonly over: readonly [number, number] | null;
  readonly run_m_s: readonly [number, number, number] | null;
  readonly scale: number | null;
  readonly takes_s: number | null;
  readonly transparent: number | null;
  readonly turn_about_m: readonly [number, number, number] | null;
  readonly turn_deg: readonly [number, number, number] | null;
  readonly when: string | null;
}

export function readLook(field: Field): Look {
  return {
    bodies: list(whole)(field.at("bodies")),
    colour: nullable(text)(field.at("colour")),
    colours: nullable(tuple(text, text))(field.at("colours")),
    follows: nullable(whole)(field.at("follows")),
    grow: nullable(readLookAxis)(field.at("grow")),
    hidden: flag(field.at("hidden", false)),
    move_m: nullable(tuple(number, number, number))(field.at("move_m")),
    over: nullable(tuple(number, number))(field.at("over")),
    run_m_s: nullable(tuple(number, number, number))(field.at("run_m_s")),
    scale: nullable(number)(field.at("scale")),
    takes_s: nullable(number)(field.at("takes_s")),
    transparent: nullable(number)(field.at("transparent")),
    turn_about_m: nullable(tuple(number, number, number))(field.at("turn_about_m")),
    turn_deg: nullable(tuple(number, number, number))(field.at("turn_deg")),
    when: nullable(text)(field.at("when")),
  };
}

/** The axis along which a body grows. */
export type LookAxis = "x" | "y" | "z";

export function readLookAxis(field: Field): LookAxis {
  return one_of("x", "y", "z")(field);
}

/** A map, as far as it is known before it is seen. */
export interface MapInfo {
  readonly name: string;
  readonly title: string;
  readonly client: string;
  /** From the least value to the greatest, each written as `#0a1a52`. */
  readonly colours: readonly string[];
  /** The values of the scale's ends; those of the map if absent. */
  readonly scale: readonly [number, number] | null;
  readonly unit: string;
}

export function readMapInfo(field: Field): MapInfo {
  return {
    name: text(field.at("name")),
    title: text(field.at("title")),
    client: text(field.at("client")),
    colours: list(matching(/^#[0-9a-f]{6}$/))(field.at("colours")),
    scale: nullable(tuple(number, number))(field.at("scale")),
    unit: text(field.at("unit", "")),
  };
}

/** A text for a viewer, as JSON. */
export type Message =
  /** How the session is. `seat` is as this viewer sees it; `failed` are the failures at work, as `component.mode`; `forced` and `disturbed` are the numbers of the signals that are forced and of the faults on the way of signals that are at work; `changed` are the parameters of components that were changed, as `component.key`, with their values; `shown_ns` is null at the live edge, `past_ns` where no past is kept. */
  | { readonly type: "status"; readonly state: SessionState; readonly changed: ReadonlyMap<string, string>; readonly digest: string | null; readonly disturbed: ReadonlySet<number>; readonly failed: ReadonlySet<string>; readonly forced: ReadonlySet<number>; readonly pace: string; readonly past_ns: readonly [number, number] | null; readonly seat: ReadonlyMap<string, SeatState>; readonly shown_ns: number | null }
  /** The places of the looks whose condition holds. */
  | { readonly type: "looks"; readonly active: readonly number[] }
  /** The values of the states of a drawing, in their order; null where there is none. */
  | { readonly type: "states"; readonly drawing: number; readonly instance: number; readonly values: readonly (number | null)[] }
  /** Somebody shows this view to all. */
  | { readonly type: "view"; readonly view: string }
  /** Values of variables that have changed, by their numbers; all variables that are forced; file and line of all statements that have been executed, if the run notes it. */
  | { readonly type: "variables"; readonly values: readonly (readonly [number, string])[]; readonly forced: readonly number[]; readonly executed: readonly (readonly [string, number])[] }
  /** Where the cells of a map lie: one edge more than cells. It comes before their values, and again when it changes. */
  | { readonly type: "map"; readonly map: number; readonly across: Axis; readonly down: Axis }
  /** What has become of an expectation: `pass`, `fail` or `open`. */
  | { readonly type: "verdict"; readonly name: string; readonly verdict: string; readonly t_ns: number; readonly robustness: number | null }
  /** Where the page is of a session that goes on from a moment of the past. */
  | { readonly type: "forked"; readonly t_ns: number; readonly url: string }
  /** What signals did in a span of the past, by their order in the question: times in ns with values, each until the next. */
  | { readonly type: "trace"; readonly from_ns: number; readonly until_ns: number; readonly values: readonly (readonly (readonly [number, number])[])[] }
  /** What operators have done, as a case: its text, and the file that it belongs into. `may_save` says whether this session writes it there, `saved` that it has. */
  | { readonly type: "case"; readonly name: string; readonly text: string; readonly path: string; readonly saved: boolean; readonly may_save: boolean }
  /** Changes of alarms, in the order of virtual time; `all` says that none came before these. */
  | { readonly type: "alarms"; readonly all: boolean; readonly changes: readonly AlarmChange[] }
  /** How the attempt at a lesson goes: `result` comes when it is over. */
  | { readonly type: "lesson"; readonly number: number; readonly ends_ns: number; readonly result: LessonResult | null }
  /** How far real PLCs are on their way to where an attempt at a lesson begins; null when they are there. Nobody operates anything meanwhile. */
  | { readonly type: "drive"; readonly now: Drive | null }
  /** Marked in the trends, and listed below the alarms. */
  | { readonly type: "event"; readonly t_ns: number; readonly kind: string; readonly text: string }
  /** Shown to the viewer. */
  | { readonly type: "error"; readonly message: string };

export function readMessage(field: Field): Message {
  const type = field.at("type").text();
  switch (type) {
    case "status":
      return {
        type,
        state: readSessionState(field.at("state")),
        changed: map(text)(field.at("changed", {})),
        digest: nullable(text)(field.at("digest")),
        disturbed: set(whole)(field.at("disturbed", [])),
        failed: set(text)(field.at("failed", [])),
        forced: set(whole)(field.at("forced", [])),
        pace: text(field.at("pace", "")),
        past_ns: nullable(tuple(whole, whole))(field.at("past_ns")),
        seat: map(readSeatState)(field.at("seat", {})),
        shown_ns: nullable(whole)(field.at("shown_ns")),
      };
    case "looks":
      return { type, active: list(whole)(field.at("active")) };
    case "states":
      return {
        type,
        drawing: whole(field.at("drawing")),
        instance: whole(field.at("instance")),
        values: list(nullable(number))(field.at("values")),
      };
    case "view":
      return { type, view: text(field.at("view")) };
    case "variables":
      return {
        type,
        values: list(tuple(whole, text))(field.at("values")),
        forced: list(whole)(field.at("forced")),
        executed: list(tuple(text, whole))(field.at("executed", [])),
      };
    case "map":
      return {
        type,
        map: whole(field.at("map")),
        across: readAxis(field.at("across")),
        down: readAxis(field.at("down")),
      };
    case "verdict":
      return {
        type,
        name: text(field.at("name")),
        verdict: text(field.at("verdict")),
        t_ns: whole(field.at("t_ns")),
        robustness: nullable(number)(field.at("robustness")),
      };
    case "forked":
      return { type, t_ns: whole(field.at("t_ns")), url: matching(/^https?:\/\/[^\s"'<>]+$/)(field.at("url")) };
    case "trace":
      return {
        type,
        from_ns: whole(field.at("from_ns")),
        until_ns: whole(field.at("until_ns")),
        values: list(list(tuple(number, number)))(field.at("values")),
      };
    case "case":
      return {
        type,
        name: text(field.at("name")),
        text: text(field.at("text")),
        path: text(field.at("path")),
        saved: flag(field.at("saved")),
        may_save: flag(field.at("may_save")),
      };
    case "alarms":
      return { type, all: flag(field.at("all")), changes: list(readAlarmChange)(field.at("changes")) };
    case "lesson":
      return {
        type,
        number: whole(field.at("number")),
        ends_ns: whole(field.at("ends_ns")),
        result: nullable(readLessonResult)(field.at("result")),
      };
    case "drive":
      return { type, now: nullable(readDrive)(field.at("now")) };
    case "event":
      return { type, t_ns: whole(field.at("t_ns")), kind: text(field.at("kind")), text: text(field.at("text")) };
    case "error":
      return { type, message: text(field.at("message")) };
    default:
      return field.unknown("type", type);
  }
}

/** A malfunction, and what the trainee made of it. */
export interface Met {
  readonly name: string;
  /** Whether it had begun before the attempt was over. */
  readonly came: boolean;
  readonly acted: Timing | null;
  readonly identified: Timing | null;
}

export function readMet(field: Field): Met {
  return {
    name: text(field.at("name")),
    came: flag(field.at("came")),
    acted: nullable(readTiming)(field.at("acted")),
    identified: nullable(readTiming)(field.at("identified")),
  };
}

/** A panel of the page. */
export interface Panel {
  readonly name: string;
  readonly seat: Seat;
  readonly columns: number;
  readonly rows: number;
  readonly elements: readonly PanelElement[];
  readonly page: PanelPage | null;
  /** Where a browser finds the picture behind it. */
  readonly picture: string | null;
}

export function readPanel(field: Field): Panel {
  return {
    name: text(field.at("name")),
    seat: readSeat(field.at("seat")),
    columns: whole(field.at("columns")),
    rows: whole(field.at("rows")),
    elements: list(readPanelElement)(field.at("elements")),
    page: nullable(readPanelPage)(field.at("page")),
    picture: nullable(text)(field.at("picture")),
  };
}

/** One thing on a panel. */
export interface PanelElement {
  readonly kind: ElementKind;
  readonly label: string;
  /** Column and row, from 0. */
  readonly at: readonly [number, number];
  /** What a press does to the session, before it presses the signal. */
  readonly action: KeyAction | null;
  /** The bodies on which it lies, too: a click on one presses it. */
  readonly bodies: readonly number[];
  readonly choices: readonly Choice[];
  readonly colour: string | null;
  /** The components on which it lies. */
  readonly components: readonly string[];
  /** The fault on the way of signals that it shows and causes, by its number. */
  readonly disturbance: number | null;
  /** The component and the mode of failure that it shows and causes. */
  readonly failure: readonly [string, string] | null;
  readonly max: number;
  readonly min: number;
  readonly mode: ButtonMode | null;
  readonly signal: string | null;
  /** The second axis of a joystick. */
  readonly signal_y: string | null;
  readonly span: readonly [number, number];
}

export function readPanelElement(field: Field): PanelElement {
  return {
    kind: readElementKind(field.at("kind")),
    label: text(field.at("label")),
    at: tuple(whole, whole)(field.at("at")),
    action: nullable(readKeyAction)(field.at("action")),
    bodies: list(whole)(field.at("bodies", [])),
    choices: list(readChoice)(field.at("choices", [])),
    colour: nullable(text)(field.at("colour")),
    components: list(text)(field.at("components", [])),
    disturbance: nullable(whole)(field.at("disturbance")),
    failure: nullable(tuple(text, text))(field.at("failure")),
    max: number(field.at("max", 1.0)),
    min: number(field.at("min", 0.0)),
    mode: nullable(readButtonMode)(field.at("mode")),
    signal: nullable(text)(field.at("signal")),
    signal_y: nullable(text)(field.at("signal_y")),
    span: tuple(whole, whole)(field.at("span", [1,1])),
  };
}

/** When a panel is shown that is one of several pages: while the signal has the value. */
export interface PanelPage {
  readonly signal: string;
  readonly value: number;
}

export function readPanelPage(field: Field): PanelPage {
  return { signal: text(field.at("signal")), value: whole(field.at("value")) };
}

/** A parameter of a component, as it is shown. */
export interface Parameter {
  readonly name: string;
  readonly value: string;
  /** Whether a component only begins with it, so that it does not change while the plant runs. */
  readonly fixed: boolean;
  /** As a scene has it, with its unit; a change names it so. */
  readonly key: string;
  /** The type of its values: `LREAL`, `DINT`, `BOOL`; empty for one of `words`. */
  readonly type: string;
  readonly unit: string | null;
  /** What it may be, if it is one of some words. */
  readonly words: readonly string[];
}

export function readParameter(field: Field): Parameter {
  return {
    name: text(field.at("name")),
    value: text(field.at("value")),
    fixed: flag(field.at("fixed", false)),
    key: text(field.at("key", "")),
    type: text(field.at("type", "")),
    unit: nullable(text)(field.at("unit")),
    words: list(text)(field.at("words", [])),
  };
}

/** Where a component is in the scene's pose, in the world, as far as it is anywhere. */
export interface Place {
  /** Unit vector along which one of its beams is beside the other. */
  readonly along: readonly [number, number, number] | null;
  /** Unit vector along which it points or runs. */
  readonly direction: readonly [number, number, number] | null;
  /** The joint that it drives. */
  readonly joint: DrivenJoint | null;
  /** The body that it moves: a belt, or what a joint lets move. */
  readonly moves: string | null;
  /** Where it begins, as a beam does. */
  readonly point_m: readonly [number, number, number] | null;
}

export function readPlace(field: Field): Place {
  return {
    along: nullable(tuple(number, number, number))(field.at("along")),
    direction: nullable(tuple(number, number, number))(field.at("direction")),
    joint: nullable(readDrivenJoint)(field.at("joint")),
    moves: nullable(text)(field.at("moves")),
    point_m: nullable(tuple(number, number, number))(field.at("point_m")),
  };
}

/** A PLC whose variables can be looked at. Variables of all PLCs are numbered through. */
export interface Plc {
  readonly client: string;
  readonly variables: readonly Variable[];
}

export function readPlc(field: Field): Plc {
  return { client: text(field.at("client")), variables: list(readVariable)(field.at("variables")) };
}

/** How urgent an alarm is (ISA-18.2): how soon somebody has to do something. */
export type Priority = "low" | "medium" | "high" | "critical";

export function readPriority(field: Field): Priority {
  return one_of("low", "medium", "high", "critical")(field);
}

/** Whose page it is. */
export type Role = "trainee" | "trainer";

export function readRole(field: Field): Role {
  return one_of("trainee", "trainer")(field);
}

/** Whose a panel is. */
export type Seat = "operator" | "trainer";

export function readSeat(field: Field): Seat {
  return one_of("operator", "trainer")(field);
}

/** A seat as one viewer sees it. */
export type SeatState = "free" | "mine" | "taken";

export function readSeatState(field: Field): SeatState {
  return one_of("free", "mine", "taken")(field);
}

/** The parts of a session that do not change while it runs. */
export interface Session {
  readonly protocol: number;
  readonly title: string;
  readonly scenario: string;
  readonly step_ns: number;
  readonly signals: readonly Signal[];
  /** The alarms of `[[report.alarm]]`. */
  readonly alarms: readonly Alarm[];
  readonly bodies: readonly Body[];
  readonly components: readonly Component[];
  readonly drawings: readonly Drawing[];
  readonly expectations: readonly Expectation[];
  /** False for a recording: it is shown from its beginning, and nobody operates it. */
  readonly live: boolean;
  readonly looks: readonly Look[];
  readonly maps: readonly MapInfo[];
  readonly panels: readonly Panel[];
  readonly plcs: readonly Plc[];
  /** The signals of `[plot]`: the trends that the page begins with. */
  readonly plot: readonly number[];
  readonly sources: readonly Source[];
  readonly training: Lesson | null;
  /** The scenario's own texts in other languages: by language, what each text is there. */
  readonly translations: ReadonlyMap<string, ReadonlyMap<string, string>>;
  readonly until_ns: number | null;
  readonly views: readonly View[];
}

export function readSession(field: Field): Session {
  return {
    protocol: whole(field.at("protocol")),
    title: text(field.at("title")),
    scenario: text(field.at("scenario")),
    step_ns: whole(field.at("step_ns")),
    signals: list(readSignal)(field.at("signals")),
    alarms: list(readAlarm)(field.at("alarms", [])),
    bodies: list(readBody)(field.at("bodies", [])),
    components: list(readComponent)(field.at("components", [])),
    drawings: list(readDrawing)(field.at("drawings", [])),
    expectations: list(readExpectation)(field.at("expectations", [])),
    live: flag(field.at("live", true)),
    looks: list(readLook)(field.at("looks", [])),
    maps: list(readMapInfo)(field.at("maps", [])),
    panels: list(readPanel)(field.at("panels", [])),
    plcs: list(readPlc)(field.at("plcs", [])),
    plot: list(whole)(field.at("plot", [])),
    sources: list(readSource)(field.at("sources", [])),
    training: nullable(readLesson)(field.at("training")),
    translations: map(map(text))(field.at("translations", {})),
    until_ns: nullable(whole)(field.at("until_ns")),
    views: list(readView)(field.at("views", [])),
  };
}

/** How a session is. */
export type SessionState = "run" | "hold" | "end" | "recorded" | "driven";

export function readSessionState(field: Field): SessionState {
  return one_of("run", "hold", "end", "recorded", "driven")(field);
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

/** A signal of the session. Signals are named by their place in its list. */
export interface Signal {
  readonly name: string;
  readonly type: string;
  readonly writer: string;
  readonly about: string;
  /** Names of values. */
  readonly names: ReadonlyMap<number, string>;
  readonly unit: string | null;
}

export function readSignal(field: Field): Signal {
  return {
    name: text(field.at("name")),
    type: text(field.at("type")),
    writer: text(field.at("writer")),
    about: text(field.at("about", "")),
    names: numbered(text)(field.at("names", {})),
    unit: nullable(text)(field.at("unit")),
  };
}

/** A mistake, and how often it was made. */
export interface Slip {
  readonly name: string;
  readonly count: number;
  /** How many are forgiven. */
  readonly at_most: number;
}

export function readSlip(field: Field): Slip {
  return {
    name: text(field.at("name")),
    count: whole(field.at("count")),
    at_most: whole(field.at("at_most")),
  };
}

/** A program of a PLC as text. */
export interface Source {
  readonly path: string;
  readonly text: string;
  readonly lines: readonly SourceLine[];
}

export function readSource(field: Field): Source {
  return {
    path: text(field.at("path")),
    text: text(field.at("text")),
    lines: list(readSourceLine)(field.at("lines", [])),
  };
}

/** A line that names signals or variables. */
export interface SourceLine {
  /** From 1. */
  readonly line: number;
  /** Names of signals. */
  readonly variables: readonly string[];
  /** Numbers of the PLCs' own variables. */
  readonly inner: readonly number[];
}

export function readSourceLine(field: Field): SourceLine {
  return {
    line: whole(field.at("line")),
    variables: list(text)(field.at("variables")),
    inner: list(whole)(field.at("inner", [])),
  };
}

/** How long something took. */
export interface Timing {
  readonly timely: boolean;
  /** Nothing if it was not done. */
  readonly after_ns: number | null;
  readonly within_ns: number | null;
}

export function readTiming(field: Field): Timing {
  return {
    timely: flag(field.at("timely")),
    after_ns: nullable(whole)(field.at("after_ns")),
    within_ns: nullable(whole)(field.at("within_ns")),
  };
}

export interface Variable {
  readonly path: string;
  readonly type: string;
}

export function readVariable(field: Field): Variable {
  return { path: text(field.at("path")), type: text(field.at("type")) };
}

/** What is done with virtual time. */
export type Verb = "hold" | "go" | "step" | "stop";

/** A place from which the machine is seen. */
export interface View {
  readonly name: string;
  readonly position_m: readonly [number, number, number];
  readonly target_m: readonly [number, number, number];
}

export function readView(field: Field): View {
  return {
    name: text(field.at("name")),
    position_m: tuple(number, number, number)(field.at("position_m")),
    target_m: tuple(number, number, number)(field.at("target_m")),
  };
}
