// A lesson on its pages: what the trainee reads, and what the trainer does with the lesson.

import { form_for, in_form, minutes, seconds } from "./format";
import { own, say } from "./say";
import { button, make } from "./dom";
import type { Ask } from "./message";
import type { Message } from "./message";
import type { Lesson, LessonResult, Timing, View } from "./session";

/** How far back a trainer goes with one key, s. */
const BACK_S = [10, 30, 120];
type Attempt = Extract<Message, { readonly type: "lesson" }>;

const NS = 1e9;
/** When little time is left. */
const SHORT_NS = 30e9;

export class TrainingView {
  readonly root: HTMLElement;
  private readonly left = make("output", { class: "lesson-left" }, "–");
  private readonly result = make("div", { class: "lesson-result", role: "status" });
  private ends_ns: number | null = null;

  constructor(lesson: Lesson, private readonly views: readonly View[], now_ns: () => number, ask: (ask: Ask) => void) {
    const about = make("p", {}, own(lesson.about ?? ""));
    const heading = make("h3", {}, say("Lesson {name}", { name: own(lesson.lesson) }));
    const head = make("div", { class: "lesson-head" }, heading, make("span", {}, say("Time left"), " ", this.left));
    this.root = make("section", { class: "lesson", "aria-label": say("Lesson") }, head, about, ...this.asked(lesson), this.result);
    this.result.hidden = true;
    if (lesson.role === "trainer") this.root.append(this.controls(lesson, now_ns, ask));
  }

  /** What has to be so to pass. */
  private asked(lesson: Lesson): readonly HTMLElement[] {
    const mistakes = lesson.mistakes.map((one) => say("at most {count} times: {name}", { count: one.at_most, name: own(one.name) }));
    const all = [...lesson.asked.map((name) => own(name)), ...mistakes];
    return all.length === 0 ? [] : [make("details", { open: true }, make("summary", {}, say("To pass")), make("ul", {}, ...all.map((text) => make("li", {}, text))))];
  }

  /** Virtual time goes on. */
  at(t_ns: number): void {
    if (this.ends_ns === null) return;
    this.left.textContent = minutes(this.ends_ns - t_ns);
    this.left.classList.toggle("short", this.ends_ns - t_ns < SHORT_NS);
  }

  /** How the lesson goes, and what came of it. */
  show(attempt: Attempt): void {
    this.ends_ns = attempt.ends_ns;
    this.result.hidden = attempt.result === null;
    this.result.replaceChildren(...(attempt.result === null ? [] : result_of(attempt.result)));
    if (attempt.result !== null) this.root.scrollIntoView({ block: "start" });
  }

  /** From where the trainee is to see the machine. */
  private shown(ask: (ask: Ask) => void): readonly HTMLElement[] {
    if (this.views.length === 0) return [];
    const views = make("select", { "aria-label": say("View") }, ...this.views.map((one) => make("option", { value: one.name }, own(one.name))));
    return [views, button(say("Show view"), () => ask({ type: "view", view: views.value }), say("Shows it on the trainee's page, too"))];
  }

  private controls(lesson: Lesson, now_ns: () => number, ask: (ask: Ask) => void): HTMLElement {
    const starts = make("select", { "aria-label": say("Prepared state") }, ...lesson.starts.map((one) => make("option", { value: one }, own(one))));
    const back = BACK_S.map((seconds) =>
      button(say("Back {seconds} s", { seconds }), () => ask({ type: "train", turn: "back", t_ns: Math.max(0, now_ns() - seconds * NS) })));
    return make("div", { class: "lesson-desk" },
      button(say("Repeat"), () => ask({ type: "train", turn: "repeat" })), ...back,
      starts, button(say("Jump"), () => ask({ type: "train", turn: "jump", start: starts.value })), ...this.shown(ask));
  }
}

/** How long something took, beside how long it may take. */
function took(timing: Timing | null): string {
  if (timing === null) return "–";
  const text = timing.after_ns === null ? say("never") : seconds(timing.after_ns);
  return timing.within_ns === null ? text : say("{time} of {limit}", { time: text, limit: seconds(timing.within_ns) });
}

/** A line of the result: a mark with a shape and a word, and what it is about. */
function line(isGood: boolean, ...inside: readonly string[]): HTMLElement {
  const mark = make("td", { class: isGood ? "verdict-pass" : "verdict-fail" }, isGood ? "✓" : "✗", make("span", { class: "visually-hidden" }, isGood ? say("good") : say("not good")));
  return make("tr", {}, mark, ...inside.map((text) => make("td", {}, text)));
}

/** What came of an attempt, for who has taken it. */
function result_of(result: LessonResult): readonly HTMLElement[] {
  const { malfunctions, expectations, mistakes, costs } = result;
  const met = malfunctions.filter((one) => one.came).map((one) => line(
    [one.identified, one.acted].every((timing) => timing === null || timing.timely),
    own(one.name), say("identified after {time}", { time: took(one.identified) }), say("acted after {time}", { time: took(one.acted) })));
  const kept = expectations.map((one) => line(one.met, own(one.name), one.met ? say("kept") : say("violated"), one.at_ns === null ? "" : seconds(one.at_ns)));
  const made = mistakes.map((one) => line(one.count <= one.at_most, own(one.name), say("{count} times", { count: one.count }), say("forgiven: {count}", { count: one.at_most })));
  const done = result.done === null ? [] : [line(result.done, say("brought to its end"), "", "")];
  const spent = [...costs.map((one) => `${own(one.name)} ${in_form(one.value, form_for(one.unit, false, one.value))}`), say("time {time}", { time: seconds(result.lasted_ns) })];
  return [
    make("h3", { class: result.passed ? "verdict-pass" : "verdict-fail" }, result.passed ? say("Passed") : say("Not passed")),
    make("table", {}, make("tbody", {}, ...done, ...met, ...kept, ...made)),
    make("p", {}, spent.join(" · ")),
  ];
}
