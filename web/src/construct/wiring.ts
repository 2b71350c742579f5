// The wiring as a picture that can be changed: draw from an end to another, by mouse, touch or keyboard.

import { say } from "../say";
import { draw, make } from "../dom";
import type { EditState, Tip } from "./protocol";
import { columns, fits, key, rows, type Dot, type Row } from "./rows";

const [SIDE, MIDDLE, TOP, ROW, BOX] = [230, 330, 64, 30, 44];
/** More rows than this are asked to be filtered. */
const ROWS_MAX = 400;

export class WiringView {
  private readonly filter = make("input", { type: "search", class: "filter", placeholder: say("Filter signals and ends"), "aria-label": say("Filter signals and ends") });
  private readonly hint = make("p", { class: "hint", role: "status" });
  private readonly picture = make("div", { class: "picture" });
  private state: EditState | null = null;
  private readonly dots = new Map<string, Dot>();
  private chosen: string | null = null;
  private drawn: { readonly from: string; readonly line: SVGLineElement; moved: boolean } | null = null;
  private svg: SVGSVGElement | null = null;

  /** Draws into `place`; `join` and `part` ask for what a person does. */
  constructor(
    place: HTMLElement,
    private readonly join: (one: Tip, other: Tip) => void,
    private readonly part: (tip: Tip) => void,
  ) {
    place.append(make("div", { class: "wiring-head" }, this.filter, this.hint), this.picture);
    this.filter.addEventListener("input", () => this.paint());
    this.say();
  }

  show(state: EditState): void {
    this.state = state;
    this.chosen = null;
    this.paint();
  }

  private say(): void {
    const from = this.chosen === null ? null : this.dots.get(this.chosen);
    this.hint.textContent = from === undefined || from === null
      ? say("Drag an end to another, or press Enter on one and on the other. Delete lets an end go.")
      : say("{from}: choose the other end, or press Escape.", { from: named(from) });
  }

  private paint(): void {
    const state = this.state;
    if (state === null) return;
    const focused = document.activeElement?.getAttribute("data-key") ?? null;
    if (state.map === null) {
      this.picture.replaceChildren(make("p", { class: "empty" }, say("The wiring is known once what is listed below is put right.")));
      return;
    }
    const clients = columns(state);
    const all = rows(state, this.filter.value);
    const shown = all.slice(0, ROWS_MAX);
    const width = 2 * SIDE + Math.max(0, clients.length - 1) * MIDDLE;
    const height = TOP + ROW * (shown.length + 1);
    const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "group", "aria-label": say("Wiring") });
    this.svg = svg;
    this.dots.clear();
    clients.forEach((client, column) => svg.append(...head(client, column, height)));
    shown.forEach((row, index) => svg.append(this.row(row, TOP + ROW * (index + 0.75), clients.length)));
    const more = all.length > shown.length ? [make("p", { class: "empty" }, say("{length} more: filter them.", { length: all.length - shown.length }))] : [];
    this.picture.replaceChildren(svg, ...more);
    if (focused !== null) this.tip(focused)?.focus();
    this.mark();
  }

  private row(row: Row, y: number, count: number): SVGGElement {
    const group = draw("g", { class: row.isError ? "row wrong" : row.trouble === "" ? "row" : "row unread" });
    if (row.trouble !== "") group.append(draw("title", {}, row.trouble));
    const [from, ...to] = row.dots;
    if (row.signal !== null && from !== undefined) {
      const x = x_of(from.column);
      const targets = to.map((dot) => x_of(dot.column));
      for (const target of targets) group.append(draw("line", { class: "wire", x1: x, y1: y, x2: target, y2: y }), arrow(x, target, y));
      const away = from.column === count - 1 ? -1 : 1;
      const nearest = targets.length > 0 ? targets.reduce((one, other) => (Math.abs(other - x) < Math.abs(one - x) ? other : one)) : x + away * (MIDDLE - 110);
      if (targets.length === 0) {
        group.append(draw("line", { class: "wire stub", x1: x, y1: y, x2: nearest, y2: y }));
        const tip = { signal: row.signal };
        group.append(this.dot({ column: from.column, label: "", tip, type: row.type, gives: true, isOpen: true }, nearest, y, 0, say("signal {label}, read by nobody", { label: row.label })));
      }
      const text = draw("text", { class: "name", x: (x + nearest) / 2, y: y - 6, "text-anchor": "middle" }, row.label);
      group.append(text);
    }
    for (const dot of row.dots) {
      const side = dot.column === 0 ? -1 : 1;
      const what = row.signal === null ? say("connected to nothing") : (dot.gives ? say("writes {signal}", { signal: row.signal }) : say("reads {signal}", { signal: row.signal }));
      // It begins with what is written there, for those who speak to it.
      const type = dot.isOpen ? ` : ${dot.type}` : `, ${dot.type}`;
      group.append(this.dot(dot, x_of(dot.column), y, side, `${dot.label === "" ? say("an end") : written(dot.label)}${type}, ${what}`));
    }
    return group;
  }

  /** A tip that can be drawn from and to. */
  private dot(dot: Dot, x: number, y: number, side: -1 | 0 | 1, label: string): SVGGElement {
    const name = key(dot.tip);
    this.dots.set(name, dot);
    const group = draw("g", { class: dot.isOpen ? "tip open" : "tip", tabindex: 0, role: "button", "aria-label": label, "data-key": name });
    group.append(draw("circle", { class: "grip", cx: x, cy: y, r: 13 }), draw("circle", { class: "end", cx: x, cy: y, r: 5 }));
    if (side !== 0 && dot.label !== "") {
      const kind = dot.isOpen ? ` : ${dot.type}` : "";
      const text = draw("text", { class: "at", x: x + 14 * side, y: y + 4, "text-anchor": side < 0 ? "end" : "start" }, `${short(dot.label)}${kind}`);
      if (short(dot.label) !== dot.label) text.append(draw("title", {}, dot.label));
      group.append(text);
    }
    group.addEventListener("pointerdown", (event) => this.begin(event, name, x, y));
    group.addEventListener("keydown", (event) => this.typed(event, name, dot.tip));
    return group;
  }

  private begin(event: PointerEvent, from: string, x: number, y: number): void {
    if (event.button !== 0 || this.svg === null) return;
    event.preventDefault();
    const svg = this.svg;
    const line = draw("line", { class: "drawn", x1: x, y1: y, x2: x, y2: y });
    svg.append(line);
    this.drawn = { from, line, moved: false };
    if (this.chosen === null) this.chosen = from;
    this.mark();
    const move = (moved: PointerEvent): void => {
      const box = svg.getBoundingClientRect();
      line.setAttribute("x2", String(moved.clientX - box.left));
      line.setAttribute("y2", String(moved.clientY - box.top));
      if (this.drawn !== null && Math.hypot(moved.clientX - event.clientX, moved.clientY - event.clientY) > 5) this.drawn.moved = true;
      this.over(under(moved));
    };
    const end = (released: PointerEvent): void => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", end);
      window.removeEventListener("pointercancel", end);
      const was_moved = this.drawn?.moved ?? false;
      line.remove();
      this.drawn = null;
      this.over(null);
      const to = released.type === "pointerup" ? under(released) : null;
      if (was_moved) {
        this.chosen = null;
        if (to !== null && to !== from) this.ask(from, to);
      } else this.press(from);
      this.mark();
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
    this.tip(from)?.focus();
  }

  /** A click: the first chooses, the second connects. */
  private press(name: string): void {
    if (this.chosen === null || this.chosen === name) this.chosen = name;
    else {
      const from = this.chosen;
      this.chosen = null;
      this.ask(from, name);
    }
    this.mark();
  }

  private typed(event: KeyboardEvent, name: string, tip: Tip): void {
    if (event.key === "Enter" || event.key === " ") this.press(name);
    else if (event.key === "Escape") this.chosen = null;
    else if (event.key === "Delete" || event.key === "Backspace") this.part(tip);
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") this.step(name, event.key === "ArrowDown" ? 1 : -1);
    else return;
    event.preventDefault();
    this.mark();
  }

  private step(name: string, by: number): void {
    const all = [...this.dots.keys()];
    const next = all[(all.indexOf(name) + by + all.length) % all.length];
    if (next !== undefined) this.tip(next)?.focus();
  }

  private ask(from: string, to: string): void {
    const [one, other] = [this.dots.get(from), this.dots.get(to)];
    if (one !== undefined && other !== undefined) this.join(one.tip, other.tip);
  }

  private tip(name: string): SVGGElement | null {
    return this.svg?.querySelector<SVGGElement>(`[data-key="${CSS.escape(name)}"]`) ?? null;
  }

  private over(name: string | null): void {
    for (const tip of this.svg?.querySelectorAll(".tip.over") ?? []) tip.classList.remove("over");
    if (name !== null) this.tip(name)?.classList.add("over");
  }

  /** Shows what is chosen, and what it could be connected with. */
  private mark(): void {
    const from = this.chosen === null ? undefined : this.dots.get(this.chosen);
    for (const tip of this.svg?.querySelectorAll<SVGGElement>(".tip") ?? []) {
      const name = tip.getAttribute("data-key") ?? "";
      const dot = this.dots.get(name);
      tip.classList.toggle("chosen", name === this.chosen);
      tip.classList.toggle("unfit", from !== undefined && dot !== undefined && !fits(from, dot));
    }
    this.say();
  }
}

function named(dot: Dot): string {
  return "signal" in dot.tip ? dot.tip.signal : dot.tip.at;
}

function short(label: string): string {
  return label.length <= 26 ? label : `…${label.slice(-25)}`;
}

/** A label as it is heard: what is written of it, and all of it where that is not the same. */
function written(label: string): string {
  return short(label) === label ? label : `${short(label)}: ${label}`;
}

function x_of(column: number): number {
  return SIDE + column * MIDDLE;
}

function head(client: { readonly name: string; readonly kind: string }, column: number, height: number): readonly SVGElement[] {
  const x = x_of(column);
  return [
    draw("line", { class: "column", x1: x, y1: BOX + 4, x2: x, y2: height - 4 }),
    draw("rect", { class: "client", x: x - 75, y: 6, width: 150, height: BOX - 4, rx: 4 }),
    draw("text", { class: "client-name", x, y: 24, "text-anchor": "middle" }, client.name),
    draw("text", { class: "client-kind", x, y: 39, "text-anchor": "middle" }, client.kind),
  ];
}

function arrow(from: number, to: number, y: number): SVGPathElement {
  const way = to > from ? 1 : -1;
  const tip = to - 7 * way;
  return draw("path", { class: "arrow", d: `M${tip} ${y}L${tip - 8 * way} ${y - 4}v8z` });
}

/** The tip below a pointer. */
function under(event: PointerEvent): string | null {
  return document.elementFromPoint(event.clientX, event.clientY)?.closest(".tip")?.getAttribute("data-key") ?? null;
}
