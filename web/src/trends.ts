// Trends: signals over virtual time, two cursors and their difference, events and verdicts.

import uPlot from "uplot";
import { button, make } from "./dom";
import { shown } from "./format";
import { History } from "./history";
import { curve, lane_options, style, upright } from "./lane";
import type { Session, Signal } from "./session";

const WINDOW_S = 20;
const LANE_PX = 62;

interface Lane {
  readonly signal: number;
  readonly root: HTMLElement;
  readonly reading: HTMLElement;
  readonly plot: uPlot;
}

export interface Mark {
  readonly t_ns: number;
  readonly text: string;
}

export class TrendsView {
  private readonly lanes: Lane[] = [];
  private readonly histories = new Map<number, History>();
  private range_s: readonly [number, number] | null = null;
  private cursors_s: readonly number[] = [];
  private marks: Mark[] = [];
  private now_s = 0;
  private isStale = true;

  constructor(
    private readonly place: HTMLElement,
    private readonly readout: HTMLElement,
    private readonly session: Session,
    private readonly changed: () => void,
  ) {
    new ResizeObserver(() => this.fit()).observe(place);
    const tick = (): void => {
      if (this.isStale) this.draw();
      window.setTimeout(tick, 100);
    };
    tick();
  }

  signals(): readonly number[] {
    return this.lanes.map((lane) => lane.signal);
  }

  push(signal: number, t_ns: number, value: number): void {
    let history = this.histories.get(signal);
    if (history === undefined) this.histories.set(signal, (history = new History()));
    history.push(t_ns / 1e9, value);
  }

  at(t_ns: number): void {
    this.now_s = t_ns / 1e9;
    this.isStale = true;
  }

  mark(mark: Mark): void {
    this.marks = [...this.marks.slice(-499), mark];
    this.isStale = true;
  }

  /** Adds a lane for a signal, or takes it away. */
  toggle(signal: number): void {
    const index = this.lanes.findIndex((lane) => lane.signal === signal);
    const [lane] = index < 0 ? [] : this.lanes.splice(index, 1);
    if (lane !== undefined) {
      lane.plot.destroy();
      lane.root.remove();
    } else this.add(signal);
    this.changed();
    this.isStale = true;
  }

  /** Draws all again in the colours of the theme. */
  repaint(): void {
    for (const lane of this.lanes) lane.plot.redraw(false, true);
  }

  /** Shows the last seconds again. */
  follow(): void {
    this.range_s = null;
    this.cursors_s = [];
    this.isStale = true;
  }

  private add(signal: number): void {
    const about = this.session.signals[signal];
    if (about === undefined) return;
    const reading = make("output", {}, "–");
    const away = button("×", () => this.toggle(signal), `Remove ${about.name}`);
    const head = make("div", { class: "lane-head" }, make("span", { title: about.about }, about.name), reading, away);
    const chart = make("div", { class: "lane-chart" });
    const root = make("div", { class: "lane" }, head, chart);
    this.place.append(root);
    const plot = new uPlot(this.options(about, this.lanes.length), [[], []], chart);
    plot.over.addEventListener("click", (event) => {
      const t_s = plot.posToVal(event.offsetX, "x");
      this.cursors_s = this.cursors_s.length >= 2 ? [t_s] : [...this.cursors_s, t_s];
      this.isStale = true;
    });
    plot.over.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(plot.posToVal(event.offsetX, "x"), event.deltaY > 0 ? 1.25 : 0.8);
    });
    this.lanes.push({ signal, root, reading, plot });
    this.fit();
  }

  private options(about: Signal, lane: number): uPlot.Options {
    const isBool = about.type === "BOOL";
    return lane_options({
      isBool, holds: true, isFilled: isBool || about.names.size > 0, strokes: [curve(lane)], group: "trends", height_px: LANE_PX,
      hooks: { setSelect: [(plot) => this.select(plot)], draw: [(plot) => this.draw_marks(plot)] },
    });
  }

  private select(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < 5) return;
    this.range_s = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.isStale = true;
  }

  private zoom(about_s: number, factor: number): void {
    const [from, to] = this.shown_s();
    const width = Math.min(1e6, Math.max(1e-3, (to - from) * factor));
    const share = (about_s - from) / (to - from);
    this.range_s = [about_s - width * share, about_s + width * (1 - share)];
    this.isStale = true;
  }

  private shown_s(): readonly [number, number] {
    return this.range_s ?? [Math.max(0, this.now_s - WINDOW_S), Math.max(WINDOW_S, this.now_s)];
  }

  private draw_marks(plot: uPlot): void {
    for (const mark of this.marks) upright(plot, mark.t_ns / 1e9, style("--warn"), [2, 3]);
    for (const cursor of this.cursors_s) upright(plot, cursor, style("--text"), []);
  }

  private fit(): void {
    for (const lane of this.lanes) lane.plot.setSize({ width: Math.max(120, lane.root.clientWidth - 4), height: LANE_PX });
    this.isStale = true;
  }

  private draw(): void {
    this.isStale = false;
    const [from, to] = this.shown_s();
    for (const lane of this.lanes) {
      const about = this.session.signals[lane.signal] as Signal;
      const history = this.histories.get(lane.signal);
      const part = history?.decimated(from, to, lane.plot.width) ?? { t_s: [], value: [] };
      // The server sends what changes: the last value holds until now.
      const held = part.value[part.value.length - 1];
      const until_s = Math.min(to, this.now_s);
      if (held !== undefined && (part.t_s[part.t_s.length - 1] as number) < until_s) {
        part.t_s.push(until_s);
        part.value.push(held);
      }
      lane.plot.batch(() => {
        lane.plot.setData([part.t_s, part.value], about.type !== "BOOL");
        lane.plot.setScale("x", { min: from, max: to });
      });
      const at_s = this.cursors_s[this.cursors_s.length - 1] ?? this.now_s;
      lane.reading.textContent = this.reading(about, history, at_s);
    }
    const [one, two] = this.cursors_s;
    this.readout.textContent =
      one === undefined ? "" : two === undefined ? `cursor ${one.toFixed(3)} s` : `${one.toFixed(3)} s to ${two.toFixed(3)} s: Δ ${(two - one).toFixed(3)} s`;
  }

  private reading(about: Signal, history: History | undefined, at_s: number): string {
    const value = history?.at(at_s) ?? undefined;
    const [one, two] = this.cursors_s;
    if (one === undefined || two === undefined || about.type === "BOOL" || history === undefined) return shown(about, value);
    const from = history.at(one);
    const to = history.at(two);
    return from === null || to === null ? shown(about, value) : `${shown(about, to)} (Δ ${Number((to - from).toPrecision(5))})`;
  }
}
