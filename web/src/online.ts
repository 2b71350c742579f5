// The PLC online: a tree of its variables, a list of those that are watched, and what is written and forced.

import { say } from "./say";
import { broken, button, make } from "./dom";
import type { Forced, Target } from "./forces";
import type { Ask, Variables } from "./message";
import type { Session } from "./session";

const FOUND_MAX = 200;

/** A part of a PLC's variables: an instance, a structure, an array, or one variable. */
interface Branch {
  readonly parts: Map<string, Branch>;
  variable: number | null;
}

/** The variables of all PLCs by their paths, each PLC a branch of its own. */
export function tree(plcs: Session["plcs"]): Branch {
  const root: Branch = { parts: new Map(), variable: null };
  let number = 0;
  for (const plc of plcs) {
    for (const variable of plc.variables) {
      let branch = root;
      for (const part of [plc.client, ...variable.path.split(/(?=\[)|\./)]) {
        let next = branch.parts.get(part);
        if (next === undefined) branch.parts.set(part, (next = { parts: new Map(), variable: null }));
        branch = next;
      }
      branch.variable = number;
      number += 1;
    }
  }
  return root;
}

export class OnlineView {
  readonly root = make("div", { class: "online" });
  private readonly variables: Session["plcs"][number]["variables"];
  private readonly values = new Map<number, string>();
  private readonly watched: number[] = [];
  private readonly list = make("tbody");
  private readonly cells = new Map<number, HTMLElement>();
  private forced: ReadonlySet<number> = new Set();
  private executed: ReadonlyMap<string, ReadonlySet<number>> = new Map();

  constructor(
    session: Session,
    private readonly ask: (ask: Ask) => void,
    private readonly changed: () => void,
    private readonly enter: (target: Target) => void,
  ) {
    this.variables = session.plcs.flatMap((plc) => plc.variables);
    if (this.variables.length === 0) return;
    const filter = make("input", { type: "search", placeholder: say("Find a variable"), "aria-label": say("Find a variable") });
    const found = make("div", { class: "tree" });
    const all = tree(session.plcs);
    const fill = (): void => {
      const wanted = filter.value.trim().toLowerCase();
      found.replaceChildren(...(wanted === "" ? this.branches(all) : this.matches(wanted)));
    };
    filter.addEventListener("input", fill);
    fill();
    const head = make("tr", {}, ...[say("Variable"), say("Value"), ""].map((text) => make("th", { scope: "col" }, text)));
    const table = make("table", { "aria-label": say("Watched variables") }, make("thead", {}, head), this.list);
    this.root.append(make("h3", {}, say("Watch list")), table, filter, found);
  }

  /** The variables whose values are wanted, with those beside `lines`. */
  wanted(beside: readonly number[]): readonly number[] {
    return [...new Set([...this.watched, ...beside])].sort((a, b) => a - b);
  }

  show(seen: Variables): void {
    for (const [number, value] of seen.values) this.values.set(number, value);
    this.forced = new Set(seen.forced);
    const executed = new Map<string, Set<number>>();
    for (const [file, line] of seen.executed) {
      const lines = executed.get(file) ?? new Set<number>();
      executed.set(file, lines.add(line));
    }
    this.executed = executed;
    for (const [number, cell] of this.cells) this.fill(number, cell);
  }

  /** What is forced of the variables. */
  forces(): readonly Forced[] {
    return [...this.forced].map((variable) => ({
      name: this.variables[variable]?.path ?? "", value: this.values.get(variable) ?? "–",
      release: () => this.ask({ type: "variable", variable, action: "release", value: "" }),
    }));
  }

  /** A variable as it stands beside a line. */
  reading(number: number): string | null {
    const [variable, value] = [this.variables[number], this.values.get(number)];
    if (variable === undefined || value === undefined) return null;
    return `${variable.path} = ${value}${this.forced.has(number) ? " (forced)" : ""}`;
  }

  /** Whether a line has been executed; nothing where that is not noted. */
  was_executed(file: string, line: number): boolean | null {
    return this.executed.size === 0 ? null : this.executed.get(file)?.has(line) ?? false;
  }

  private branches(branch: Branch): HTMLElement[] {
    return [...branch.parts].map(([name, part]) => {
      if (part.variable !== null) return this.leaf(part.variable, name);
      const inside = make("div", { class: "branch" });
      const node = make("details", {}, make("summary", {}, name), inside);
      // What is inside is made when somebody looks: programs have thousands of variables.
      node.addEventListener("toggle", () => {
        if (node.open && inside.childElementCount === 0) inside.append(...this.branches(part));
      });
      return node;
    });
  }

  private matches(wanted: string): HTMLElement[] {
    const found = this.variables.flatMap((one, number) => (one.path.toLowerCase().includes(wanted) ? [number] : []));
    return found.slice(0, FOUND_MAX).map((number) => this.leaf(number, this.variables[number]?.path ?? ""));
  }

  private leaf(number: number, name: string): HTMLElement {
    const variable = this.variables[number];
    const watch = button(say("Watch"), () => this.watch(number), say("Watch {name}", { name: variable?.path ?? name }));
    return make("div", { class: "leaf" }, make("span", { title: variable?.type ?? "" }, name), watch);
  }

  private watch(number: number): void {
    if (this.watched.includes(number)) return;
    this.watched.push(number);
    const path = this.variables[number]?.path ?? "";
    const value = make("td", { class: "value" });
    const row = make("tr", {}, make("td", { class: "name" }, ...broken(path)), value);
    const away = button("×", () => {
      this.watched.splice(this.watched.indexOf(number), 1);
      this.cells.delete(number);
      row.remove();
      this.changed();
    }, say("Watch {path} no more", { path }));
    row.append(make("td", { class: "deeds" }, button(say("Write or force"), () => this.operate(number), say("Write or force {path}", { path })), away));
    this.list.append(row);
    this.cells.set(number, value);
    this.fill(number, value);
    this.changed();
  }

  /** Asks for a value that is written or forced: the machine moves by it. */
  private operate(variable: number): void {
    const about = this.variables[variable];
    if (about === undefined) return;
    const deed = (action: "write" | "force" | "release") => (value = ""): void => this.ask({ type: "variable", variable, action, value });
    this.enter({
      name: about.path, type: about.type, unit: null, names: new Map(),
      value: () => this.values.get(variable) ?? "–",
      isForced: this.forced.has(variable),
      force: deed("force"), write: deed("write"), release: deed("release"),
    });
  }

  private fill(number: number, cell: HTMLElement): void {
    cell.textContent = `${this.values.get(number) ?? "–"}${this.forced.has(number) ? " (forced)" : ""}`;
    cell.classList.toggle("forced", this.forced.has(number));
  }
}
