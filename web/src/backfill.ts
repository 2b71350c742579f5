// What trends show of the time before the page was opened: asked of the past that the session keeps, by a viewer of its own,
// so that what this page shows stays as it is. The session runs it again beside itself.

import { ProtocolError } from "./field";
import { decodeMessage, type Ask } from "./message";
import { decodePicture } from "./picture";
import type { Session } from "./session";

/** So many moments of the past are asked for. */
const MOMENTS = 240;
/** The session runs at most so many steps again. */
const STEPS_MOST = 6_000;
/** The machine is to be seen first, ms. */
const LATER_MS = 400;

/** The moments that are asked for, in rising order, ns: whole steps, evenly from the beginning of what is wanted. */
export function moments(past_ns: readonly [number, number], step_ns: number): readonly number[] {
  const last = Math.floor(past_ns[1] / step_ns);
  const first = Math.max(Math.ceil(past_ns[0] / step_ns), last - STEPS_MOST);
  const stride = Math.max(1, Math.ceil((last - first) / MOMENTS));
  const count = Math.floor((last - first) / stride) + 1;
  return Array.from({ length: Math.max(0, count) }, (_, at) => (first + at * stride) * step_ns);
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
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    const say = (ask: Ask): void => socket.send(JSON.stringify(ask));
    let way: readonly number[] | null = null;
    let next = 0;
    const on = (): void => {
      const t_ns = way?.[next];
      if (t_ns === undefined) return socket.close();
      next += 1;
      say({ type: "show", t_ns });
    };
    const read = (data: unknown): void => {
      if (typeof data === "string") {
        const message = decodeMessage(data);
        // Where no past is kept, there is nothing to fill.
        if (message.type === "error") return socket.close();
        if (message.type !== "status" || way !== null) return;
        if (message.past_ns === null) return socket.close();
        way = moments(message.past_ns, this.session.step_ns);
        return on();
      }
      if (!(data instanceof ArrayBuffer)) return;
      const picture = decodePicture(data, this.session.signals.length, this.session.bodies.length);
      const asked_ns = way?.[next - 1];
      if (!picture.isPast || asked_ns === undefined) return;
      for (const [signal, value] of picture.values) this.put(signal, picture.t_ns, value);
      if (picture.t_ns >= asked_ns) on();
    };
    socket.addEventListener("open", () => say({ type: "subscribe", signals }));
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
