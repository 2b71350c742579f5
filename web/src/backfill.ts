// What trends show of the time before the page was opened: asked of the past that the session keeps, by a viewer of its own,
// so that what this page shows stays as it is. The session runs it again beside itself, and gives of each part of the time the
// least and the greatest values, so that a pulse of a single step is there.

import { ProtocolError } from "./field";
import { decodeMessage, type Ask } from "./message";
import type { Session } from "./session";

/** The past is asked for in so many spans, each with so many parts. */
const SPANS = 12;
const PARTS = 40;
/** The session runs at most so many steps again. */
const STEPS_MOST = 6_000;
/** The machine is to be seen first, ms. */
const LATER_MS = 400;

/** The spans that are asked for, in rising order, ns: whole steps, evenly from the beginning of what is wanted. */
export function spans(past_ns: readonly [number, number], step_ns: number): readonly (readonly [number, number])[] {
  const last = Math.floor(past_ns[1] / step_ns);
  const first = Math.max(Math.ceil(past_ns[0] / step_ns), last - STEPS_MOST);
  const stride = Math.max(1, Math.ceil((last - first) / SPANS));
  const all: (readonly [number, number])[] = [];
  for (let from = first; from < last; from += stride) all.push([from * step_ns, Math.min(last, from + stride) * step_ns]);
  return all;
}

export class Backfill {
  private wanted = new Set<number>();
  private readonly asked = new Set<number>();
  private timer: number | null = null;
  private socket: WebSocket | null = null;

  constructor(
    private readonly url: string,
    private readonly session: Session,
    private readonly put: (signal: number, t_ns: number, value: number) => void,
  ) {}

  /** Fills these signals, each once. */
  want(signals: readonly number[]): void {
    // In a lesson, the past is the trainer's.
    if (this.session.training !== null) return;
    for (const signal of signals) if (!this.asked.has(signal)) this.wanted.add(signal);
    if (this.wanted.size > 0 && this.timer === null && this.socket === null) this.timer = window.setTimeout(() => this.begin(), LATER_MS);
  }

  private begin(): void {
    this.timer = null;
    const signals = [...this.wanted].sort((a, b) => a - b);
    this.wanted.clear();
    for (const signal of signals) this.asked.add(signal);
    const socket = new WebSocket(this.url);
    this.socket = socket;
    const say = (ask: Ask): void => socket.send(JSON.stringify(ask));
    let way: readonly (readonly [number, number])[] | null = null;
    let next = 0;
    const on = (): void => {
      const span = way?.[next];
      if (span === undefined) return socket.close();
      next += 1;
      say({ type: "trace", signals, from_ns: span[0], until_ns: span[1], parts: PARTS });
    };
    const read = (data: unknown): void => {
      // Pictures of the live edge are the page's own.
      if (typeof data !== "string") return;
      const message = decodeMessage(data);
      // Where no past is kept, there is nothing to fill.
      if (message.type === "error") return socket.close();
      if (message.type === "status" && way === null) {
        if (message.past_ns === null) return socket.close();
        way = spans(message.past_ns, this.session.step_ns);
        return on();
      }
      if (message.type !== "trace") return;
      message.values.forEach((points, at) => {
        const signal = signals[at];
        if (signal !== undefined) for (const [t_ns, value] of points) this.put(signal, t_ns, value);
      });
      on();
    };
    socket.addEventListener("message", (event: MessageEvent<unknown>) => {
      try {
        read(event.data);
      } catch (error) {
        // The page's own connection reports what cannot be read.
        if (!(error instanceof ProtocolError)) throw error;
        socket.close();
      }
    });
    socket.addEventListener("close", () => {
      this.socket = null;
      this.want([]);
    });
  }
}
