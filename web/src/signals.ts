// A table of signals with their values, any of which can be put on a trend.

import { button, make } from "./dom";
import { shown } from "./format";
import type { Session } from "./protocol";

/** Rows shown at once; a filter finds the others. */
const ROWS = 60;

export class SignalTable {
  readonly root: HTMLElement;
  private readonly body = make("tbody");
  private readonly cells = new Map<number, HTMLElement>();
  private filter = "";

  constructor(
    private readonly session: Session,
    private readonly values: ReadonlyMap<number, number>,
    private readonly trend: (signal: number) => void,
    private readonly changed: () => void,
  ) {
    const input = make("input", { type: "search", class: "filter", placeholder: "Filter signals", "aria-label": "Filter signals" });
    input.addEventListener("input", () => {
      this.filter = input.value.toLowerCase();
      this.fill();
      this.changed();
    });
    const head = make("thead", {}, make("tr", {}, ...["Signal", "Writer", "Value", "Trend"].map((one) => make("th", { scope: "col" }, one))));
    this.root = make("div", {}, input, make("table", {}, head, this.body));
    this.fill();
  }

  /** The signals in the table now. */
  signals(): readonly number[] {
    return [...this.cells.keys()];
  }

  show(signal: number): void {
    const cell = this.cells.get(signal);
    const about = this.session.signals[signal];
    if (cell !== undefined && about !== undefined) cell.textContent = shown(about, this.values.get(signal));
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
    const key = button("＋", () => this.trend(signal), `Trend of ${name}`);
    key.setAttribute("aria-label", `Trend of ${name}`);
    return make("tr", {}, make("td", { class: "name", title: about?.about ?? "" }, name), make("td", {}, about?.writer ?? ""), cell, make("td", {}, key));
  }
}
