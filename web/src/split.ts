// The lines between the panes: drawn by the pointer or moved by arrow keys, kept for the next time.

import { say } from "./say";
import { frame, make } from "./dom";

const KEY = "onescan-panes";
/** Neither pane gets smaller than this share, %. */
const [LEAST, MOST] = [15, 80] as const;
const STEP = 2;

export interface Panes {
  /** The share of the width that the sheets beside the machine have, %. */
  readonly side: number;
  /** The share of the height that the trends below it have, %. */
  readonly low: number;
}

const AT_FIRST: Panes = { side: 38, low: 36 };

/** A share within its bounds, in tenths. */
export function bounded(share: number): number {
  return Math.round(Math.min(MOST, Math.max(LEAST, share)) * 10) / 10;
}

/** What was kept; what cannot be read is as at first. */
export function kept(text: string | null): Panes {
  try {
    const read: unknown = JSON.parse(text ?? "null");
    if (typeof read !== "object" || read === null) return AT_FIRST;
    const of = (key: keyof Panes): number => {
      const share: unknown = Reflect.get(read, key);
      return typeof share === "number" && Number.isFinite(share) ? bounded(share) : AT_FIRST[key];
    };
    return { side: of("side"), low: of("low") };
  } catch {
    return AT_FIRST;
  }
}

/** Puts the lines between the panes. */
export function begin_split(): void {
  const main = frame("panes");
  let panes = kept(window.localStorage.getItem(KEY));
  const lines = new Map<keyof Panes, HTMLElement>();
  const put = (next: Panes): void => {
    panes = next;
    for (const [key, line] of lines) {
      main.style.setProperty(`--${key}`, `${panes[key]}%`);
      line.setAttribute("aria-valuenow", String(panes[key]));
    }
    window.localStorage.setItem(KEY, JSON.stringify(panes));
  };
  const line = (key: keyof Panes, label: string): HTMLElement => {
    const isUpright = key === "side";
    const element = make("div", {
      class: `split ${key}`, role: "separator", tabindex: "0", "aria-label": label, title: say("Drag, or use the arrow keys; twice for the size at first"),
      "aria-orientation": isUpright ? "vertical" : "horizontal", "aria-valuemin": String(LEAST), "aria-valuemax": String(MOST),
    });
    const move = (event: PointerEvent): void => {
      const box = main.getBoundingClientRect();
      const share = isUpright ? (box.right - event.clientX) / box.width : (box.bottom - event.clientY) / box.height;
      put({ ...panes, [key]: bounded(share * 100) });
    };
    element.addEventListener("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    element.addEventListener("pointermove", (event) => {
      if (element.hasPointerCapture(event.pointerId)) move(event);
    });
    element.addEventListener("dblclick", () => put({ ...panes, [key]: AT_FIRST[key] }));
    element.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1 }[event.key];
      if (way === undefined) return;
      event.preventDefault();
      put({ ...panes, [key]: bounded(panes[key] + way * STEP) });
    });
    lines.set(key, element);
    return element;
  };
  main.append(line("side", say("Width of the sheets")), line("low", say("Height of the trends")));
  put(panes);
}
