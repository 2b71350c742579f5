// The time that is shown: the live edge, or a moment of the past.

import { button, make } from "./dom";
import { seconds } from "./format";
import type { Ask, Picture, Session } from "./protocol";

export class Timeline {
  private readonly slider = make("input", { type: "range", min: "0", max: "0", step: "1", "aria-label": "Time that is shown" });
  private readonly output = make("output", {}, "live");
  private readonly live: HTMLButtonElement;
  private readonly fork: HTMLButtonElement;
  private shown_ns: number | null = null;

  constructor(
    place: HTMLElement,
    private readonly session: Session,
    private readonly ask: (ask: Ask) => void,
  ) {
    this.live = button("Live", () => this.ask({ type: "live" }), "Back to the live edge");
    this.fork = button("Go on from here", () => {
      if (this.shown_ns !== null) this.ask({ type: "fork", t_ns: this.shown_ns });
    });
    this.slider.addEventListener("input", () => {
      this.output.textContent = seconds(this.chosen_ns());
      this.ask({ type: "show", t_ns: this.chosen_ns() });
    });
    place.append(this.live, this.slider, this.output, this.fork);
    this.reach(null, null);
  }

  /** The part of the past that can be shown, in nanoseconds, and the moment that is. */
  reach(past_ns: readonly [number, number] | null, shown_ns: number | null): void {
    this.shown_ns = shown_ns;
    this.slider.disabled = past_ns === null;
    this.live.disabled = shown_ns === null || !this.session.live;
    this.fork.disabled = shown_ns === null;
    if (past_ns !== null) {
      this.slider.min = String(Math.ceil(past_ns[0] / this.session.step_ns));
      this.slider.max = String(Math.floor(past_ns[1] / this.session.step_ns));
    }
    if (shown_ns === null) this.slider.value = this.slider.max;
    this.output.textContent = shown_ns === null ? "live" : seconds(shown_ns);
    this.slider.setAttribute("aria-valuetext", this.output.textContent);
  }

  /** Keeps the live edge at the end of the slider. */
  at(picture: Picture): void {
    if (picture.isPast || this.shown_ns !== null) return;
    if (!this.slider.disabled) this.slider.max = String(picture.step);
    this.slider.value = this.slider.max;
  }

  private chosen_ns(): number {
    return Number(this.slider.value) * this.session.step_ns;
  }
}
