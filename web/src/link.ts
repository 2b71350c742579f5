// The connection to the session: opens, reads, says what is wrong, and opens again.

import { ProtocolError } from "./field";
import { decodeMessage, type Ask, type Message } from "./message";
import { decodeMapValues, decodePicture, isMap, type MapValues, type Picture } from "./picture";
import type { Session } from "./session";

export type LinkState = "connecting" | "connected" | "lost";

/** Where a session speaks with its page: beside the place that the page is from. */
export function live_address(): string {
  const url = new URL("api/live", window.location.href);
  url.search = "";
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}

export interface Handlers {
  readonly message: (message: Message) => void;
  readonly picture: (picture: Picture) => void;
  readonly map: (values: MapValues) => void;
  readonly state: (state: LinkState) => void;
  /** Something arrived that the page cannot read; it is left out. */
  readonly garbage: (error: ProtocolError) => void;
}

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 5000;

export class Link {
  private socket: WebSocket | null = null;
  private wait_ms = FIRST_WAIT_MS;
  private subscribed: readonly number[] = [];
  private watched: readonly number[] = [];
  private maps: readonly number[] = [];

  constructor(
    private readonly url: string,
    private readonly session: Session,
    private readonly handlers: Handlers,
  ) {
    this.open();
  }

  /** Says something to the session; false while there is no connection. */
  ask(ask: Ask): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(ask));
    return true;
  }

  /** Asks for these signals from now on, and again after a loss. */
  subscribe(signals: readonly number[]): void {
    this.subscribed = signals;
    this.ask({ type: "subscribe", signals });
  }

  /** Asks for these variables of the PLC from now on, and again after a loss. */
  watch(variables: readonly number[]): void {
    if (variables.length === 0 && this.watched.length === 0) return;
    this.watched = variables;
    this.ask({ type: "watch", variables });
  }

  /** Asks for these maps from now on, and again after a loss. */
  map(maps: readonly number[]): void {
    // A session shows all of a map again to whoever asks.
    if (String(maps) === String(this.maps)) return;
    this.maps = maps;
    this.ask({ type: "maps", maps });
  }

  private open(): void {
    this.handlers.state("connecting");
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.wait_ms = FIRST_WAIT_MS;
      this.handlers.state("connected");
      this.subscribe(this.subscribed);
      this.watch(this.watched);
      if (this.maps.length > 0) this.ask({ type: "maps", maps: this.maps });
    });
    socket.addEventListener("message", (event: MessageEvent<unknown>) => this.read(event.data));
    socket.addEventListener("close", () => {
      this.handlers.state("lost");
      window.setTimeout(() => this.open(), this.wait_ms);
      this.wait_ms = Math.min(LONGEST_WAIT_MS, this.wait_ms * 2);
    });
  }

  private read(data: unknown): void {
    try {
      if (typeof data === "string") this.handlers.message(decodeMessage(data));
      else if (data instanceof ArrayBuffer && isMap(data)) this.handlers.map(decodeMapValues(data, this.session.maps.length));
      else if (data instanceof ArrayBuffer) {
        this.handlers.picture(decodePicture(data, this.session.signals.length, this.session.bodies.length));
      } else throw new ProtocolError("message", "is neither text nor bytes");
    } catch (error) {
      if (!(error instanceof ProtocolError)) throw error;
      this.handlers.garbage(error);
    }
  }
}
