// What flows in a drawing: the values of pins, from those of the variables, for the eye only.

import type { Drawing, DrawingElement } from "./session";

/** A value on a wire; nothing where it is not known. */
export type Flow = number | null;

const FUNCTIONS: Readonly<Record<string, (values: readonly number[]) => number>> = {
  AND: (values) => Number(values.every((one) => one !== 0)),
  OR: (values) => Number(values.some((one) => one !== 0)),
  XOR: (values) => Number(values.filter((one) => one !== 0).length % 2 === 1),
  NOT: ([one = 0]) => Number(one === 0),
  GT: (values) => pairs(values, (a, b) => a > b),
  GE: (values) => pairs(values, (a, b) => a >= b),
  EQ: (values) => pairs(values, (a, b) => a === b),
  LE: (values) => pairs(values, (a, b) => a <= b),
  LT: (values) => pairs(values, (a, b) => a < b),
  NE: ([a = 0, b = 0]) => Number(a !== b),
  ADD: (values) => values.reduce((sum, one) => sum + one, 0),
  SUB: ([a = 0, b = 0]) => a - b,
  MUL: (values) => values.reduce((product, one) => product * one, 1),
  MAX: (values) => Math.max(...values),
  MIN: (values) => Math.min(...values),
};

function pairs(values: readonly number[], holds: (a: number, b: number) => boolean): number {
  return Number(values.every((one, index) => index === 0 || holds(values[index - 1] ?? Number.NaN, one)));
}

export class FlowOf {
  private readonly known = new Map<string, Flow>();
  private readonly open = new Set<string>();

  constructor(
    private readonly drawing: Drawing,
    private readonly value: (path: string) => Flow,
  ) {}

  /** The value that comes out of a pin. */
  out(element: number, pin: number): Flow {
    const key = `${element} ${pin}`;
    const known = this.known.get(key);
    if (known !== undefined) return known;
    // A loop has the value of the scan before, which nobody knows here.
    if (this.open.has(key)) return null;
    this.open.add(key);
    const found = this.marked(this.given(element, pin), this.drawing.elements[element]?.pins[pin]?.marks ?? []);
    this.open.delete(key);
    this.known.set(key, found);
    return found;
  }

  /** The value that goes into a pin: of several wires, whether one of them carries power. */
  into(element: number, pin: number): Flow {
    const wires = this.drawing.wires.filter((wire) => wire.to[0] === element && wire.to[1] === pin);
    const values = wires.map((wire) => this.out(...wire.from));
    const marks = this.drawing.elements[element]?.pins[pin]?.marks ?? [];
    if (values.length === 1) return this.marked(values[0] ?? null, marks);
    if (values.some((one) => one !== null && one !== 0)) return this.marked(1, marks);
    return values.length === 0 || values.some((one) => one === null) ? null : this.marked(0, marks);
  }

  /** The value of what stands on an element. */
  of(element: DrawingElement): Flow {
    if (element.state !== null) return this.value(element.state);
    const word = element.text.trim().toUpperCase();
    if (word === "TRUE" || word === "FALSE") return Number(word === "TRUE");
    return /^-?\d+(\.\d+)?$/.test(word) ? Number(word) : null;
  }

  private marked(value: Flow, marks: readonly string[]): Flow {
    return value !== null && marks.includes("negated") ? Number(value === 0) : value;
  }

  private given(index: number, pin: number): Flow {
    const element = this.drawing.elements[index];
    if (element === undefined) return null;
    switch (element.kind) {
      case "leftPowerRail":
        return 1;
      case "contact": {
        const [power, state] = [this.inlet(index), this.marked(this.of(element), element.marks)];
        if (power === 0 || state === 0) return 0;
        return power === null || state === null ? null : 1;
      }
      case "inVariable":
        return this.marked(this.of(element), element.marks);
      case "inOutVariable":
      case "step":
        return this.of(element);
      case "continuation": {
        const from = this.drawing.elements.findIndex((one) => one.kind === "connector" && one.text === element.text);
        return from < 0 ? null : this.inlet(from);
      }
      case "block":
        return this.block(element, index, pin);
      case "transition":
        return this.transition(element, index);
      default:
        return this.inlet(index);
    }
  }

  /** The value that goes into the first input of an element. */
  private inlet(index: number): Flow {
    const element = this.drawing.elements[index];
    const inputs = element?.pins.flatMap((pin, at) => (pin.output || pin.name === "condition" ? [] : [at])) ?? [];
    const values = inputs.map((at) => this.into(index, at));
    if (values.some((one) => one !== null && one !== 0)) return 1;
    return values.length === 0 || values.some((one) => one === null) ? null : 0;
  }

  private transition(element: DrawingElement, index: number): Flow {
    const at = element.pins.findIndex((pin) => pin.name === "condition");
    const condition = at < 0 ? this.of(element) : this.into(index, at);
    const active = this.inlet(index);
    if (active === 0 || condition === 0) return 0;
    return active === null || condition === null ? null : 1;
  }

  private block(element: DrawingElement, index: number, pin: number): Flow {
    const own = element.pins[pin];
    if (own?.state !== null && own?.state !== undefined) return this.value(own.state);
    const inputs = element.pins.flatMap((one, at) => (one.output ? [] : [{ name: one.name.toUpperCase(), at }]));
    const enable = inputs.find((one) => one.name === "EN");
    const enabled = enable === undefined ? 1 : this.into(index, enable.at);
    if (own?.name.toUpperCase() === "ENO") return enabled;
    const work = FUNCTIONS[element.text.toUpperCase()];
    const values = inputs.filter((one) => one.name !== "EN").map((one) => this.into(index, one.at));
    if (work === undefined || enabled !== 1 || values.some((one) => one === null)) return null;
    return work(values.map((one) => one ?? 0));
  }
}
