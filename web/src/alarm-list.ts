// Alarms as people see them: a banner with the most urgent one, lists of all, each priority with a colour and a shape of its own.

import { most_urgent, PRIORITIES, type Standing } from "./alarms";
import { button, draw, make } from "./dom";
import { seconds } from "./format";
import { own, say, type Text } from "./say";
import type { Priority } from "./session";

/** What people do about alarms. */
export interface AlarmActions {
  readonly acknowledge: (alarms: readonly number[]) => void;
  /** Puts one aside for so many seconds, or takes it back. */
  readonly shelve: (alarm: number, for_s: number | null) => void;
  /** Shows all of them. */
  readonly open: () => void;
}

/** For how long an alarm can be put aside, s. */
const SHELVES: readonly (readonly [number, Text])[] = [[60, "1 min"], [300, "5 min"], [1800, "30 min"], [7200, "2 h"]];

/** The outlines of the priorities, on a square of 20: an octagon, a triangle, a square on its corner, a circle. */
const OUTLINES: Readonly<Record<Priority, string>> = {
  critical: "M6 1H14L19 6V14L14 19H6L1 14V6Z",
  high: "M10 1L19.5 18.5H0.5Z",
  medium: "M10 0.5L19.5 10L10 19.5L0.5 10Z",
  low: "M10 1A9 9 0 1 1 9.99 1Z",
};

/** The sign of a priority: its shape, and its number from 1 for the most urgent. */
export function sign(priority: Priority): SVGElement {
  const number = String(PRIORITIES.indexOf(priority) + 1);
  const digit = draw("text", { x: 10, y: priority === "high" ? 16.5 : 14.5, "text-anchor": "middle" }, number);
  return draw("svg", { viewBox: "0 0 20 20", class: `sign ${priority}`, "aria-hidden": "true" }, draw("path", { d: OUTLINES[priority] }), digit);
}

/** How an alarm stands, in words. */
export function stand(one: Standing): string {
  if (one.aside_ns !== null) return say("put aside until {time}", { time: seconds(one.aside_ns) });
  if (one.gone_ns !== null) return say("gone, not acknowledged");
  return one.isSeen ? say("on, acknowledged") : say("on, not acknowledged");
}

/** A list of alarms, in which a row stays the same element while its alarm changes. */
export class AlarmList {
  readonly root: HTMLUListElement;
  private readonly rows = new Map<number, { root: HTMLLIElement; shown: string }>();
  private readonly none = make("li", { class: "empty" }, say("No alarm."));
  private isResting = false;

  /** Without `actions` it only shows. */
  constructor(label: string, private readonly actions: AlarmActions | null, private readonly isByOne: boolean) {
    this.root = make("ul", { class: "alarm-list", "aria-label": label });
    this.root.append(this.none);
  }

  show(all: readonly Standing[], isResting: boolean): void {
    this.isResting = isResting;
    const rows = all.map((one) => this.row(one));
    const wanted: readonly HTMLElement[] = rows.length === 0 ? [this.none] : rows;
    // A row that stays in its place keeps the focus of what is in it.
    if (wanted.length !== this.root.children.length || wanted.some((row, at) => this.root.children[at] !== row)) {
      const focus = document.activeElement;
      this.root.replaceChildren(...wanted);
      if (focus instanceof HTMLElement && this.root.contains(focus)) focus.focus();
    }
    const there = new Set(all.map((one) => one.alarm));
    for (const alarm of this.rows.keys()) if (!there.has(alarm)) this.rows.delete(alarm);
  }

  private row(one: Standing): HTMLLIElement {
    const known = this.rows.get(one.alarm) ?? { root: make("li"), shown: "" };
    this.rows.set(one.alarm, known);
    const shown = `${one.came_ns} ${one.gone_ns} ${one.isSeen} ${one.aside_ns} ${this.isResting}`;
    if (known.shown === shown) return known.root;
    known.shown = shown;
    known.root.className = `${one.about.priority} ${one.aside_ns !== null ? "aside" : one.isSeen ? "seen" : "new"} ${one.gone_ns === null ? "on" : "gone"}`;
    const name = own(one.about.name);
    const when = one.gone_ns === null ? seconds(one.came_ns) : say("{from} to {to}", { from: seconds(one.came_ns), to: seconds(one.gone_ns) });
    known.root.replaceChildren(
      sign(one.about.priority),
      make("span", { class: "alarm-name" }, name, make("span", { class: "alarm-about" }, `${say(one.about.priority)}, ${stand(one)}`)),
      make("span", { class: "alarm-time" }, when),
      ...this.deeds(one, name));
    return known.root;
  }

  private deeds(one: Standing, name: string): readonly HTMLElement[] {
    const { actions } = this;
    if (actions === null) return [];
    const keys: (HTMLButtonElement | HTMLSelectElement)[] = [];
    if (this.isByOne && !one.isSeen) keys.push(button(say("Acknowledge"), () => actions.acknowledge([one.alarm]), say("Acknowledge {name}", { name })));
    if (one.aside_ns !== null) keys.push(button(say("Take back"), () => actions.shelve(one.alarm, null), say("Take back {name}", { name })));
    else {
      const choice = make("select", { "aria-label": say("Put {name} aside", { name }), title: say("Puts it aside: it asks for nobody until then") },
        make("option", { value: "" }, say("Aside…")), ...SHELVES.map(([for_s, text]) => make("option", { value: String(for_s) }, say(text))));
      choice.addEventListener("change", () => {
        if (choice.value !== "") actions.shelve(one.alarm, Number(choice.value));
      });
      keys.push(choice);
    }
    for (const key of keys) {
      key.disabled = this.isResting;
      if (key instanceof HTMLButtonElement) key.setAttribute("aria-label", key.title);
    }
    return [make("span", { class: "alarm-deeds" }, ...keys)];
  }
}

/** The most urgent alarm that is not acknowledged, always in sight. */
export class AlarmBanner {
  readonly root: HTMLElement;
  private readonly place = make("span", { class: "banner-sign" });
  private readonly text = make("span", { class: "banner-text", role: "status" });
  private readonly key: HTMLButtonElement;
  private urgent: Standing | null = null;
  private shown = "";

  constructor(actions: AlarmActions, sound: HTMLElement) {
    this.key = button(say("Acknowledge"), () => {
      if (this.urgent !== null) actions.acknowledge([this.urgent.alarm]);
    }, say("Acknowledges this alarm"));
    const all = button(say("All alarms"), actions.open, say("Shows the list of alarms"));
    this.root = make("section", { class: "banner", "aria-label": say("Most urgent alarm") }, this.place, this.text, this.key, all, sound);
  }

  show(all: readonly Standing[], isResting: boolean): void {
    this.urgent = most_urgent(all);
    this.key.disabled = isResting;
    const { urgent } = this;
    const others = all.filter((one) => one !== urgent && one.aside_ns === null).length;
    const shown = `${urgent?.alarm} ${urgent?.came_ns} ${urgent?.gone_ns} ${others}`;
    if (shown === this.shown) return;
    this.shown = shown;
    this.root.className = `banner ${urgent === null ? "calm" : `${urgent.about.priority} ${urgent.gone_ns === null ? "on" : "gone"}`}`;
    this.key.hidden = urgent === null;
    this.place.replaceChildren(...(urgent === null ? [] : [sign(urgent.about.priority)]));
    if (urgent === null) {
      this.text.replaceChildren(others === 0 ? say("No alarm.") : say("No new alarm; still on: {count}", { count: others }));
      return;
    }
    const more = others === 0 ? "" : ` · ${say("others: {count}", { count: others })}`;
    this.text.replaceChildren(make("b", {}, own(urgent.about.name)),
      ` ${say(urgent.about.priority)}, ${stand(urgent)} · ${seconds(urgent.came_ns)}${more}`);
  }
}
