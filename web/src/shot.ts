// One picture of the machine, for `onescan shot`: the page draws it alone and sends it back to the session.

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
}

/** Reads `?shot=1280x720&view=0&theme=dark`; nothing where no picture is asked for. */
export function wanted(query: string): Wanted | null {
  const words = new URLSearchParams(query);
  const size = /^(\d{1,4})x(\d{1,4})$/.exec(words.get("shot") ?? "");
  if (size === null) return null;
  const view = words.get("view");
  return { width: Number(size[1]), height: Number(size[2]), view: view === null ? null : Number(view), theme: words.get("theme") };
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
  let [areLooksKnown, isSent] = [session.looks.every((look) => look.when === null), false];
  let last: Picture | null = null;
  const draw = async (): Promise<void> => {
    if (isSent || last === null || !areLooksKnown || signals.some((signal) => !values.has(signal))) return;
    isSent = true;
    const view = wanted.view === null ? undefined : session.views[wanted.view];
    if (view === undefined) machine.home();
    else machine.see(view);
    machine.light_up(new Set(sensors.filter((one) => values.get(one.signal) !== 0).map((one) => one.body)));
    machine.theme(colour("--ground"), colour("--line"));
    await send(await machine.picture(wanted.width, wanted.height));
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
      last = picture;
      for (const [signal, value] of picture.values) {
        values.set(signal, value);
        machine.value(signal, value);
      }
      machine.advance(picture.t_ns);
      machine.arrive(picture.poses);
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

async function send(picture: Blob): Promise<void> {
  const answer = await fetch("api/picture", { method: "POST", headers: { "content-type": "image/png" }, body: picture });
  document.title = answer.ok ? "drawn" : `not taken: ${answer.status}`;
}
