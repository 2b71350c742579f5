// How finely the machine is drawn: where there is no graphics card, no shadows and edges, then fewer pixels,
// keep what moves smooth.

/** Pictures that come further apart than this are too few, ms: fewer than 30 a second. */
const SLOW_MS = 33.3;
/** Pictures that come this close have time to spare, ms. */
const FAST_MS = 22;
/** So many pictures are looked at before anything is changed, or as many as come in this time, ms. */
const PICTURES = 12;
const LONG_MS = 1200;
const LEAST_PICTURES = 3;
/** A page that was hidden for longer has drawn nothing, ms. */
const REST_MS = 2500;
/** The share of pixels, and whether shadows and edges are left out. */
const STEPS = [{ share: 1, isPlain: false }, { share: 1, isPlain: true }, { share: 0.75, isPlain: true }, { share: 0.55, isPlain: true }] as const;

export class Sharpness {
  private step = 0;
  private last_ms: number | null = null;
  private spans_ms: number[] = [];
  /** How often it was too sharp: what has failed twice is not tried again. */
  private failed = 0;

  /** Many bodies are drawn plainly from the beginning, and so is all without a graphics card. */
  constructor(beginsPlain = false) {
    if (beginsPlain) this.step = 1;
  }

  /** The share of the screen's pixels along a side that are drawn. */
  get share(): number {
    return STEPS[this.step]?.share ?? 1;
  }

  /** Without shadows and edges. */
  get isPlain(): boolean {
    return STEPS[this.step]?.isPlain ?? true;
  }

  /** Nothing has moved for a while: the next picture has not taken that long. */
  rest(): void {
    this.last_ms = null;
  }

  /** Takes the time of a picture of something that moves; true if it is drawn more or less finely from now on. */
  drawn(now_ms: number): boolean {
    const span_ms = this.last_ms === null ? null : now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (span_ms === null || span_ms > REST_MS) return false;
    this.spans_ms.push(span_ms);
    const isLong = this.spans_ms.length >= LEAST_PICTURES && this.spans_ms.reduce((all, one) => all + one, 0) > LONG_MS;
    if (this.spans_ms.length < PICTURES && !isLong) return false;
    const middle_ms = this.spans_ms.sort((a, b) => a - b)[this.spans_ms.length >> 1] ?? SLOW_MS;
    this.spans_ms = [];
    if (middle_ms > SLOW_MS && this.step < STEPS.length - 1) {
      this.step += 1;
      this.failed += 1;
      return true;
    }
    if (middle_ms < FAST_MS && this.step > 0 && this.failed < 2) {
      this.step -= 1;
      return true;
    }
    return false;
  }
}
