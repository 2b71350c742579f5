// Pictures of the machine, for `onescan shot`: the page draws it alone and sends it back to the session; for a film once at each
// time at which the session waits.

import { frame } from "./dom";
import { Link } from "./link";
import type { Picture } from "./picture";
import type { Session } from "./session";
import { MachineView } from "./scene";
import { colour } from "./theme";

/** What is to be drawn. */
export interface Wanted {
  readonly width: number;
  readonly height: number;
  /** The number of the view. */
  readonly view: number | null;
  readonly theme: string | null;
  /** Of a film the time of its first picture, how far apart pictures are, and how well they are kept, 0 to 1. */
  readonly film: { readonly from_ns: number; readonly every_ns: number; readonly quality: number } | null;
}

/** Reads `?shot=1280x720&view=0&theme=dark`; nothing where no picture is asked for. */
export function wanted(query: string): Wanted | null {
  const words = new URLSearchParams(query);
  const size = /^(\d{1,4})x(\d{1,4})$/.exec(words.get("shot") ?? "");
  if (size === null) return null;
  const view = words.get("view");
  const times = /^(\d+),(\d+)$/.exec(words.get("film") ?? "");
  const film = times === null ? null : { from_ns: Number(times[1]), every_ns: Number(times[2]), quality: Number(words.get("quality") ?? "60") / 100 };
  return { width: Number(size[1]), height: Number(size[2]), view: view === null ? null : Number(view), theme: words.get("theme"), film };
}

/** Draws the session's machine as soon as all of it has arrived, and sends the picture. */
export function shoot(session: Session, url: string, wanted: Wanted): void {
  document.documentElement.dataset.theme = wanted.theme ?? "light";
  document.body.classList.add("shot");
  frame("machine").style.width = `${wanted.width}px`;
  frame("machine").style.height = `${wanted.height}px`;
  const machine = new MachineView(frame("canvas"), session, () => {}, true);
  const sensors = session.components.flatMap((one) => {
    const signal = session.signals.findIndex((candidate) => candidate.name === one.senses);
    const body = session.bodies.findIndex((candidate) => candidate.name === one.body);
    return signal < 0 || body < 0 ? [] : [{ signal, body }];
  });
  const signals = [...new Set([...machine.signals(), ...sensors.map((one) => one.signal)])].sort((a, b) => a - b);
  const values = new Map<number, number>();
  let areLooksKnown = session.looks.every((look) => look.when === null);
  let last: Picture | null = null;
  /** The time of the next picture; nothing once all are sent, or one is on its way. */
  let due_ns: number | null = wanted.film?.from_ns ?? 0;
  /** The time for which everything was asked for once more: what comes with it belongs to it. */
  let whole_ns: number | null = null;
  let isSeen = false;
  const see = (): void => {
    const view = wanted.view === null ? undefined : session.views[wanted.view];
    if (view === undefined) machine.home();
    else machine.see(view);
    machine.theme(colour("--ground"), colour("--line"));
    isSeen = true;
  };
  const draw = async (): Promise<void> => {
    if (due_ns === null || last === null || !areLooksKnown || last.t_ns < due_ns || signals.some((signal) => !values.has(signal))) return;
    if (wanted.film !== null && whole_ns !== last.t_ns) return;
    const now_ns = due_ns;
    due_ns = null;
    machine.light_up(new Set(sensors.filter((one) => values.get(one.signal) !== 0).map((one) => one.body)));
    // A film is seen from where its first picture is.
    if (!isSeen) see();
    const type = wanted.film === null ? "image/png" : "image/webp";
    const next_ns = wanted.film === null ? null : now_ns + wanted.film.every_ns;
    await send(await machine.picture(wanted.width, wanted.height, type, wanted.film?.quality), type);
    due_ns = next_ns;
    // The next one may have come while this one was on its way.
    if (next_ns !== null && last.t_ns >= next_ns) link.subscribe(signals);
  };
  const link = new Link(url, session, {
    message: (message) => {
      if (message.type === "looks") {
        machine.look(message.active);
        areLooksKnown = true;
      }
      void draw().catch(fail);
    },
    map: () => {},
    picture: (picture) => {
      const isAgain = last !== null && last.t_ns === picture.t_ns;
      last = picture;
      for (const [signal, value] of picture.values) {
        values.set(signal, value);
        machine.value(signal, value);
      }
      machine.advance(picture.t_ns);
      machine.arrive(picture.poses);
      // Looks come behind the picture that they belong to, and so before the same picture once more.
      if (wanted.film !== null && !isAgain && due_ns !== null && picture.t_ns >= due_ns) link.subscribe(signals);
      if (isAgain) whole_ns = picture.t_ns;
      void draw().catch(fail);
    },
    state: () => {},
    garbage: (error) => void fail(error),
  });
  link.subscribe(signals);
}

/** Says why there is no picture. */
export async function fail(error: unknown): Promise<void> {
  const text = error instanceof Error ? error.message : String(error);
  await fetch("api/picture", { method: "POST", headers: { "content-type": "text/plain" }, body: text });
}

async function send(picture: Blob, type: string): Promise<void> {
  const answer = await fetch("api/picture", { method: "POST", headers: { "content-type": type }, body: picture });
  document.title = answer.ok ? "drawn" : `not taken: ${answer.status}`;
}
