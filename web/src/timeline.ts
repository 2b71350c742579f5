// The time that is shown: the live edge, or a moment of the past. A recording can be played.

import { say } from "./say";
import { button, make } from "./dom";
import { seconds } from "./format";
import type { Ask } from "./message";
import type { Picture } from "./picture";
import type { Session } from "./session";

/** How often a recording that plays asks for its next moment. */
const PLAY_MS = 50;
/** For so long a moment that was asked for may be on its way, ms. */
const WAY_MS = 1_000;

export class Timeline {
  private readonly slider = make("input", { type: "range", min: "0", max: "0", step: "1", "aria-label": say("Time that is shown") });
  private readonly output = make("output", {}, say("live"));
  private readonly link = make("a", { target: "_blank", rel: "noopener" });
  private readonly live: HTMLButtonElement;
  private readonly fork: HTMLButtonElement;
  private readonly play: HTMLButtonElement;
  private shown_ns: number | null = null;
  private playing: number | null = null;
  /** The step that was asked for; its picture may be on its way. */
  private asked: number | null = null;
  private asked_ms = 0;

  constructor(
    place: HTMLElement,
    private readonly session: Session,
    private readonly ask: (ask: Ask) => void,
  ) {
    this.live = button(say("Live"), () => {
      this.asked = null;
      this.ask({ type: "live" });
    }, say("Back to the live edge"));
    this.play = button(say("Play"), () => this.toggle(), say("Play from here in real time"));
    this.fork = button(say("Go on from here"), () => {
      if (this.shown_ns !== null) this.ask({ type: "fork", t_ns: this.shown_ns });
    }, say("Starts another session from this moment"));
    this.slider.addEventListener("input", () => {
      this.output.textContent = seconds(this.chosen_ns());
      this.show(Number(this.slider.value));
    });
    this.link.hidden = true;
    place.append(session.live ? this.live : this.play, this.slider, this.output, this.fork, this.link);
    this.reach(null, null);
  }

  /** The part of the past that can be shown, in nanoseconds, and the moment that is. */
  reach(past_ns: readonly [number, number] | null, shown_ns: number | null): void {
    this.shown_ns = shown_ns;
    this.slider.disabled = past_ns === null;
    this.play.disabled = past_ns === null;
    this.live.disabled = shown_ns === null || !this.session.live;
    this.fork.disabled = shown_ns === null;
    if (past_ns !== null) {
      this.slider.min = String(Math.ceil(past_ns[0] / this.session.step_ns));
      this.slider.max = String(Math.floor(past_ns[1] / this.session.step_ns));
    }
    // What was asked for may be on its way, and the session not know of it yet.
    if (shown_ns === null && !this.isOnItsWay) this.slider.value = this.slider.max;
    this.output.textContent = shown_ns === null ? say("live") : seconds(shown_ns);
    this.slider.setAttribute("aria-valuetext", this.output.textContent);
  }

  /** Keeps the live edge at the end of the slider. */
  at(picture: Picture): void {
    if (picture.isPast) {
      if (this.asked !== null && picture.step >= this.asked) this.asked = null;
      return;
    }
    if (this.shown_ns !== null || this.isOnItsWay) return;
    if (!this.slider.disabled) this.slider.max = String(picture.step);
    this.slider.value = this.slider.max;
  }

  /** A session goes on from a moment: its page is a link away. */
  forked(t_ns: number, url: string): void {
    const to = new URL(url);
    // A session that listens everywhere is found where this one was.
    if (to.hostname === "0.0.0.0" || to.hostname === "[::]") to.hostname = window.location.hostname;
    this.link.href = to.href;
    this.link.textContent = say("Session from {t_ns}", { t_ns: seconds(t_ns) });
    this.link.hidden = false;
  }

  /** Whether a moment was asked for just now: the session may not know of it yet. */
  private get isOnItsWay(): boolean {
    return this.asked !== null && performance.now() - this.asked_ms < WAY_MS;
  }

  private show(step: number): void {
    [this.asked, this.asked_ms] = [step, performance.now()];
    this.ask({ type: "show", t_ns: step * this.session.step_ns });
  }

  private toggle(): void {
    if (this.playing !== null) return this.pause();
    this.play.textContent = say("Pause");
    let before_ms = performance.now();
    let ahead_ns = 0;
    this.playing = window.setInterval(() => {
      const now_ms = performance.now();
      ahead_ns += (now_ms - before_ms) * 1e6;
      before_ms = now_ms;
      const steps = Math.floor(ahead_ns / this.session.step_ns);
      // A machine that is too slow to play in real time plays slower, picture by picture.
      if (steps === 0 || this.asked !== null) return;
      ahead_ns = Math.min(ahead_ns - steps * this.session.step_ns, 1e9);
      const next = Math.min(Number(this.slider.value) + steps, Number(this.slider.max));
      if (next === Number(this.slider.value)) return this.pause();
      this.slider.value = String(next);
      this.show(next);
    }, PLAY_MS);
  }

  private pause(): void {
    if (this.playing !== null) window.clearInterval(this.playing);
    this.playing = null;
    this.play.textContent = say("Play");
  }

  private chosen_ns(): number {
    return Number(this.slider.value) * this.session.step_ns;
  }
}
