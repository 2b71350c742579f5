// The maps of a session: tables of values as colours, as they are now or at the moment of the past that is shown.

import { local } from "./format";
import { say } from "./say";
import { make } from "./dom";
import { count, ends, extremes, greatest_in, level, middle, named, strips, ticks, type Axis, type Cell, type Cells, type Table } from "./map";
import type { MapValues } from "./picture";
import type { MapInfo, Session } from "./session";

/** Of the drawing itself, in pixels of its own: the page scales it. */
const [WIDTH_PX, HEIGHT_PX] = [640, 320];

/** The values of a map, and where they are. */
class MapView {
  readonly root: HTMLElement;
  private readonly canvas = make("canvas", { width: String(WIDTH_PX), height: String(HEIGHT_PX), tabindex: "0", role: "img" });
  private readonly down = make("div", { class: "down" });
  private readonly across = make("div", { class: "across" });
  private readonly scale = make("div", { class: "scale" });
  private readonly about = make("p", { class: "about" }, say("Nothing of it is to be seen yet."));
  private readonly readout = make("p", { class: "readout", role: "status" });
  private readonly colours: readonly (readonly [number, number, number])[];
  private cells: Cells | null = null;
  private table: Table | null = null;
  /** The cell whose value is shown. */
  private cursor: readonly [number, number] | null = null;

  constructor(private readonly info: MapInfo) {
    this.colours = info.colours.map((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)) as [number, number, number]);
    this.canvas.setAttribute("aria-label", say("{title}: nothing yet", { title: info.title }));
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => this.describe(null));
    this.canvas.addEventListener("keydown", (event) => this.walk(event));
    const bar = make("div", { class: "bar", style: `background: linear-gradient(to top, ${info.colours.join(", ")})` });
    this.root = make("figure", { class: "map" }, make("figcaption", {}, make("h2", {}, info.title)),
      make("div", { class: "drawing" }, this.down, this.canvas, make("div", { class: "key" }, bar, this.scale), this.across), this.about, this.readout);
  }

  /** Where the cells lie from now on. */
  lay(cells: Cells): void {
    this.cells = cells;
    this.mark(this.down, cells.down, "top");
    this.mark(this.across, cells.across, "left");
  }

  /** Takes the values of all cells. */
  show(values: MapValues): void {
    const { cells } = this;
    if (cells === null || values.columns !== count(cells.across) || values.rows !== count(cells.down)) return;
    const table = { ...cells, values: values.values };
    this.table = table;
    const found = extremes(table);
    this.draw(table, this.range(found));
    const [least, greatest] = found ?? [null, null];
    const text = least === null || greatest === null ? say("It has no values.")
      : say("From {least} to {greatest}, which is at {place}.", { least: this.number(least.value), greatest: this.number(greatest.value), place: this.place(greatest) });
    this.about.textContent = text;
    this.canvas.setAttribute("aria-label", `${this.info.title}: ${text}`);
    this.describe(this.cursor);
  }

  /** What a test reads. */
  read(): { columns: number; rows: number; greatest: Cell | null; values: readonly number[] } | null {
    if (this.table === null) return null;
    const { across, down, values } = this.table;
    return { columns: count(across), rows: count(down), greatest: extremes(this.table)?.[1] ?? null, values: [...values] };
  }

  /** The colour of a pixel of the drawing, for a test. */
  pixel(x: number, y: number): readonly number[] {
    return [...(this.canvas.getContext("2d")?.getImageData(x, y, 1, 1).data ?? [])];
  }

  private range(found: readonly [Cell, Cell] | null): readonly [number, number] {
    return this.info.scale ?? [found?.[0].value ?? 0, found?.[1].value ?? 1];
  }

  private draw(table: Table, range: readonly [number, number]): void {
    const context = this.canvas.getContext("2d");
    if (context === null) return;
    const image = context.createImageData(WIDTH_PX, HEIGHT_PX);
    const pixels = new Uint32Array(image.data.buffer);
    const [columns, rows] = [strips(table.across, WIDTH_PX), strips(table.down, HEIGHT_PX)];
    const words = this.colours.map(([red, green, blue]) => (0xff000000 | (blue << 16) | (green << 8) | red) >>> 0);
    for (const row of rows) {
      const line = row.from_px * WIDTH_PX;
      for (const column of columns) {
        const value = greatest_in(table, column, row);
        // What has no value is left open: the ground is seen.
        const word = value === null ? 0 : words[level(value, range, words.length)] ?? 0;
        pixels.fill(word, line + column.from_px, line + column.to_px);
      }
      for (let y = row.from_px + 1; y < row.to_px; y += 1) pixels.copyWithin(y * WIDTH_PX, line, line + WIDTH_PX);
    }
    context.putImageData(image, 0, 0);
    const marks = ticks(range, 5);
    const part = (value: number): number => 1 - (value - range[0]) / (range[1] > range[0] ? range[1] - range[0] : 1);
    this.scale.replaceChildren(...marks.map((value) => make("span", { style: `top: ${part(value) * 100}%` }, this.number(value))));
  }

  private mark(where: HTMLElement, axis: Axis, side: "left" | "top"): void {
    const [low, high] = ends(axis);
    const spans = ticks([low, high], 5).map((value) => make("span", { style: `${side}: ${((value - low) / (high - low)) * 100}%` }, String(value)));
    where.replaceChildren(make("b", {}, axis.name), ...spans);
  }

  private number(value: number): string {
    const text = local(String(Number(value.toPrecision(4))));
    return this.info.unit === "" ? text : `${text} ${this.info.unit}`;
  }

  private place({ column, row }: Pick<Cell, "column" | "row">): string {
    const at = (axis: Axis, cell: number): string => named(axis, Number(middle(axis, cell).toPrecision(4)));
    return this.table === null ? "" : `${at(this.table.across, column)}, ${at(this.table.down, row)}`;
  }

  private point(event: PointerEvent): void {
    if (this.table === null) return;
    const frame = this.canvas.getBoundingClientRect();
    const cell = (axis: Axis, share: number): number => {
      const [low, high] = ends(axis);
      const value = low + share * (high - low);
      const found = axis.edges.findIndex((edge, index) => index > 0 && value < edge) - 1;
      return found < 0 ? count(axis) - 1 : found;
    };
    const share = (at: number, from: number, length: number): number => Math.min(1, Math.max(0, (at - from) / length));
    this.describe([cell(this.table.across, share(event.clientX, frame.left, frame.width)), cell(this.table.down, share(event.clientY, frame.top, frame.height))]);
  }

  private walk(event: KeyboardEvent): void {
    if (this.table === null) return;
    const ways: Readonly<Record<string, readonly [number, number]>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const way = ways[event.key];
    if (way === undefined) return;
    event.preventDefault();
    const hottest = extremes(this.table)?.[1];
    const [column, row] = this.cursor ?? [hottest?.column ?? 0, hottest?.row ?? 0];
    const step = event.shiftKey ? 10 : 1;
    const within = (at: number, axis: Axis): number => Math.min(count(axis) - 1, Math.max(0, at));
    this.describe(this.cursor === null ? [column, row] : [within(column + way[0] * step, this.table.across), within(row + way[1] * step, this.table.down)]);
  }

  private describe(cursor: readonly [number, number] | null): void {
    this.cursor = cursor;
    const value = cursor === null || this.table === null ? undefined : this.table.values[cursor[1] * count(this.table.across) + cursor[0]];
    if (cursor === null || value === undefined) this.readout.textContent = "";
    else this.readout.textContent = `${this.place({ column: cursor[0], row: cursor[1] })}: ${Number.isFinite(value) ? this.number(value) : say("no value")}`;
  }
}

/** All maps of a session. */
export class Maps {
  readonly root: HTMLElement;
  private readonly views: readonly MapView[];

  constructor(private readonly session: Session) {
    this.views = session.maps.map((one) => new MapView(one));
    this.root = make("div", { class: "maps" }, ...this.views.map((one) => one.root));
  }

  /** The numbers of the maps that the session is asked for. */
  wanted(): readonly number[] {
    return this.views.map((_, map) => map);
  }

  lay(map: number, cells: Cells): void {
    this.views[map]?.lay(cells);
  }

  show(values: MapValues): void {
    this.views[values.map]?.show(values);
  }

  /** What a test reads of a map. */
  read(name: string): ReturnType<MapView["read"]> {
    return this.views[this.session.maps.findIndex((one) => one.name === name)]?.read() ?? null;
  }

  pixel(name: string, x: number, y: number): readonly number[] {
    return this.views[this.session.maps.findIndex((one) => one.name === name)]?.pixel(x, y) ?? [];
  }
}
