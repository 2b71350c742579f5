// The last minute of a value on a panel, as a line.

import { say } from "./say";
import { History } from "./history";

const SVG = "http://www.w3.org/2000/svg";
const WINDOW_S = 60;
const [WIDTH, HEIGHT] = [240, 60];

export class Sparkline {
  readonly root: SVGSVGElement;
  private readonly line: SVGPolylineElement;
  private readonly history = new History(20_000);
  private drawn_s = -Infinity;
  private last: number | null = null;

  constructor(
    label: string,
    private readonly min: number | null,
    private readonly max: number | null,
  ) {
    this.root = document.createElementNS(SVG, "svg");
    this.root.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
    this.root.setAttribute("preserveAspectRatio", "none");
    this.root.setAttribute("class", "sparkline");
    this.root.setAttribute("role", "img");
    this.root.setAttribute("aria-label", say("{label}, the last {WINDOW_S} s", { label, WINDOW_S }));
    this.line = document.createElementNS(SVG, "polyline");
    this.root.append(this.line);
  }

  value(value: number): void {
    this.last = value;
  }

  /** The time of a picture, s; the line is drawn ten times a second of virtual time at most. */
  at(t_s: number): void {
    if (this.last === null) return;
    this.history.push(t_s, this.last);
    if (t_s >= this.drawn_s && t_s - this.drawn_s < 0.1) return;
    this.drawn_s = t_s;
    this.line.setAttribute("points", points(this.history, t_s, this.min, this.max).map((point) => point.join(",")).join(" "));
  }
}

/** The line of a history up to `t_s`, between `min` and `max`, or what the values need. */
export function points(history: History, t_s: number, min: number | null, max: number | null): readonly (readonly [number, number])[] {
  const begin_s = Math.max(0, t_s - WINDOW_S);
  const samples = Array.from({ length: 121 }, (_, index) => begin_s + ((t_s - begin_s) * index) / 120)
    .map((at_s) => [at_s, history.at(at_s)] as const)
    .filter((sample): sample is readonly [number, number] => sample[1] !== null && Number.isFinite(sample[1]));
  const values = samples.map(([, value]) => value);
  const low = min ?? Math.min(...values);
  const high = max ?? Math.max(...values);
  const span = high > low ? high - low : 1;
  return samples.map(([at_s, value]) => [
    Number((((at_s - (t_s - WINDOW_S)) / WINDOW_S) * WIDTH).toFixed(1)),
    Number((HEIGHT - 3 - Math.min(1, Math.max(0, (value - low) / span)) * (HEIGHT - 6)).toFixed(1)),
  ]);
}
