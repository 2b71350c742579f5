// How sharp the machine is drawn: where there is no graphics card, fewer pixels keep what moves smooth.

/** Pictures that come further apart than this are too few, ms: fewer than 22 a second. */
const SLOW_MS = 45;
/** Pictures that come this close have time to spare, ms. */
const FAST_MS = 22;
/** So many pictures are looked at before anything is changed. */
const PICTURES = 12;
/** A longer rest is not a slow picture, ms. */
const REST_MS = 400;
const STEPS = [1, 0.75, 0.55] as const;

export class Sharpness {
  private step = 0;
  private last_ms: number | null = null;
  private spans_ms: number[] = [];
  /** How often it was too sharp: what has failed twice is not tried again. */
  private failed = 0;

  /** The share of the screen's pixels along a side that are drawn. */
  get share(): number {
    return STEPS[this.step] ?? 1;
  }

  /** Takes the time of a picture of something that moves; true if the share is another one from now on. */
  drawn(now_ms: number): boolean {
    const span_ms = this.last_ms === null ? null : now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (span_ms === null || span_ms > REST_MS) return false;
    this.spans_ms.push(span_ms);
    if (this.spans_ms.length < PICTURES) return false;
    const middle_ms = this.spans_ms.sort((a, b) => a - b)[PICTURES / 2] ?? SLOW_MS;
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
