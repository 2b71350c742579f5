// The panels of the machine: what an operator presses and reads.

import { own, say, say_word } from "./say";
import { AlarmList } from "./alarm-list";
import type { Standing } from "./alarms";
import { broken, button, make } from "./dom";
import { Press } from "./press";
import { shown } from "./format";
import type { SeatState } from "./message";
import type { Panel, PanelElement, Session } from "./session";
import { Sparkline } from "./sparkline";

export interface PanelActions {
  /** Writes a value of a signal, as an operator's input at the next step boundary. */
  readonly write: (signal: number, value: number) => void;
  readonly take: (panel: string, take: boolean) => void;
  /** Lets a component fail, or repairs it. */
  readonly fail: (component: string, failure: string, active: boolean) => void;
  /** Puts a fault on the way of signals, or takes it away. */
  readonly disturb: (disturbance: number, active: boolean) => void;
  /** Lets machine and programs begin again, by a key of this panel. */
  readonly reset: (panel: string) => void;
  /** All alarms have been seen. */
  readonly acknowledge: () => void;
}

/** A key that lies on a part of the machine, too. */
export interface Key {
  readonly label: string;
  /** Presses it; why it cannot be pressed, if so. */
  readonly press: () => string | null;
}

/** Row by row, as a narrow screen has them one after the other, and as the tabulator goes. */
function in_reading_order(elements: readonly PanelElement[]): readonly PanelElement[] {
  return [...elements].sort((one, other) => one.at[1] - other.at[1] || one.at[0] - other.at[0]);
}

/** Shows the value of a signal that has changed. */
type Show = (value: number) => void;

export class PanelView {
  readonly root: HTMLElement;
  private readonly shows = new Map<number, Show[]>();
  private readonly cells = new Map<number, HTMLElement[]>();
  private readonly failures = new Map<string, Show[]>();
  private readonly disturbances = new Map<number, Show[]>();
  private readonly inputs: (HTMLButtonElement | HTMLInputElement | HTMLSelectElement)[] = [];
  /** Inputs that never work on this page, and why. */
  private readonly barred = new Map<HTMLElement, string>();
  /** What is done as soon as this viewer sits here. */
  private waiting: (() => void)[] = [];
  private isPast = false;
  private isOver = false;
  private isHeld = false;
  /** Why the whole panel rests beside the past, if so. */
  private resting: string | null = null;
  private readonly why = make("p", { class: "why" });
  /** The keys that lie on the machine. */
  private readonly on_machine: { readonly element: PanelElement; readonly key: Key }[] = [];
  private readonly lines: Sparkline[] = [];
  private readonly lists: AlarmList[] = [];
  /** Presses the key that acknowledges, if this panel has one. */
  private press_acknowledge: (() => void) | null = null;
  private readonly seat_text = make("span", { class: "seat-text", role: "status" });
  private readonly seat_button: HTMLButtonElement;
  private seat: SeatState = "free";

  constructor(
    private readonly panel: Panel,
    private readonly session: Session,
    private readonly actions: PanelActions,
  ) {
    this.seat_button = button(say("Take seat"), () => actions.take(panel.name, this.seat !== "mine"), say("Who has the seat operates this panel; others look on"));
    const grid = make("div", { class: "panel-grid" }, ...in_reading_order(panel.elements).map((element) => this.place(element)));
    grid.style.setProperty("--columns", String(panel.columns));
    if (panel.columns > 4) grid.classList.add("broad");
    if (panel.picture !== null) {
      grid.classList.add("pictured");
      grid.style.gridTemplateRows = `repeat(${panel.rows}, minmax(44px, auto))`;
      grid.style.backgroundImage = `url(${JSON.stringify(panel.picture)})`;
    }
    const head = make("div", { class: "panel-head" }, make("h3", {}, own(panel.name)), this.seat_text, this.seat_button);
    this.why.id = `why-${panel.name.replace(/\W/g, "-")}`;
    this.root = make("section", { class: "panel", "aria-label": say("Panel {name}", { name: own(panel.name) }) }, head, this.why, grid);
    for (const input of this.inputs) input.setAttribute("aria-describedby", this.why.id);
    // Where nothing is written, nobody needs to sit.
    if (this.inputs.length === 0) [this.seat_button.hidden, this.seat_text.hidden] = [true, true];
    this.turn(panel);
    this.sit("free");
  }

  /** The signals that this panel reads. */
  signals(): readonly number[] {
    return [...this.shows.keys()];
  }

  show(signal: number, value: number): void {
    for (const one of this.shows.get(signal) ?? []) one(value);
  }

  /** The failures that are at work now, as `component.mode`, and the numbers of the faults on the way of signals. */
  show_failed(failed: ReadonlySet<string>, disturbed: ReadonlySet<number>): void {
    for (const [name, shows] of this.failures) for (const one of shows) one(failed.has(name) ? 1 : 0);
    for (const [number, shows] of this.disturbances) for (const one of shows) one(disturbed.has(number) ? 1 : 0);
  }

  /** A page is there while its signal says so. */
  private turn(panel: Panel): void {
    const page = panel.page;
    if (page === null) return;
    this.root.hidden = true;
    this.bound(page.signal, (value) => (this.root.hidden = value !== page.value));
  }

  /** Marks what is forced: a press or a turn of it changes nothing. */
  show_forced(forced: ReadonlySet<number>): void {
    for (const [signal, cells] of this.cells) for (const cell of cells) cell.classList.toggle("forced", forced.has(signal));
  }

  /** Shows the alarms that there are. */
  alarms(all: readonly Standing[], isResting: boolean): void {
    for (const list of this.lists) list.show(all, isResting);
  }

  /** Acknowledges with this panel's own signal; false if it has none. */
  acknowledge(): boolean {
    this.press_acknowledge?.();
    return this.press_acknowledge !== null;
  }

  /** The keys that lie on a body of the machine. */
  keys_on_body(body: number): readonly Key[] {
    return this.on_machine.filter(({ element }) => element.bodies.includes(body)).map(({ key }) => key);
  }

  /** The keys that lie on a component, with or without a body. */
  keys_on_component(name: string): readonly Key[] {
    return this.on_machine.filter(({ element }) => element.components.includes(name)).map(({ key }) => key);
  }

  /** The time of a picture whose values have been shown. */
  at(t_ns: number): void {
    for (const line of this.lines) line.at(t_ns / 1e9);
  }

  /** Whether time stands: what is pressed has not arrived yet. */
  hold(isHeld: boolean): void {
    this.isHeld = isHeld;
  }

  /** Whether the past is shown, or the run is over: then nothing is operated. */
  rest(isPast: boolean, isOver: boolean): void {
    if (this.isPast === isPast && this.isOver === isOver) return;
    [this.isPast, this.isOver] = [isPast, isOver];
    this.say_why();
  }

  /** Nothing is operated for this reason, until there is none. */
  rest_because(why: string | null): void {
    if (this.resting === why) return;
    this.resting = why;
    this.say_why();
  }

  /** Who sits here: inputs work for the one who does, and the first press takes a seat that is free. */
  sit(seat: SeatState): void {
    this.seat = seat;
    const waiting = this.waiting;
    if (seat !== "free") this.waiting = [];
    if (seat === "mine") for (const one of waiting) one();
    const words: Record<SeatState, string> = { free: say("free"), mine: say("you sit here"), taken: say("taken by another viewer") };
    this.seat_text.textContent = say("{seat}: {state}", { seat: say_word(this.panel.seat), state: words[seat] });
    this.seat_button.textContent = seat === "mine" ? say("Leave seat") : say("Take seat");
    this.seat_button.disabled = seat === "taken";
    this.root?.classList.toggle("mine", seat === "mine");
    this.say_why();
  }

  /** Says why nothing can be pressed, or what a press does first. */
  private say_why(): void {
    const isResting = this.isPast || this.isOver || this.resting !== null;
    const why = this.resting ?? why_not(say_word(this.panel.seat), this.seat, this.isPast, this.isOver);
    const isDead = isResting || this.seat === "taken";
    this.why.textContent = this.inputs.length === 0 ? "" : why;
    this.why.hidden = this.why.textContent === "";
    this.root.classList.toggle("resting", isResting);
    for (const input of this.inputs) {
      const own_reason = this.barred.get(input);
      input.disabled = isDead || own_reason !== undefined;
      input.title = isDead ? why : own_reason ?? why;
    }
  }

  /** Does it from the seat, which is taken if it is free. */
  private seated(deed: () => void): void {
    if (this.isPast || this.isOver || this.resting !== null) return;
    if (this.seat === "mine") deed();
    else if (this.seat === "free") {
      this.waiting.push(deed);
      this.actions.take(this.panel.name, true);
    }
  }

  private place(raw: PanelElement): HTMLElement {
    const element = { ...raw, label: own(raw.label), choices: raw.choices.map((one) => ({ ...one, label: own(one.label) })) };
    const cell = make("div", { class: `element ${element.kind}`, "data-forced": say("forced") });
    cell.style.setProperty("--column", `${element.at[0] + 1} / span ${element.span[0]}`);
    cell.style.setProperty("--row", `${element.at[1] + 1} / span ${element.span[1]}`);
    cell.style.setProperty("--columns-of-three", String(Math.min(3, element.span[0])));
    cell.style.setProperty("--rows", String(element.span[1]));
    if (element.colour !== null) cell.style.setProperty("--own", element.colour);
    this.fill(cell, element);
    this.lay_on_machine(cell, element);
    for (const name of [element.signal, element.signal_y]) {
      const signal = this.number_of(name);
      if (signal !== null) this.cells.set(signal, [...(this.cells.get(signal) ?? []), cell]);
    }
    return cell;
  }

  /** A press of the machine is one of the key, which knows who sits here. */
  private lay_on_machine(cell: HTMLElement, element: PanelElement): void {
    const button = cell.querySelector("button");
    if (button === null || element.bodies.length + element.components.length === 0) return;
    const press = (): string | null => {
      if (button.disabled) return button.title;
      button.click();
      return null;
    };
    this.on_machine.push({ element, key: { label: element.label, press } });
  }

  private fill(cell: HTMLElement, element: PanelElement): void {
    switch (element.kind) {
      case "button":
        return element.mode === "toggle" ? this.fill_switch(cell, element) : this.fill_button(cell, element);
      case "emergency-stop":
        return this.fill_emergency_stop(cell, element);
      case "switch":
        return this.fill_switch(cell, element);
      case "selector":
        return this.fill_selector(cell, element);
      case "slider":
        return this.fill_slider(cell, element, element.signal, element.label);
      case "joystick":
        if (element.signal_y === null) return this.fill_slider(cell, element, element.signal, element.label, true);
        this.fill_slider(cell, element, element.signal, `${element.label} x`, true);
        return this.fill_slider(cell, element, element.signal_y, `${element.label} y`, true);
      case "lamp":
        return this.fill_lamp(cell, element);
      case "number":
        return this.fill_number(cell, element);
      case "trend":
        return this.fill_trend(cell, element);
      case "bar":
        return this.fill_bar(cell, element);
      case "alarms":
        return this.fill_alarms(cell, element);
    }
  }

  private number_of(name: string | null): number | null {
    const signal = this.session.signals.findIndex((one) => one.name === name);
    return signal < 0 ? null : signal;
  }

  /** The number of a signal by its name; an element of a signal that is not there stays dead and says so. */
  private bound(name: string | null, show: Show): number | null {
    const signal = this.number_of(name);
    if (signal === null) return null;
    this.listen(this.shows, signal, show);
    return signal;
  }

  private listen<Key>(all: Map<Key, Show[]>, key: Key, show: Show): void {
    const known = all.get(key);
    if (known === undefined) all.set(key, [show]);
    else known.push(show);
  }

  private write(signal: number | null, value: number): void {
    if (signal !== null) this.seated(() => this.actions.write(signal, value));
  }

  /** Shows the signal, the failure or the disturbance of an element; what it gives writes it. */
  private wire(element: PanelElement, show: Show): (value: number) => void {
    const { disturbance } = element;
    if (disturbance !== null) {
      this.listen(this.disturbances, disturbance, show);
      return (value) => this.seated(() => this.actions.disturb(disturbance, value !== 0));
    }
    if (element.failure === null) {
      const signal = this.bound(element.signal, show);
      return (value) => this.write(signal, value);
    }
    const [component, mode] = element.failure;
    this.listen(this.failures, `${component}.${mode}`, show);
    return (value) => this.seated(() => this.actions.fail(component, mode, value !== 0));
  }

  private fill_button(cell: HTMLElement, element: PanelElement): void {
    const key = make("button", { type: "button", class: "push", "aria-pressed": "false" }, ...broken(element.label));
    this.hold_down(key, element);
    if (element.action === "reset" && this.session.training !== null) {
      this.barred.set(key, say("A lesson is not reset: Repeat on the trainer's page begins it again."));
    }
    cell.append(key);
  }

  /** What a press of this element does to the session, before it presses the signal. */
  private act(element: PanelElement): void {
    switch (element.action) {
      case null:
        return;
      case "reset":
        return this.seated(() => this.actions.reset(this.panel.name));
    }
  }

  /** Makes a key of an element that is down while somebody presses it, by mouse, touch, keyboard or voice. */
  private hold_down(key: HTMLButtonElement, element: PanelElement): Press {
    let give = (_value: number): void => {};
    // What comes behind a reset is pressed in the session that begins.
    const down = (value: number): void => {
      if (value !== 0) this.act(element);
      give(value);
    };
    const held = new Press(down, (deed, ms) => void window.setTimeout(deed, ms), () => this.isHeld);
    give = this.wire(element, (value) => {
      key.setAttribute("aria-pressed", String(value !== 0));
      held.seen(value !== 0);
    });
    const press = (down: boolean): void => {
      if (!key.disabled || !down) held.press(down);
    };
    key.addEventListener("pointerdown", (event) => {
      key.setPointerCapture(event.pointerId);
      press(true);
    });
    for (const name of ["pointerup", "pointercancel", "blur"] as const) key.addEventListener(name, () => press(false));
    key.addEventListener("keydown", (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      press(true);
    });
    key.addEventListener("keyup", (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      press(false);
    });
    // A screen reader or a voice presses in no time, by a click alone.
    key.addEventListener("click", (event) => {
      if (event.detail > 0) return;
      press(true);
      press(false);
    });
    this.inputs.push(key);
    return held;
  }

  /** A mushroom on yellow: it latches when it is struck, and is turned to be released (ISO 13850). */
  private fill_emergency_stop(cell: HTMLElement, element: PanelElement): void {
    const state = make("span", { class: "stop-state" });
    const key = make("button", { type: "button", class: "stop", "aria-pressed": "false", "aria-label": element.label }, make("span", { class: "mushroom", "aria-hidden": "true" }));
    const write = this.wire(element, (value) => {
      key.setAttribute("aria-pressed", String(value !== 0));
      state.textContent = value !== 0 ? say("struck: press to turn and release") : say("ready");
    });
    key.addEventListener("click", () => write(key.getAttribute("aria-pressed") === "true" ? 0 : 1));
    this.inputs.push(key);
    cell.append(key, make("span", { class: "stop-label" }, ...broken(element.label)), state);
  }

  private fill_switch(cell: HTMLElement, element: PanelElement): void {
    const key = make("button", { type: "button", class: "toggle", role: "switch", "aria-checked": "false" }, ...broken(element.label));
    const write = this.wire(element, (value) => {
      key.setAttribute("aria-checked", String(value !== 0));
      key.dataset.state = value !== 0 ? say("on") : say("off");
    });
    key.dataset.state = say("off");
    key.addEventListener("click", () => write(key.getAttribute("aria-checked") === "true" ? 0 : 1));
    this.inputs.push(key);
    cell.append(key);
  }

  private fill_selector(cell: HTMLElement, element: PanelElement): void {
    const choices = element.choices.map((one) => make("option", { value: String(one.value) }, one.label));
    const select = make("select", {}, ...choices);
    const signal = this.bound(element.signal, (value) => (select.value = String(value)));
    select.addEventListener("change", () => this.write(signal, Number(select.value)));
    this.inputs.push(select);
    cell.append(make("label", {}, make("span", {}, element.label), select));
  }

  /** A slider; one that springs goes back to the middle when it is let go. */
  private fill_slider(cell: HTMLElement, element: PanelElement, name: string | null, label: string, springs = false): void {
    const step = this.grain(name, (element.max - element.min) / 200);
    const slider = make("input", {
      type: "range", "aria-label": label, min: String(element.min), max: String(element.max), step: step > 0 ? String(step) : "any",
    });
    const output = make("output", {}, "–");
    const signal = this.bound(name, (value) => {
      if (document.activeElement !== slider) slider.value = String(value);
      output.textContent = this.text(name, value);
    });
    slider.addEventListener("input", () => this.write(signal, Number(slider.value)));
    const let_go = (): void => {
      slider.value = String((element.min + element.max) / 2);
      this.write(signal, Number(slider.value));
    };
    if (springs) for (const event of ["pointerup", "pointercancel", "blur"]) slider.addEventListener(event, let_go);
    this.inputs.push(slider);
    cell.append(make("label", {}, make("span", {}, label, " ", output), slider));
  }

  private fill_lamp(cell: HTMLElement, element: PanelElement): void {
    const state = make("span", { class: "lamp-state" }, say("off"));
    const bulb = make("span", { class: "bulb" });
    this.wire(element, (value) => {
      bulb.classList.toggle("on", value !== 0);
      state.textContent = value !== 0 ? say("on") : say("off");
    });
    cell.append(bulb, make("span", { class: "lamp-label" }, ...broken(element.label), state));
  }

  private fill_number(cell: HTMLElement, element: PanelElement): void {
    const output = make("output", {}, "–");
    this.bound(element.signal, (value) => (output.textContent = this.text(element.signal, value)));
    cell.append(make("span", { class: "caption" }, element.label), output);
  }

  private fill_trend(cell: HTMLElement, element: PanelElement): void {
    const output = make("output", {}, "–");
    const hasRange = element.min !== 0 || element.max !== 1;
    const line = new Sparkline(element.label, hasRange ? element.min : null, hasRange ? element.max : null);
    this.bound(element.signal, (value) => {
      line.value(value);
      output.textContent = this.text(element.signal, value);
    });
    this.lines.push(line);
    cell.append(make("span", { class: "caption" }, element.label, " ", output), line.root);
  }

  private fill_bar(cell: HTMLElement, element: PanelElement): void {
    const bar = make("meter", { min: String(element.min), max: String(element.max), "aria-label": element.label });
    const output = make("output", {}, "–");
    this.bound(element.signal, (value) => {
      bar.value = value;
      output.textContent = this.text(element.signal, value);
    });
    cell.append(make("span", { class: "caption" }, element.label, " ", output), bar);
  }

  private fill_alarms(cell: HTMLElement, element: PanelElement): void {
    const list = new AlarmList(element.label === "" ? say("Alarms") : element.label, null, false);
    list.root.tabIndex = 0;
    list.show([], false);
    this.lists.push(list);
    const key = make("button", { type: "button" }, say("Acknowledge"));
    if (element.signal === null) key.addEventListener("click", () => this.actions.acknowledge());
    else {
      const held = this.hold_down(key, element);
      this.press_acknowledge = () => {
        held.press(true);
        held.press(false);
      };
    }
    cell.append(make("span", { class: "caption" }, element.label), list.root, key);
  }

  /** How fine a slider is: that of a whole number has no values in between. */
  private grain(name: string | null, share: number): number {
    const type = this.session.signals.find((one) => one.name === name)?.type ?? "";
    return /^U?[SDL]?INT$/.test(type) ? Math.max(1, Math.round(share)) : share;
  }

  private text(name: string | null, value: number): string {
    const signal = this.session.signals.find((one) => one.name === name);
    return signal === undefined ? say("no such signal") : shown(signal, value);
  }
}

/** Why nothing can be pressed at a panel, or what the first press does; nothing where all is well. */
export function why_not(seat: string, state: SeatState, isPast: boolean, isOver = false): string {
  if (isOver) return say("The run is over: nothing is operated any more. Run it again, or go on from a moment of it.");
  if (isPast) return say("This is the past: go back to now to operate the machine.");
  if (state === "taken") return say("Another viewer has the seat {seat}: you can operate when it is free.", { seat });
  return state === "free" ? say("Nobody has the seat {seat}: the first press takes it.", { seat }) : "";
}
