// A lesson on its pages: what the trainee reads, and what the trainer does with the lesson.

import { button, make } from "./dom";
import type { Ask } from "./message";
import type { Lesson, View } from "./session";

/** How far back a trainer goes with one key, s. */
const BACK_S = [10, 30, 120];
const NS = 1e9;

export class TrainingView {
  readonly root: HTMLElement;

  constructor(lesson: Lesson, private readonly views: readonly View[], now_ns: () => number, ask: (ask: Ask) => void) {
    const about = make("p", {}, lesson.about ?? "");
    const heading = make("h3", {}, `Lesson ${lesson.lesson}`);
    this.root = make("section", { class: "lesson", "aria-label": "Lesson" }, heading, about);
    if (lesson.role === "trainer") this.root.append(this.controls(lesson, now_ns, ask));
  }

  /** From where the trainee is to see the machine. */
  private shown(ask: (ask: Ask) => void): readonly HTMLElement[] {
    if (this.views.length === 0) return [];
    const views = make("select", { "aria-label": "View" }, ...this.views.map((one) => make("option", { value: one.name }, one.name)));
    return [views, button("Show view", () => ask({ type: "view", view: views.value }), "Shows it on the trainee's page, too")];
  }

  private controls(lesson: Lesson, now_ns: () => number, ask: (ask: Ask) => void): HTMLElement {
    const starts = make("select", { "aria-label": "Prepared state" }, ...lesson.starts.map((one) => make("option", { value: one }, one)));
    const back = BACK_S.map((seconds) =>
      button(`Back ${seconds} s`, () => ask({ type: "train", turn: "back", t_ns: Math.max(0, now_ns() - seconds * NS) })));
    return make("div", { class: "lesson-desk" },
      button("Repeat", () => ask({ type: "train", turn: "repeat" })), ...back,
      starts, button("Jump", () => ask({ type: "train", turn: "jump", start: starts.value })), ...this.shown(ask));
  }
}
