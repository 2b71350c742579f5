// A lane of trends: curves of one quantity over virtual time.

import uPlot from "uplot";

/** Colours of the curves, distinguished also by those who do not see red and green (Okabe and Ito 2008). */
const CURVES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"] as const;

/** The colour of a curve. */
export function curve(number: number): string {
  return CURVES[number % CURVES.length] ?? CURVES[0];
}

const FONT = "11px system-ui";
/** The room for the marks of the axis of values, and between them and the curve. */
const AXIS_PX = 56;
const GAP_PX = 3;

let canvas: CanvasRenderingContext2D | null = null;

/** How wide a mark of an axis is. */
function measured(text: string): number {
  canvas ??= document.createElement("canvas").getContext("2d");
  if (canvas === null) return 0;
  canvas.font = FONT;
  return canvas.measureText(text).width;
}

/** A text that is no wider than its room: the end of one that is too wide is left out, and shown to be. */
export function fitted(text: string, room_px: number, width: (text: string) => number): string {
  if (width(text) <= room_px) return text;
  for (let length = text.length - 1; length > 0; length -= 1) {
    const part = `${text.slice(0, length)}…`;
    if (width(part) <= room_px) return part;
  }
  return "…";
}

/** A property of the page's style. */
export function style(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export interface Lane {
  readonly isBool: boolean;
  /** A value holds until the next one. */
  readonly holds: boolean;
  readonly isFilled: boolean;
  /** A colour a curve. */
  readonly strokes: readonly string[];
  /** Lanes of a group have one cursor. */
  readonly group: string;
  readonly hooks: uPlot.Hooks.Arrays;
  readonly height_px: number;
  /** Without times below it, for a lane above others. */
  readonly isBare?: boolean;
  /** How values are written at the axis; numbers if absent. */
  readonly values?: (value: number) => string;
  /** The room of the axis of values, the same in all lanes above each other. */
  readonly axis_px?: number;
}

/** The room of an axis on which these texts stand whole, but no more than `most_px`. */
export function axis_room(texts: readonly string[], most_px: number): number {
  const widest_px = texts.reduce((widest, text) => Math.max(widest, measured(text)), 0);
  return Math.max(AXIS_PX, Math.min(Math.ceil(widest_px) + GAP_PX + 4, most_px));
}

export function lane_options(lane: Lane): uPlot.Options {
  const axis: uPlot.Axis = { stroke: () => style("--text-2"), grid: { stroke: () => style("--line"), width: 1 }, ticks: { show: false }, gap: GAP_PX, font: FONT };
  const stepped = uPlot.paths.stepped?.({ align: 1 });
  const write = lane.values;
  const axis_px = lane.axis_px ?? AXIS_PX;
  const series = lane.strokes.map<uPlot.Series>((stroke) => ({
    stroke, width: 1.5, points: { show: false }, ...(lane.isFilled ? { fill: `${stroke}38` } : {}), ...(lane.holds && stepped ? { paths: stepped } : {}),
  }));
  return {
    width: 300,
    height: lane.height_px,
    // The marks of an axis at its ends reach beyond the curve's room.
    padding: [6, 18, lane.isBare === true ? 6 : 0, 0],
    legend: { show: false },
    cursor: { sync: { key: lane.group }, drag: { x: true, y: false, setScale: false }, y: false },
    scales: { x: { time: false }, y: lane.isBool ? { range: [-0.1, 1.1] } : {} },
    axes: [
      { ...axis, space: 60, ...(lane.isBare === true ? { size: 2, values: (_, all) => all.map(() => "") } : { size: 22 }) },
      { ...axis, size: axis_px, space: 22, ...(lane.isBool ? { splits: [0, 1] } : {}), ...(write === undefined ? {} : { values: (_, all) => all.map((value) => fitted(write(value), axis_px - GAP_PX - 2, measured)) }) },
    ],
    series: [{}, ...series],
    hooks: lane.hooks,
  };
}

/** A line from bottom to top at a time. */
export function upright(plot: uPlot, t_s: number, stroke: string, dash: number[], width = 1): void {
  const { ctx, bbox } = plot;
  const x = plot.valToPos(t_s, "x", true);
  if (x < bbox.left || x > bbox.left + bbox.width) return;
  ctx.save();
  ctx.strokeStyle = stroke;
  ctx.lineWidth = width * devicePixelRatio;
  ctx.setLineDash(dash);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}
