// What is there to do when the run is over and its page stays: look back, run again, go on, keep what was done as a case, close.

import { button, make } from "./dom";
import { seconds } from "./format";
import type { Ask } from "./message";
import { say } from "./say";

/** How far a session may go on beyond the end, in seconds. */
const FURTHER_S = [10, 60, 600, 3600] as const;
const NS_PER_S = 1e9;

export class Ending {
  readonly root: HTMLElement;
  private readonly text = make("span", {});
  private readonly onward: HTMLElement;
  private past_ns: readonly [number, number] | null = null;

  /** `keep` opens what makes a case of the run; nothing where there can be none. */
  constructor(private readonly ask: (ask: Ask) => void, keep: (() => void) | null) {
    const further = make("select", { "aria-label": say("How far it goes on") },
      ...FURTHER_S.map((span_s) => make("option", { value: String(span_s) }, seconds(span_s * NS_PER_S))));
    this.onward = make("span", {},
      button(say("Run again"), () => this.fork(null), say("Starts another session from the beginning")), " ",
      button(say("Go on for"), () => this.fork(Number(further.value)), say("Starts another session from the end")), " ", further, " ",
      ...(keep === null ? [] : [button(say("Save as a case"), keep, say("Makes a case of what operators did, which you can run and test again")), " "]));
    const close = button(say("Close"), () => this.ask({ type: "operate", operation: "stop" }), say("Ends the page, with the report of the run"));
    this.root = make("div", { id: "ending", role: "status", hidden: true }, this.text, " ", this.onward, close);
  }

  /** The run has come to its end at `t_ns`; what is kept of it reaches so far. */
  show(t_ns: number, past_ns: readonly [number, number] | null): void {
    this.past_ns = past_ns;
    this.onward.hidden = past_ns === null;
    const text = past_ns === null
      ? say("The run is over at {time}.", { time: seconds(t_ns) })
      : say("The run is over at {time}: drag the timeline to look back.", { time: seconds(t_ns) });
    // Said once: a text that is set again is read out again.
    if (this.text.textContent !== text) this.text.textContent = text;
    this.root.hidden = false;
  }

  hide(): void {
    this.root.hidden = true;
  }

  /** Another session from the beginning, or from the end and so many seconds further. */
  private fork(further_s: number | null): void {
    if (this.past_ns === null) return;
    const [first_ns, last_ns] = this.past_ns;
    if (further_s === null) this.ask({ type: "fork", t_ns: first_ns });
    else this.ask({ type: "fork", t_ns: last_ns, until_ns: last_ns + further_s * NS_PER_S });
  }
}
