// A machine without bodies, drawn as what it is made of: axes with their ways and limits, tanks with their levels, the rest
// with what it says.

import { say } from "./say";
import { broken, make } from "./dom";
import { form_for, in_form, is_whole, shown } from "./format";
import type { Component, Session, Signal } from "./session";

/** What is shown of other components: so many readings. */
const READINGS = 3;

/** A component as it is drawn; signals by their numbers. */
export interface Strip {
  readonly component: Component;
  readonly form: "axis" | "tank" | "other";
  /** Where it is on its way, or how full. */
  readonly place: number | null;
  readonly limits: readonly [number, number] | null;
  /** Where it is to go. */
  readonly target: number | null;
  /** What else it says, and what of it is true or false. */
  readonly readings: readonly number[];
  readonly states: readonly number[];
}

/** The last word of a signal's name. */
const word = (name: string): string => name.split(".").at(-1) ?? name;

function limits_of(component: Component): readonly [number, number] | null {
  const of = (name: string): number => Number(component.parameters.find((one) => one.name === name)?.value ?? Number.NaN);
  for (const [low, high] of [["lower", "upper"], ["min", "max"], ["least", "greatest"]] as const) {
    if (of(high) > of(low)) return [of(low), of(high)];
  }
  for (const name of ["height", "stroke", "travel"]) if (of(name) > 0) return [0, of(name)];
  return null;
}

function strip(component: Component, session: Session): Strip {
  const programs = new Set(session.plcs.map((plc) => plc.client));
  const numbers = component.signals.flatMap((name) => {
    const number = session.signals.findIndex((signal) => signal.name === name);
    return number < 0 ? [] : [number];
  });
  const about = (number: number): Signal => session.signals[number] as Signal;
  const said = numbers.filter((number) => !programs.has(about(number).writer));
  const find = (among: readonly number[], words: RegExp): number | null => {
    return among.find((number) => about(number).type !== "BOOL" && words.test(word(about(number).name))) ?? null;
  };
  const position = find(said, /position|angle|height$/i);
  const level = find(said, /level|filling/i);
  const form = position !== null && /axis|drive|cylinder|servo|motor|mast|slide/i.test(component.kind) ? "axis" : level !== null ? "tank" : "other";
  const place = form === "axis" ? position : form === "tank" ? level : null;
  const target = form === "axis" ? find(numbers.filter((number) => programs.has(about(number).writer)), /(target|set|command)_?position/i) : null;
  const rest = said.filter((number) => number !== place);
  return {
    component, form, place, target,
    limits: limits_of(component),
    readings: rest.filter((number) => about(number).type !== "BOOL").slice(0, READINGS),
    states: rest.filter((number) => about(number).type === "BOOL").slice(0, READINGS),
  };
}

/** The components of a machine without bodies, axes first; nothing for one that has bodies. */
export function strips(session: Session): readonly Strip[] {
  if (session.bodies.some((body) => body.shape.kind !== "none")) return [];
  const all = session.components.map((component) => strip(component, session)).filter((one) => one.component.signals.length > 0);
  const order = { axis: 0, tank: 1, other: 2 };
  return all.sort((a, b) => order[a.form] - order[b.form]);
}

/** How far along its way a value is, 0 to 1; the way of one without limits is what has been seen of it. */
export function share_of_way(value: number, limits: readonly [number, number]): number {
  const span = limits[1] - limits[0];
  return span > 0 ? Math.min(1, Math.max(0, (value - limits[0]) / span)) : 0;
}

/** Shows a value. */
type Show = (value: number) => void;

export class Schematic {
  readonly root = make("div", { class: "schematic" });
  private readonly shows = new Map<number, Show[]>();

  /** `choose` is called with the name of a component that is clicked: its keys are pressed, or its sheet is opened. */
  constructor(private readonly session: Session, private readonly choose: (component: string) => void) {
    const all = strips(session);
    for (const form of ["axis", "tank", "other"] as const) {
      const rows = all.filter((one) => one.form === form).map((one) => this.row(one));
      if (rows.length > 0) this.root.append(make("div", { class: `strips ${form}` }, ...rows));
    }
    if (all.length === 0) this.root.append(make("p", { class: "empty" }, say("This scenario has no bodies to draw and no components: see its signals in the sheet Signals, and put them on trends by +.")));
  }

  signals(): readonly number[] {
    return [...this.shows.keys()];
  }

  show(signal: number, value: number): void {
    for (const one of this.shows.get(signal) ?? []) one(value);
  }

  private listen(signal: number, show: Show): void {
    this.shows.set(signal, [...(this.shows.get(signal) ?? []), show]);
  }

  private row(one: Strip): HTMLElement {
    const { component } = one;
    const about = component.parameters.map(({ name, value, unit }) => `${name} ${value}${unit === null ? "" : ` ${unit}`}`).join(", ");
    const name = make("button", { type: "button", class: "strip-name", title: `${component.kind}: ${about}` }, ...broken(component.name));
    name.addEventListener("click", () => this.choose(component.name));
    const states = make("span", { class: "strip-states" }, ...one.states.map((signal) => this.state(signal)));
    const inside = one.place === null ? [this.readings(one)] : [this.way(one, one.place), this.reading(one.place, one.target)];
    return make("div", { class: "strip" }, name, ...inside, states);
  }

  private about(signal: number): Signal {
    return this.session.signals[signal] as Signal;
  }

  /** The way of an axis, or the height of a tank, with where it is and where it is to go. */
  private way(one: Strip, signal: number): HTMLElement {
    const fill = make("span", { class: "way-fill" });
    const goal = make("span", { class: "way-goal", hidden: true });
    const unit = this.about(signal).unit;
    const [low, high] = one.limits ?? [null, null];
    const ends = [low, high].map((end) => make("span", { class: "way-end" }, end === null ? "" : in_form(end, form_for(null, Number.isInteger(end), Math.abs(end)))));
    const way = make("span", { class: "way", role: "meter", "aria-label": `${one.component.name}${unit === null ? "" : `, ${unit}`}`, "aria-valuenow": "0" }, fill, goal);
    let [least, greatest] = one.limits ?? [0, 0];
    const put = (element: HTMLElement, value: number): void => {
      if (one.limits === null) [least, greatest] = [Math.min(least, value), Math.max(greatest, value)];
      element.style.setProperty("--share", share_of_way(value, [least, greatest]).toFixed(4));
    };
    way.setAttribute("aria-valuemin", String(least));
    way.setAttribute("aria-valuemax", String(greatest === least ? 1 : greatest));
    this.listen(signal, (value) => {
      put(fill, value);
      way.setAttribute("aria-valuenow", String(value));
    });
    if (one.target !== null) {
      this.listen(one.target, (value) => {
        goal.hidden = false;
        put(goal, value);
      });
    }
    return make("span", { class: "strip-way" }, ends[0] as HTMLElement, way, ends[1] as HTMLElement);
  }

  private reading(signal: number, target: number | null): HTMLElement {
    const output = make("output", {}, "–");
    const error = make("span", { class: "strip-error", title: say("What is left to where it is to go") });
    let [at, to]: [number | null, number | null] = [null, null];
    const lag = (): void => {
      const about = this.about(signal);
      if (at !== null && to !== null) error.textContent = `Δ ${in_form(to - at, form_for(about.unit, is_whole(about.type), Math.max(Math.abs(at), Math.abs(to))))}`;
    };
    this.listen(signal, (value) => {
      at = value;
      output.textContent = shown(this.about(signal), value);
      lag();
    });
    if (target !== null) {
      this.listen(target, (value) => {
        to = value;
        lag();
      });
    }
    return make("span", { class: "strip-value" }, output, error);
  }

  private readings(one: Strip): HTMLElement {
    return make("span", { class: "strip-readings" }, ...one.readings.map((signal) => {
      const output = make("output", {}, "–");
      this.listen(signal, (value) => (output.textContent = shown(this.about(signal), value)));
      return make("span", {}, make("span", { class: "caption" }, ...broken(word(this.about(signal).name))), " ", output);
    }));
  }

  /** Something that is true or false: filled or not, and with a mark. */
  private state(signal: number): HTMLElement {
    const mark = make("span", { class: "state-mark", "aria-hidden": "true" }, "○");
    const said = make("span", { class: "visually-hidden" }, "off");
    this.listen(signal, (value) => {
      [mark.textContent, said.textContent] = value === 0 ? ["○", "off"] : ["●", "on"];
    });
    return make("span", { class: "strip-state", title: this.about(signal).name }, mark, word(this.about(signal).name), " ", said);
  }
}
