// What is forced: one list of all of it, and the page's own dialogue for a value, typed by its type. The page goes on meanwhile.

import { own, say } from "./say";
import { broken, button, make } from "./dom";
import { is_whole, neutral } from "./format";

/** What can be forced or written: a signal, or a variable of a PLC. */
export interface Target {
  readonly name: string;
  readonly type: string;
  readonly unit: string | null;
  readonly names: ReadonlyMap<number, string>;
  /** Its value as it is now; nothing if it is not known. */
  readonly value: () => string;
  readonly isForced: boolean;
  readonly force: (value: string) => void;
  readonly release: () => void;
  /** Writes it once, where that can be done. */
  readonly write?: (value: string) => void;
  /** It is changed, and not forced: a parameter of a component, which is one of these words if there are some. */
  readonly change?: { readonly words: readonly string[] };
}

/** How a value is entered. */
export type Entry = "two" | "list" | "number" | "text";

export function entry_of(type: string, names: ReadonlyMap<number, string>): Entry {
  if (type === "BOOL") return "two";
  if (names.size > 0) return "list";
  return is_whole(type) || /^L?REAL$/.test(type) ? "number" : "text";
}

/** Why a text is no value of the type; nothing if it is one. */
export function wrong_value(type: string, text: string): string | null {
  if (text.trim() === "") return say("Enter a value.");
  if (entry_of(type, new Map()) !== "number") return null;
  const value = Number(text);
  if (!Number.isFinite(value)) return say("Enter a number.");
  if (!is_whole(type)) return null;
  if (!Number.isInteger(value)) return say("Enter a whole number: the type is {type}.", { type });
  const bits = /^U?SINT$|^BYTE$/.test(type) ? 8 : /^U?INT$|^WORD$/.test(type) ? 16 : /^U?DINT$|^DWORD$/.test(type) ? 32 : 64;
  const isSigned = /^[SDL]?INT$/.test(type);
  const [low, high] = isSigned ? [-(2 ** (bits - 1)), 2 ** (bits - 1) - 1] : [0, 2 ** bits - 1];
  return value < low || value > high ? say("{type} goes from {low} to {high}.", { type, low, high }) : null;
}

export class ForceDialog {
  private readonly dialog = make("dialog", { class: "force", "aria-labelledby": "force-title" });
  private ticker: number | null = null;

  constructor() {
    document.body.append(this.dialog);
    this.dialog.addEventListener("close", () => {
      if (this.ticker !== null) window.clearInterval(this.ticker);
      this.ticker = null;
    });
  }

  /** Asks for a value. */
  ask(target: Target): void {
    const now = make("output", {}, target.value());
    const fault = make("p", { class: "fault", role: "alert" });
    const enter = (deed: (value: string) => void, typed: string): void => {
      const text = entry_of(target.type, target.names) === "number" ? neutral(typed) : typed;
      const wrong = wrong_value(target.type, text);
      fault.textContent = wrong ?? "";
      if (wrong !== null) return;
      deed(text.trim());
      this.dialog.close();
    };
    const verb = target.change !== undefined ? say("Change") : target.write === undefined ? say("Force") : say("Write or force");
    const title = make("h2", { id: "force-title" }, `${verb} `, ...broken(target.name));
    const held = target.change === undefined ? say("forced") : say("changed");
    const about = make("p", {}, ...(target.type === "" ? [] : [target.type, ", "]), say("now"), " ", now, target.isForced ? `, ${held}` : "");
    const release = button(target.change === undefined ? say("Release") : say("As in the scene"), () => {
      target.release();
      this.dialog.close();
    }, target.change === undefined ? say("Lets the value go on by itself") : say("Gives it the value that the scene has"));
    release.hidden = !target.isForced;
    this.dialog.replaceChildren(title, about, this.entry(target, enter), fault,
      make("div", { class: "toolbar" }, release, button(say("Cancel"), () => this.dialog.close())));
    this.dialog.showModal();
    // One types at once: the present value is chosen, so that it is typed over.
    const field = this.dialog.querySelector("input");
    if (field !== null && target.change !== undefined) field.value = target.value().split(" ")[0] ?? "";
    field?.select();
    this.ticker = window.setInterval(() => (now.textContent = target.value()), 100);
  }

  private entry(target: Target, enter: (deed: (value: string) => void, text: string) => void): HTMLElement {
    const deeds = (value: () => string): readonly HTMLElement[] => [
      ...(target.write === undefined ? [] : [button(say("Write once"), () => enter(target.write as (value: string) => void, value()))]),
      target.change === undefined
        ? button(say("Force"), () => enter(target.force, value()), say("Holds {name} until it is released", { name: target.name }))
        : button(say("Change"), () => enter(target.force, value()), say("Gives {name} this value from the next step on", { name: target.name })),
    ];
    const words = target.change?.words ?? [];
    if (words.length > 0) {
      const list = make("select", { "aria-label": say("Value of {name}", { name: target.name }) }, ...words.map((word) => make("option", {}, word)));
      return make("div", { class: "toolbar" }, list, ...deeds(() => list.value));
    }
    switch (entry_of(target.type, target.names)) {
      case "two":
        return make("div", { class: "two" }, ...["FALSE", "TRUE"].map((text) => make("div", {},
          button(text, () => enter(target.force, text), target.change === undefined ? say("Forces {name} to {text}", { name: target.name, text }) : say("Gives {name} this value from the next step on", { name: target.name })),
          ...(target.write === undefined ? [] : [button(say("Write {text} once", { text }), () => enter(target.write as (value: string) => void, text))]))));
      case "list": {
        const list = make("select", { "aria-label": say("Value of {name}", { name: target.name }) }, ...[...target.names].map(([value, name]) => make("option", { value: String(value) }, own(name))));
        return make("div", { class: "toolbar" }, list, ...deeds(() => list.value));
      }
      case "number":
      case "text": {
        const isNumber = entry_of(target.type, target.names) === "number";
        const field = make("input", { type: "text", inputmode: isNumber ? "decimal" : "text", "aria-label": say("Value of {name}", { name: target.name }), autocomplete: "off" });
        field.addEventListener("keydown", (event) => {
          if (event.key !== "Enter") return;
          // Otherwise it would press the key that opened the dialogue, which has the focus again.
          event.preventDefault();
          enter(target.force, field.value);
        });
        return make("div", { class: "toolbar" }, field, make("span", {}, target.unit ?? ""), ...deeds(() => field.value));
      }
    }
  }
}

/** One line of the list of forces. */
export interface Forced {
  readonly name: string;
  readonly value: string;
  readonly release: () => void;
}

/** All that is forced, in one list, behind a key that is there while something is. */
export class Forces {
  readonly key: HTMLButtonElement;
  private readonly dialog = make("dialog", { class: "force", "aria-labelledby": "forces-title" });
  private readonly rows = make("tbody");
  private all: readonly Forced[] = [];

  constructor(private readonly mayRelease: boolean) {
    this.key = button(say("Forced"), () => this.open(), say("Shows what is forced"));
    this.key.classList.add("forces");
    this.key.hidden = true;
    const release = button(say("Release all"), () => {
      for (const one of this.all) one.release();
      this.dialog.close();
    }, say("Lets all values go on by themselves"));
    release.hidden = !mayRelease;
    this.dialog.append(make("h2", { id: "forces-title" }, say("What is forced")), make("table", {}, this.rows),
      make("div", { class: "toolbar" }, release, button(say("Close"), () => this.dialog.close())));
    document.body.append(this.dialog);
  }

  show(all: readonly Forced[]): void {
    this.all = all;
    this.key.hidden = all.length === 0;
    this.key.textContent = say("{length} forced", { length: all.length });
    if (all.length === 0 && this.dialog.open) this.dialog.close();
    if (this.dialog.open) this.fill();
  }

  private open(): void {
    this.fill();
    this.dialog.showModal();
  }

  private fill(): void {
    this.rows.replaceChildren(...this.all.map((one) => make("tr", {},
      make("td", { class: "name" }, ...broken(one.name)), make("td", { class: "value" }, one.value),
      make("td", {}, ...(this.mayRelease ? [button(say("Release"), one.release, say("Release {name}", { name: one.name }))] : [])))));
  }
}

