// What is known of the part that was clicked: its signals, its parameters, its failure modes.

import { say } from "./say";
import { button, make } from "./dom";
import { shown } from "./format";
import type { Ask } from "./message";
import type { Key } from "./panels";
import type { Component, Session } from "./session";
import type { MachineView } from "./scene";

export class PartSheet {
  readonly root = make("div");
  private readonly cells = new Map<number, HTMLElement>();

  constructor(
    private readonly session: Session,
    private readonly values: ReadonlyMap<number, number>,
    private readonly machine: MachineView,
    private readonly ask: (ask: Ask) => void,
    private readonly changed: () => void,
    /** The keys that lie on a body. */
    private readonly keys: (body: number) => readonly Key[],
    private readonly press: (key: Key) => void,
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

  open(body: number | null): void {
    this.cells.clear();
    this.machine.choose(body);
    const about = body === null ? undefined : this.session.bodies[body];
    if (about === undefined || body === null) {
      this.machine.follow(null);
      this.root.replaceChildren(this.list());
      return;
    }
    const tools = make("div", { class: "toolbar" },
      button(say("Follow"), () => this.machine.follow(body), say("Keeps this part in the middle of the picture")),
      button(say("Stay"), () => this.machine.follow(null), say("Lets the picture stay where it is")),
      button(say("Hide"), () => this.machine.hide(body), say("Shows what is behind this part")));
    const components = this.session.components.filter((one) => one.body === about.name);
    this.root.replaceChildren(
      make("h2", {}, about.name), make("p", { class: "empty" }, `${about.kind}, ${about.shape.kind}`), tools,
      ...this.keys(body).map((key) => button(key.label, () => this.press(key), say("Presses this part, as a click on it does"))),
      ...components.flatMap((one) => this.component(one)), this.back());
  }

  /** All parts by name, for those who do not use a mouse. */
  private list(): HTMLElement {
    const options = this.session.bodies.map((one, index) => make("option", { value: String(index) }, one.name));
    const select = make("select", { "aria-label": say("Part"), size: "12", class: "filter" }, ...options);
    select.addEventListener("change", () => {
      this.open(Number(select.value));
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
      return [make("tr", {}, make("td", { class: "name" }, name), cell)];
    });
    const parameters = one.parameters.map((parameter) => make("tr", {},
      make("td", { class: "name" }, parameter.name),
      make("td", { class: "value" }, parameter.unit === null ? parameter.value : `${parameter.value} ${parameter.unit}`)));
    const failures = one.failures.map(({ name: failure }) => make("tr", {}, make("td", { class: "name" }, failure), make("td", { class: "value" },
      button(say("Fail"), () => this.ask({ type: "fail", component: one.name, failure, active: true }), say("Fail {name}: {failure}", { name: one.name, failure })),
      button(say("Repair"), () => this.ask({ type: "fail", component: one.name, failure, active: false }), say("Repair {name}: {failure}", { name: one.name, failure })))));
    return [make("h3", {}, `${one.name} (${one.kind})`), make("table", {}, make("tbody", {}, ...signals, ...parameters, ...failures))];
  }
}
