// Ladders, function blocks and charts as they are laid out, with the power that flows and the steps that are active.

import { draw } from "./dom";
import { local } from "./format";
import { say } from "./say";
import { FlowOf, type Flow } from "./flow";
import type { Drawing, DrawingElement, DrawingWire } from "./session";

const MARGIN = 30;
/** How far a wire goes straight on before it turns. */
const STUB = 14;

type Point = readonly [number, number];

/** The corners of a wire: those of the file, or a way with right angles. */
export function corners(wire: DrawingWire, isChart: boolean, left: number): readonly Point[] {
  const [from, to] = [wire.points[0], wire.points[wire.points.length - 1]];
  if (from === undefined || to === undefined || wire.points.length > 2) return wire.points;
  const [[x1, y1], [x2, y2]] = [from, to];
  if (isChart) {
    if (y2 < y1) return [from, [x1, y1 + STUB], [left - STUB, y1 + STUB], [left - STUB, y2 - STUB], [x2, y2 - STUB], to];
    return Math.abs(x2 - x1) < 1 ? [from, to] : [from, [x1, (y1 + y2) / 2], [x2, (y1 + y2) / 2], to];
  }
  return Math.abs(y2 - y1) < 1 ? [from, to] : [from, [(x1 + x2) / 2, y1], [(x1 + x2) / 2, y2], to];
}

/** A value as it stands beside what has it. */
export function reading(value: Flow): string {
  if (value === null || !Number.isFinite(value)) return "";
  return Number.isInteger(value) ? String(value) : local(String(Number(value.toPrecision(5))));
}

export class DrawingView {
  readonly root: SVGSVGElement;
  private readonly wires: SVGPolylineElement[] = [];
  private readonly elements: SVGGElement[] = [];
  private readonly readings: (SVGTextElement | null)[] = [];

  constructor(private readonly drawing: Drawing) {
    const box = this.box();
    const isChart = drawing.language === "chart";
    const name = drawing.part === null ? drawing.unit : `${drawing.unit}.${drawing.part}`;
    this.root = draw("svg", {
      class: `drawing ${drawing.language}`, viewBox: box.join(" "), width: box[2], height: box[3], role: "img",
      "aria-label": `${name}, ${drawing.language}`,
    });
    for (const wire of drawing.wires) {
      const points = corners(wire, isChart, box[0] + MARGIN / 2).map((point) => point.join(",")).join(" ");
      const [from, to] = [drawing.elements[wire.from[0]], drawing.elements[wire.to[0]]];
      const line = draw("polyline", { class: "wire", points, "data-from": from?.id ?? "", "data-to": to?.id ?? "" });
      line.append(draw("title", {}, say("line {line}", { line: wire.line })));
      this.wires.push(line);
      this.root.append(line);
    }
    for (const element of drawing.elements) this.root.append(this.element(element));
  }

  /** Lights what has power or is active. */
  show(value: (path: string) => Flow): void {
    const flow = new FlowOf(this.drawing, value);
    this.drawing.wires.forEach((wire, index) => {
      const here = flow.out(...wire.from);
      this.wires[index]?.classList.toggle("lit", here !== null && here !== 0);
    });
    this.drawing.elements.forEach((element, index) => {
      const own = flow.of(element);
      const isOn = own !== null && own !== 0;
      const conducts = element.kind === "contact" && element.marks.includes("negated") ? own === 0 : isOn;
      this.elements[index]?.classList.toggle(element.kind === "step" ? "active" : "lit", conducts);
      const text = this.readings[index];
      if (text) text.textContent = reading(own);
    });
  }

  /** The room of all elements and wires: left, top, width, height. */
  private box(): [number, number, number, number] {
    const points: Point[] = this.drawing.elements.flatMap((one): Point[] => [one.at, [one.at[0] + one.size[0], one.at[1] + one.size[1]]]);
    points.push(...this.drawing.wires.flatMap((wire) => wire.points));
    if (points.length === 0) return [0, 0, 1, 1];
    const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
    const [left, top] = [Math.min(...xs) - MARGIN, Math.min(...ys) - MARGIN];
    return [left, top, Math.max(...xs) - left + MARGIN * 2, Math.max(...ys) - top + MARGIN];
  }

  private element(element: DrawingElement): SVGGElement {
    const group = draw("g", { class: `element ${element.kind}`, "data-id": element.id });
    group.append(draw("title", {}, say("{text}\nline {line}", { text: element.instance ?? element.text, line: element.line })));
    group.append(...this.shape(element));
    const hasReading = element.state !== null && element.kind !== "step" && element.kind !== "transition";
    const below = element.kind === "contact" || element.kind === "coil";
    const text = hasReading
      ? draw("text", {
        class: "reading", x: element.at[0] + (below ? element.size[0] / 2 : element.size[0]),
        y: element.at[1] + (below ? element.size[1] + 12 : -2), "text-anchor": below ? "middle" : "end",
      })
      : null;
    if (text !== null) group.append(text);
    this.readings.push(text);
    this.elements.push(group);
    return group;
  }

  private shape(element: DrawingElement): SVGElement[] {
    const [[x, y], [width, height]] = [element.at, element.size];
    const middle = x + width / 2;
    const caption = (text: string, at: Point, anchor = "middle"): SVGElement =>
      draw("text", { x: at[0], y: at[1], "text-anchor": anchor }, text);
    const box = (kind: string): SVGElement => draw("rect", { class: kind, x, y, width, height });
    switch (element.kind) {
      case "leftPowerRail":
      case "rightPowerRail":
        return [box("rail")];
      case "contact":
        return [
          draw("rect", { class: "blade", x, y, width, height }),
          draw("path", { class: "stroke", d: `M${x} ${y}v${height}M${x + width} ${y}v${height}` }),
          ...(element.marks.includes("negated") ? [draw("path", { class: "stroke", d: `M${x + 4} ${y + height}L${x + width - 4} ${y}` })] : []),
          ...this.edge(element, [middle, y + height * 0.75]), caption(element.text, [middle, y - 5]),
        ];
      case "coil":
        return [
          draw("ellipse", { class: "blade", cx: middle, cy: y + height / 2, rx: width / 2, ry: height / 2 }),
          draw("path", { class: "stroke", d: `M${x + 6} ${y}a${width / 2} ${height / 1.6} 0 0 0 0 ${height}M${x + width - 6} ${y}a${width / 2} ${height / 1.6} 0 0 1 0 ${height}` }),
          ...this.edge(element, [middle, y + height * 0.75]), caption(element.text, [middle, y - 5]),
        ];
      case "block":
        return [box("body"), caption(element.text, [middle, y + 14]), ...this.pins(element),
          ...(element.instance === null ? [] : [caption(element.instance, [middle, y - 5])])];
      case "step":
      case "macroStep":
        return [box("body"), ...(element.marks.includes("initial") ? [draw("rect", { class: "inner", x: x + 3, y: y + 3, width: width - 6, height: height - 6 })] : []),
          caption(element.text, [middle, y + height / 2 + 4])];
      case "transition":
        return [draw("rect", { class: "bar", x, y: y + height / 2 - 2, width, height: 4 }),
          caption(shorter(element.text), [x + width + 6, y + height / 2 + 4], "start")];
      case "actionBlock":
        return [box("body"), ...element.text.split("\n").map((line, at) => caption(shorter(line), [x + 6, y + 14 + at * (height / Math.max(1, element.text.split("\n").length))], "start"))];
      case "selectionDivergence":
      case "selectionConvergence":
        return [draw("path", { class: "stroke", d: `M${x} ${y}h${width}` })];
      case "simultaneousDivergence":
      case "simultaneousConvergence":
        return [draw("path", { class: "stroke", d: `M${x} ${y - 2}h${width}M${x} ${y + 2}h${width}` })];
      case "jumpStep":
        return [draw("path", { class: "stroke", d: `M${middle} ${y}v12m-5 -6l5 6l5 -6` }), caption(element.text, [middle, y + 26])];
      default:
        return [box("body plain"), caption(element.text, [middle, y + height / 2 + 4])];
    }
  }

  private pins(element: DrawingElement): SVGElement[] {
    return element.pins.flatMap((pin) => {
      const x = pin.at[0] + (pin.output ? -4 : 4);
      const name = draw("text", { class: "pin", x, y: pin.at[1] + 4, "text-anchor": pin.output ? "end" : "start" }, pin.name);
      const negated = pin.marks.includes("negated") ? [draw("circle", { class: "stroke", cx: pin.at[0] + (pin.output ? 4 : -4), cy: pin.at[1], r: 3.5 })] : [];
      return [name, ...negated];
    });
  }

  private edge(element: DrawingElement, at: Point): SVGElement[] {
    const letters: Readonly<Record<string, string>> = { rising: "P", falling: "N", set: "S", reset: "R" };
    return element.marks.flatMap((mark) => {
      const letter = letters[mark] ?? (mark === "negated" && element.kind === "coil" ? "/" : null);
      return letter === null ? [] : [draw("text", { class: "mark", x: at[0], y: at[1], "text-anchor": "middle" }, letter)];
    });
  }
}

function shorter(text: string): string {
  const line = text.replace(/\s+/g, " ");
  return line.length > 60 ? `${line.slice(0, 58)}…` : line;
}
