// The values of a signal over virtual time, and what of them fits on a screen.

/** Values kept of one signal; the oldest half goes when it is full. */
const CAPACITY = 200_000;

export class History {
  private readonly t_s: number[] = [];
  private readonly value: number[] = [];

  constructor(private readonly capacity: number = CAPACITY) {}

  get length(): number {
    return this.t_s.length;
  }

  /** Adds a value; time that goes back (a restart, a fork) drops what was after it. */
  push(t_s: number, value: number): void {
    const last = this.t_s[this.t_s.length - 1];
    if (last !== undefined && t_s <= last) {
      const keep = this.after(t_s, false);
      this.t_s.length = keep;
      this.value.length = keep;
    }
    if (this.t_s.length >= this.capacity) {
      const half = this.capacity >> 1;
      this.t_s.splice(0, half);
      this.value.splice(0, half);
    }
    this.t_s.push(t_s);
    this.value.push(value);
  }

  /** Adds a value of an earlier moment, beside what is known: nothing is dropped. */
  insert(t_s: number, value: number): void {
    const place = this.after(t_s, false);
    if (this.t_s[place] === t_s) this.value[place] = value;
    else if (this.t_s.length < this.capacity) {
      this.t_s.splice(place, 0, t_s);
      this.value.splice(place, 0, value);
    }
  }

  /** The value that holds at `t_s`; nothing before the first. */
  at(t_s: number): number | null {
    return this.value[this.after(t_s, true) - 1] ?? null;
  }

  /** How many samples lie before `t_s`, with those at it if `inclusive`. */
  private after(t_s: number, inclusive: boolean): number {
    let low = 0;
    let high = this.t_s.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      const t = this.t_s[middle] as number;
      if (t < t_s || (inclusive && t === t_s)) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /**
   * At most 4 points a column of the part from `from_s` to `to_s`: the first, the least, the greatest and
   * the last, so that no spike and no edge is lost. The value that holds at the edges is there too.
   */
  decimated(from_s: number, to_s: number, columns: number): { t_s: number[]; value: number[] } {
    const t_s: number[] = [];
    const value: number[] = [];
    const put = (index: number): void => {
      t_s.push(this.t_s[index] as number);
      value.push(this.value[index] as number);
    };
    const start = this.after(from_s, true);
    const end = this.after(to_s, true);
    const held = this.value[start - 1];
    if (held !== undefined) {
      t_s.push(from_s);
      value.push(held);
    }
    const width = (to_s - from_s) / Math.max(1, columns);
    for (let index = start; index < end; ) {
      const column = Math.floor(((this.t_s[index] as number) - from_s) / width);
      let next = index + 1;
      while (next < end && Math.floor(((this.t_s[next] as number) - from_s) / width) === column) next += 1;
      for (const one of this.marks(index, next)) put(one);
      index = next;
    }
    const last = value[value.length - 1];
    if (last !== undefined && end > 0 && (t_s[t_s.length - 1] as number) < to_s && end < this.t_s.length) {
      t_s.push(to_s);
      value.push(last);
    }
    return { t_s, value };
  }

  /** First, least, greatest and last of the samples from `from` up to `to`, each once, in order. */
  private marks(from: number, to: number): number[] {
    let least = from;
    let greatest = from;
    for (let index = from; index < to; index += 1) {
      if ((this.value[index] as number) < (this.value[least] as number)) least = index;
      if ((this.value[index] as number) > (this.value[greatest] as number)) greatest = index;
    }
    return [...new Set([from, least, greatest, to - 1])].sort((a, b) => a - b);
  }
}
