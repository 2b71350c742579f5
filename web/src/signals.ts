// A table of signals with their values, any of which can be put on a trend.

import { say } from "./say";
import { broken, button, make } from "./dom";
import { exact, shown } from "./format";
import type { Session } from "./session";

/** Rows shown at once; a filter finds the others. */
const ROWS = 60;

export interface SignalDeeds {
  /** Puts a signal on a trend, or takes it away. */
  readonly trend: (signal: number) => void;
  /** Other signals are in the table now. */
  readonly changed: () => void;
  /** Asks for a value at which a signal is held. */
  readonly force: (signal: number) => void;
}

export class SignalTable {
  readonly root: HTMLElement;
  private readonly input: HTMLInputElement;
  private readonly body = make("tbody");
  private readonly cells = new Map<number, HTMLElement>();
  private filter = "";
  private forced: ReadonlySet<number> = new Set();

  constructor(
    private readonly session: Session,
    private readonly values: ReadonlyMap<number, number>,
    private readonly does: SignalDeeds,
  ) {
    const input = make("input", { type: "search", class: "filter", placeholder: say("Filter signals"), "aria-label": say("Filter signals") });
    input.addEventListener("input", () => {
      this.filter = input.value.toLowerCase();
      this.fill();
      this.does.changed();
    });
    const head = make("thead", {}, make("tr", {}, ...[say("Signal"), say("Writer"), say("Value"), ""].map((one) => make("th", { scope: "col" }, one))));
    this.input = input;
    this.root = make("div", {}, input, make("table", {}, head, this.body));
    this.fill();
  }

  /** The signals in the table now. */
  signals(): readonly number[] {
    return [...this.cells.keys()];
  }

  /** Lets the viewer type what is looked for. */
  focus(): void {
    this.input.focus();
  }

  show(signal: number): void {
    const cell = this.cells.get(signal);
    const about = this.session.signals[signal];
    if (cell === undefined || about === undefined) return;
    const isForced = this.forced.has(signal);
    cell.textContent = `${shown(about, this.values.get(signal))}${isForced ? " (forced)" : ""}`;
    cell.title = exact(about, this.values.get(signal));
    cell.classList.toggle("forced", isForced);
  }

  /** The signals that are forced now. */
  show_forced(forced: ReadonlySet<number>): void {
    this.forced = forced;
    for (const signal of this.cells.keys()) this.show(signal);
  }

  private fill(): void {
    this.cells.clear();
    const rows = this.session.signals
      .flatMap((about, signal) => (about.name.toLowerCase().includes(this.filter) ? [signal] : []))
      .slice(0, ROWS);
    this.body.replaceChildren(...rows.map((signal) => this.row(signal)));
    for (const signal of rows) this.show(signal);
  }

  private row(signal: number): HTMLElement {
    const about = this.session.signals[signal];
    const cell = make("td", { class: "value" });
    this.cells.set(signal, cell);
    const name = about?.name ?? "";
    const key = button("+", () => this.does.trend(signal), say("Trend of {name}", { name }));
    key.setAttribute("aria-label", say("Trend of {name}", { name }));
    const keys = make("td", { class: "deeds" }, key);
    if (this.session.live && this.session.training?.role !== "trainee") {
      const force = button(say("Force"), () => this.does.force(signal), say("Force {name}, or release it", { name }));
      force.setAttribute("aria-label", say("Force {name}", { name }));
      keys.append(force);
    }
    return make("tr", {}, make("td", { class: "name", title: about?.about ?? "" }, ...broken(name)), make("td", {}, about?.writer ?? ""), cell, keys);
  }
}
