// What is known of the part that was clicked: its signals, its parameters, which one may change, its failure modes.

import { say } from "./say";
import { broken, button, make } from "./dom";
import type { Target } from "./forces";
import { local, shown } from "./format";
import type { Ask } from "./message";
import type { Key } from "./panels";
import type { Component, Session } from "./session";
import type { MachineView } from "./scene";

type Parameter = Component["parameters"][number];

/** A key of a row: who hears it hears what it is for. */
function deed(label: string, press: () => void, title: string): HTMLButtonElement {
  const key = button(label, press, title);
  key.setAttribute("aria-label", title);
  return key;
}

/** What the sheet is about: a body, a component that is nowhere or stands by itself, or nothing yet. */
type Subject = { readonly body: number } | { readonly component: number } | null;

export class PartSheet {
  readonly root = make("div");
  private readonly cells = new Map<number, HTMLElement>();
  /** The cells of parameters, by component and key. */
  private readonly settings = new Map<string, { readonly parameter: Parameter; readonly cell: HTMLElement }>();
  private changed_now: ReadonlyMap<string, string> = new Map();
  private subject: Subject = null;
  private readonly presence = make("p", { class: "empty", role: "status" });

  constructor(
    private readonly session: Session,
    private readonly values: ReadonlyMap<number, number>,
    private readonly machine: MachineView,
    private readonly ask: (ask: Ask) => void,
    private readonly changed: () => void,
    /** The keys that lie on a body. */
    private readonly keys: (body: number) => readonly Key[],
    private readonly press: (key: Key) => void,
    /** Asks for a value. */
    private readonly enter: (target: Target) => void,
  ) {
    this.open(null);
  }

  /** The signals that the sheet shows. */
  signals(): readonly number[] {
    return [...this.cells.keys()];
  }

  show(signal: number): void {
    const cell = this.cells.get(signal);
    const about = this.session.signals[signal];
    if (cell !== undefined && about !== undefined) cell.textContent = shown(about, this.values.get(signal));
  }

  /** The parameters that were changed, by component and key, with their values. */
  show_changed(changed: ReadonlyMap<string, string>): void {
    this.changed_now = changed;
    for (const [name, { parameter, cell }] of this.settings) this.set(name, parameter, cell);
  }

  /** Says whether the part is out of the world. */
  show_presence(): void {
    const isAway = this.subject !== null && "body" in this.subject && !this.machine.is_there(this.subject.body);
    this.presence.textContent = isAway ? say("It is out of the world now: it waits for its source, or a sink has taken it.") : "";
  }

  open(body: number | null): void {
    const about = body === null ? undefined : this.session.bodies[body];
    this.machine.choose(body);
    if (about === undefined || body === null) {
      this.machine.follow(null);
      return this.begin(null, this.list());
    }
    const tools = make("div", { class: "toolbar" },
      button(say("Follow"), () => this.machine.follow(body), say("Keeps this part in the middle of the picture")),
      button(say("Stay"), () => this.machine.follow(null), say("Lets the picture stay where it is")),
      button(say("Hide"), () => this.machine.hide(body), say("Shows what is behind this part")));
    const material = this.machine.material(body);
    const kind = [about.kind, about.shape.kind, ...(material === null ? [] : [say(material.name)])].join(", ");
    this.begin({ body }, make("h2", {}, about.name), make("p", { class: "empty" }, kind), this.presence, tools,
      ...this.keys(body).map((key) => button(key.label, () => this.press(key), say("Presses this part, as a click on it does"))));
    const own = this.session.components.filter((one) => one.body === about.name || one.place?.moves === about.name);
    this.root.append(...own.flatMap((one) => this.component(one)), this.back());
    this.show_presence();
  }

  /** Opens a component that no body stands for. */
  open_component(name: string): void {
    const component = this.session.components.findIndex((one) => one.name === name);
    const about = this.session.components[component];
    if (about === undefined) return this.open(null);
    this.machine.choose(null);
    this.begin({ component });
    this.root.append(...this.component(about), this.back());
  }

  private begin(subject: Subject, ...inside: readonly HTMLElement[]): void {
    this.subject = subject;
    this.cells.clear();
    this.settings.clear();
    this.root.replaceChildren(...inside);
  }

  /** All parts by name, for those who do not use a mouse: bodies, then components that no body stands for. */
  private list(): HTMLElement {
    const bodies = new Set(this.session.bodies.map((one) => one.name));
    const option = (value: string, text: string): HTMLElement => make("option", { value }, text);
    const loose = this.session.components.flatMap((one, index) =>
      (one.body !== null && bodies.has(one.body)) || (one.place?.moves != null && bodies.has(one.place.moves)) ? [] : [option(`c${index}`, `${one.name} (${one.kind})`)]);
    const select = make("select", { "aria-label": say("Part"), size: "12", class: "filter" }, ...this.session.bodies.map((one, index) => option(String(index), one.name)), ...loose);
    select.addEventListener("change", () => {
      if (select.value.startsWith("c")) this.open_component(this.session.components[Number(select.value.slice(1))]?.name ?? "");
      else this.open(Number(select.value));
      this.changed();
    });
    return make("div", {}, make("p", { class: "empty" }, say("Click a part of the machine, or choose one here.")), select);
  }

  private back(): HTMLElement {
    return button(say("All parts"), () => {
      this.open(null);
      this.changed();
    });
  }

  private component(one: Component): readonly HTMLElement[] {
    const signals = one.signals.flatMap((name) => {
      const index = this.session.signals.findIndex((signal) => signal.name === name);
      if (index < 0) return [];
      const cell = make("td", { class: "value" });
      this.cells.set(index, cell);
      this.show(index);
      return [make("tr", {}, make("td", { class: "name" }, ...broken(name)), cell)];
    });
    const failures = one.failures.map(({ name: failure }) => make("tr", {}, make("td", { class: "name" }, failure), make("td", { class: "value" },
      deed(say("Fail"), () => this.ask({ type: "fail", component: one.name, failure, active: true }), say("Fail {name}: {failure}", { name: one.name, failure })),
      deed(say("Repair"), () => this.ask({ type: "fail", component: one.name, failure, active: false }), say("Repair {name}: {failure}", { name: one.name, failure })))));
    const parameters = one.parameters.map((parameter) => this.parameter(one, parameter));
    return [make("h3", {}, `${one.name} (${one.kind})`), make("table", {}, make("tbody", {}, ...signals, ...parameters, ...failures))];
  }

  /** A parameter with its value, which changes while the machine runs. */
  private parameter(one: Component, parameter: Parameter): HTMLElement {
    const value = make("span", {});
    const name = `${one.name}.${parameter.key}`;
    this.settings.set(name, { parameter, cell: value });
    this.set(name, parameter, value);
    const mayChange = this.session.live && this.session.training?.role !== "trainee" && parameter.key !== "" && !parameter.fixed;
    const change = deed(say("Change"), () => this.change(one, parameter), say("Change {name}", { name: parameter.name }));
    return make("tr", {}, make("td", { class: "name" }, ...broken(parameter.name)), make("td", { class: "value" }, value, ...(mayChange ? [" ", change] : [])));
  }

  /** Asks for another value of a parameter. */
  private change(one: Component, parameter: Parameter): void {
    const name = `${one.name}.${parameter.key}`;
    const ask = (value: string | null): void => this.ask({ type: "parameter", component: one.name, parameter: parameter.key, value });
    this.enter({
      name: parameter.name, type: parameter.type, unit: parameter.unit, names: new Map(),
      value: () => this.reading(name, parameter), isForced: this.changed_now.has(name),
      force: ask, release: () => ask(null), change: { words: parameter.words },
    });
  }

  private reading(name: string, parameter: Parameter): string {
    const value = local(this.changed_now.get(name) ?? parameter.value);
    return parameter.unit === null ? value : `${value} ${parameter.unit}`;
  }

  private set(name: string, parameter: Parameter, cell: HTMLElement): void {
    const isChanged = this.changed_now.has(name);
    cell.textContent = isChanged ? say("{value}, changed", { value: this.reading(name, parameter) }) : this.reading(name, parameter);
    cell.classList.toggle("forced", isChanged);
  }
}
