// A chart in the place of a report's picture: lanes to be enlarged and read, as the page's trends are.

import uPlot from "uplot";
import { button, make } from "../dom";
import { seconds } from "../format";
import { say } from "../say";
import { axis_room, curve, lane_options, style, upright } from "../lane";
import { aligned, value_at, written, type Chart, type ChartPanel } from "./data";

/** A report has more room than the page. */
const CHART_PX = 110;
/** Names of values take no more than this of it; no name of the repository's does. */
const NAMES_PX = 320;

interface Lane {
  readonly panel: ChartPanel;
  readonly reading: HTMLElement;
  readonly plot: uPlot;
}

export class ChartView {
  readonly root: HTMLElement;
  private readonly lanes: Lane[] = [];
  private readonly readout = make("output", {});
  private readonly whole_s: readonly [number, number];
  private shown_s: readonly [number, number];
  private readonly axis_px: number;

  constructor(
    private readonly chart: Chart,
    private readonly group: string,
  ) {
    const times = chart.panels.flatMap((panel) => panel.runs).flatMap((run) => [run.t_ns[0], run.t_ns[run.t_ns.length - 1]]);
    const known = times.filter((t_ns) => t_ns !== undefined);
    const [from_s, to_s] = known.length === 0 ? [0, 1] : [Math.min(...known) / 1e9, Math.max(...known) / 1e9];
    this.whole_s = [from_s, to_s > from_s ? to_s : from_s + 1];
    this.shown_s = this.whole_s;
    const runs = chart.runs.length > 1 ? chart.runs.map((name, run) => legend(name, run)) : [];
    const tools = make("div", { class: "chart-tools" }, button(say("Whole"), () => this.show(this.whole_s)), ...runs, this.readout);
    this.root = make("div", { class: "chart" }, tools);
    this.axis_px = axis_room(chart.panels.flatMap((panel) => panel.names).map(([, name]) => name), NAMES_PX);
    for (const panel of chart.panels) this.add(panel);
    new ResizeObserver(() => this.fit()).observe(this.root);
  }

  /** Draws all again in the colours of the theme. */
  repaint(): void {
    for (const lane of this.lanes) lane.plot.redraw(false, true);
  }

  private add(panel: ChartPanel): void {
    const reading = make("output", {});
    const head = make("div", { class: "chart-head" }, make("span", {}, panel.unit === null ? panel.signal : `${panel.signal} (${panel.unit})`), reading);
    const place = make("div", { class: "chart-lane" });
    this.root.append(head, place);
    const isBool = panel.steps && panel.runs.every((run) => run.values.every((value) => value === 0 || value === 1 || value === null));
    const names = panel.names;
    const options = lane_options({
      isBool: isBool && names.length === 0, holds: panel.steps, isFilled: false, group: this.group, height_px: CHART_PX, axis_px: this.axis_px,
      strokes: panel.runs.map((_, run) => curve(run)),
      hooks: { setSelect: [(plot) => this.select(plot)], draw: [(plot) => this.draw_marks(plot)], setCursor: [(plot) => this.read(plot)] },
      ...(names.length === 0 ? {} : { values: (value: number) => names.find(([known]) => known === value)?.[1] ?? "" }),
    });
    const plot = new uPlot(options, aligned(panel) as unknown as uPlot.AlignedData, place);
    plot.over.addEventListener("dblclick", () => this.show(this.whole_s));
    plot.over.addEventListener("wheel", (event) => {
      // The page scrolls; with a key the lanes are enlarged.
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      this.zoom(plot.posToVal(event.offsetX, "x"), (event.deltaY || event.deltaX) > 0 ? 1.25 : 0.8);
    });
    this.lanes.push({ panel, reading, plot });
  }

  private select(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < 5) return;
    this.show([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  private zoom(about_s: number, factor: number): void {
    const [from, to] = this.shown_s;
    const width = Math.max(1e-6, (to - from) * factor);
    const share = (about_s - from) / (to - from);
    this.show([Math.max(this.whole_s[0], about_s - width * share), Math.min(this.whole_s[1], about_s + width * (1 - share))]);
  }

  private show(range_s: readonly [number, number]): void {
    this.shown_s = range_s;
    for (const lane of this.lanes) lane.plot.setScale("x", { min: range_s[0], max: range_s[1] });
  }

  /** What all lanes are where the pointer is. */
  private read(plot: uPlot): void {
    const left = plot.cursor.left ?? -1;
    const t_s = left < 0 ? null : plot.posToVal(left, "x");
    const mark = t_s === null ? undefined : this.chart.marks.find((one) => Math.abs(plot.valToPos(one.t_ns / 1e9, "x") - left) < 4);
    this.readout.textContent = t_s === null ? "" : `${seconds(t_s * 1e9)}${mark === undefined ? "" : `: ${mark.label}`}`;
    for (const { panel, reading } of this.lanes) {
      const values = t_s === null ? [] : panel.runs.map((_, run) => written(panel, value_at(panel, run, t_s)));
      reading.textContent = (new Set(values).size > 1 ? values : values.slice(0, 1)).join(" | ");
    }
  }

  private draw_marks(plot: uPlot): void {
    for (const mark of this.chart.marks) upright(plot, mark.t_ns / 1e9, style("--warn"), [2, 3]);
  }

  private fit(): void {
    const width = Math.max(200, this.root.clientWidth - 4);
    for (const lane of this.lanes) lane.plot.setSize({ width, height: CHART_PX });
    this.show(this.shown_s);
  }
}

function legend(name: string, run: number): HTMLElement {
  const mark = make("span", { class: "chart-run" }, name);
  mark.style.borderColor = curve(run);
  return mark;
}
