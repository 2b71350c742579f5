// Trends: signals over virtual time, two cursors and their difference, events and verdicts, the moment that is shown.

import { own, say } from "./say";
import uPlot from "uplot";
import { broken, button, make } from "./dom";
import { form_for, form_of, in_form, is_whole, local, seconds_of, shown } from "./format";
import { History } from "./history";
import { curve, lane_options, style, upright } from "./lane";
import type { Session, Signal } from "./session";

const WINDOW_S = 20;
/** Lanes share the pane, and get no lower and no higher than this. */
const LANE_PX = [42, 110] as const;
/** The times below all lanes. */
const TIMES_PX = 24;

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

export interface TrendDeeds {
  /** Other signals are shown now. */
  readonly changed: () => void;
  /** Lets the viewer choose signals. */
  readonly choose: () => void;
}

export class TrendsView {
  private readonly lanes: Lane[] = [];
  private readonly histories = new Map<number, History>();
  private readonly empty: HTMLElement;
  private readonly times: { readonly root: HTMLElement; readonly plot: uPlot };
  private range_s: readonly [number, number] | null = null;
  private cursors_s: readonly number[] = [];
  private marks: Mark[] = [];
  private now_s = 0;
  /** The moment of the past that is shown; nothing at the live edge. */
  private past_s: number | null = null;
  private isStale = true;

  constructor(
    private readonly place: HTMLElement,
    private readonly readout: HTMLElement,
    private readonly session: Session,
    private readonly does: TrendDeeds,
  ) {
    this.empty = make("p", { class: "empty" }, say("No signal is shown here. Choose signals, and press + beside those that you want to follow."), " ", button(say("Choose signals"), does.choose));
    const chart = make("div", { class: "lane-chart" });
    const options = lane_options({ isBool: true, isBare: false, holds: true, isFilled: false, strokes: ["transparent"], group: "trends", height_px: TIMES_PX, values: () => "", hooks: {} });
    this.times = { root: make("div", { class: "lane times" }, make("div"), chart), plot: new uPlot(options, [[], []], chart) };
    place.append(this.empty, this.times.root);
    this.times.root.hidden = true;
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
    this.history(signal).push(t_ns / 1e9, value);
  }

  /** Forgets what was after this time; signals that have not changed since go on from the values that they have. */
  rewind(t_ns: number, values: ReadonlyMap<number, number>): void {
    for (const [signal, history] of this.histories) {
      const value = values.get(signal);
      if (value !== undefined) history.push(t_ns / 1e9, value);
    }
    this.marks = this.marks.filter((mark) => mark.t_ns <= t_ns);
    this.isStale = true;
  }

  /** Adds a value of the past. */
  insert(signal: number, t_ns: number, value: number): void {
    this.history(signal).insert(t_ns / 1e9, value);
    this.isStale = true;
  }

  /** What is known of a signal at a time, for tests. */
  known(signal: number, t_s: number): number | null {
    return this.histories.get(signal)?.at(t_s) ?? null;
  }

  /** The live edge is at this time. */
  at(t_ns: number): void {
    this.now_s = Math.max(this.past_s === null ? 0 : this.now_s, t_ns / 1e9);
    this.isStale = true;
  }

  /** A moment of the past is shown, or the live edge. */
  see_past(t_ns: number | null): void {
    this.past_s = t_ns === null ? null : t_ns / 1e9;
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
    this.empty.hidden = this.lanes.length > 0;
    this.times.root.hidden = this.lanes.length === 0;
    this.fit();
    this.does.changed();
  }

  /** Draws all again in the colours of the theme. */
  repaint(): void {
    for (const { plot } of [...this.lanes, this.times]) plot.redraw(false, true);
  }

  /** Shows the last seconds again. */
  follow(): void {
    this.range_s = null;
    this.cursors_s = [];
    this.isStale = true;
  }

  private history(signal: number): History {
    let history = this.histories.get(signal);
    if (history === undefined) this.histories.set(signal, (history = new History()));
    return history;
  }

  private add(signal: number): void {
    const about = this.session.signals[signal];
    if (about === undefined) return;
    const reading = make("output", {}, "–");
    const away = button("×", () => this.toggle(signal), say("Remove {name}", { name: about.name }));
    away.setAttribute("aria-label", say("Remove {name}", { name: about.name }));
    const number = this.lanes.length;
    const name = make("span", { class: "lane-name", title: about.about === "" ? about.name : `${about.name}: ${about.about}` }, ...broken(about.name));
    const head = make("div", { class: "lane-head" }, name, reading, away);
    head.style.borderLeftColor = curve(number);
    const chart = make("div", { class: "lane-chart" });
    const root = make("div", { class: "lane" }, head, chart);
    this.times.root.before(root);
    const plot = new uPlot(this.options(about, number), [[], []], chart);
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
  }

  private options(about: Signal, lane: number): uPlot.Options {
    const isBool = about.type === "BOOL";
    const write = (value: number): string => {
      if (about.names.size > 0) return own(about.names.get(value) ?? "");
      // An axis has the prefix of what is read beside it, and as many places as its marks need.
      const form = form_of(about, 0);
      return local(String(Number((value / form.by).toPrecision(4))));
    };
    return lane_options({
      isBool, isBare: true, holds: true, isFilled: isBool || about.names.size > 0, strokes: [curve(lane)], group: "trends", height_px: LANE_PX[0],
      hooks: { setSelect: [(plot) => this.select(plot)], draw: [(plot) => this.draw_marks(plot)] }, ...(isBool ? {} : { values: write }),
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
    return this.range_s ?? span_s(this.now_s, this.past_s);
  }

  private draw_marks(plot: uPlot): void {
    for (const mark of this.marks) upright(plot, mark.t_ns / 1e9, style("--warn"), [2, 3]);
    for (const cursor of this.cursors_s) upright(plot, cursor, style("--text"), []);
    if (this.past_s !== null) upright(plot, this.past_s, style("--past"), [], 3);
  }

  private fit(): void {
    const room = (this.place.clientHeight - TIMES_PX - 4) / Math.max(1, this.lanes.length);
    const height = Math.floor(Math.min(LANE_PX[1], Math.max(LANE_PX[0], room)));
    for (const { plot, root } of this.lanes) {
      root.style.height = `${height}px`;
      plot.setSize({ width: Math.max(120, plot.root.parentElement?.clientWidth ?? 0), height });
    }
    const [first] = this.lanes;
    if (first !== undefined) this.times.plot.setSize({ width: first.plot.width, height: TIMES_PX });
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
      const at_s = this.cursors_s[this.cursors_s.length - 1] ?? this.past_s ?? this.now_s;
      lane.reading.textContent = this.reading(about, history, at_s);
      lane.plot.batch(() => {
        lane.plot.setData([part.t_s, part.value], about.type !== "BOOL");
        lane.plot.setScale("x", { min: from, max: to });
      });
    }
    this.times.plot.batch(() => {
      this.times.plot.setData([[from, to], [0, 0]], false);
      this.times.plot.setScale("x", { min: from, max: to });
    });
    const [one, two] = this.cursors_s;
    const past = this.past_s === null ? "" : say("past {at}", { at: seconds_of(this.past_s) });
    this.readout.textContent =
      one === undefined ? past : two === undefined ? say("cursor {at}", { at: seconds_of(one) }) : say("{from} to {to}: Δ {time}", { from: seconds_of(one), to: seconds_of(two), time: seconds_of(two - one) });
  }

  private reading(about: Signal, history: History | undefined, at_s: number): string {
    const value = history?.at(at_s) ?? undefined;
    const [one, two] = this.cursors_s;
    if (one === undefined || two === undefined || about.type === "BOOL" || history === undefined) return shown(about, value);
    const from = history.at(one);
    const to = history.at(two);
    if (from === null || to === null) return shown(about, value);
    const way = to - from;
    return `${shown(about, to)} (Δ ${in_form(way, form_for(about.unit, is_whole(about.type), way))})`;
  }
}

/** The part of time that trends show: the last seconds, or what is about the moment of the past. */
export function span_s(now_s: number, past_s: number | null): readonly [number, number] {
  const end_s = past_s === null || past_s > now_s - WINDOW_S ? now_s : Math.min(now_s, past_s + WINDOW_S / 2);
  return [Math.max(0, end_s - WINDOW_S), Math.max(WINDOW_S, end_s)];
}
