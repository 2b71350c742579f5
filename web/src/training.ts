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
type Drive = NonNullable<Extract<Message, { readonly type: "drive" }>["now"]>;

const NS = 1e9;
/** When little time is left. */
const SHORT_NS = 30e9;

export class TrainingView {
  readonly root: HTMLElement;
  private readonly left = make("output", { class: "lesson-left" }, "–");
  private readonly result = make("div", { class: "lesson-result", role: "status" });
  private readonly drive_text = make("p", {});
  private readonly drive_bar = make("progress", { max: "1" });
  private readonly drive = make("div", { class: "lesson-drive" }, this.drive_text, this.drive_bar);
  private desk: HTMLElement | null = null;
  private ends_ns: number | null = null;

  constructor(lesson: Lesson, private readonly views: readonly View[], now_ns: () => number, ask: (ask: Ask) => void) {
    const about = make("p", {}, own(lesson.about ?? ""));
    const heading = make("h3", {}, say("Lesson {name}", { name: own(lesson.lesson) }));
    const head = make("div", { class: "lesson-head" }, heading, make("span", {}, say("Time left"), " ", this.left));
    this.root = make("section", { class: "lesson", "aria-label": say("Lesson") }, head, this.drive, about, ...this.asked(lesson), this.result);
    this.result.hidden = true;
    this.drive.hidden = true;
    if (lesson.role !== "trainer") return;
    this.desk = this.controls(lesson, now_ns, ask);
    this.root.append(this.desk);
  }

  /** How far a real PLC is on its way to where the lesson begins; why nothing is operated meanwhile. */
  show_drive(now: Drive | null): string | null {
    this.drive.hidden = now === null;
    const why = now === null ? null : say("The PLC is being driven to where the lesson begins: nothing can be operated until it is there.");
    for (const input of this.desk?.querySelectorAll<HTMLButtonElement | HTMLSelectElement>("button, select") ?? []) {
      input.dataset["title"] ??= input.title;
      [input.disabled, input.title] = [why !== null, why ?? input.dataset["title"]];
    }
    if (now === null) return why;
    const share = now.to_ns === 0 ? 1 : now.at_ns / now.to_ns;
    const [plcs, start, at, to] = [now.plcs.join(", "), own(now.start), minutes(now.at_ns), minutes(now.to_ns)];
    this.drive_text.textContent = say("PLC {plcs} is being driven from its cold start by way of {start} to {to}: it is at {at}, {share} %.", { plcs, start, to, at, share: Math.floor(100 * share) });
    this.drive_bar.value = share;
    this.drive_bar.setAttribute("aria-label", say("How far the PLC is"));
    this.left.textContent = "–";
    return why;
  }

  /** What has to be so to pass. */
  private asked(lesson: Lesson): readonly HTMLElement[] {
    const mistakes = lesson.mistakes.map((one) => say("at most {count} times: {name}", { count: one.at_most, name: own(one.name) }));
    const all = [...lesson.asked.map((name) => own(name)), ...mistakes];
    return all.length === 0 ? [] : [make("details", { open: true }, make("summary", {}, say("To pass")), make("ul", {}, ...all.map((text) => make("li", {}, text))))];
  }

  /** Virtual time goes on. */
  at(t_ns: number): void {
    if (this.ends_ns === null || !this.drive.hidden) return;
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
