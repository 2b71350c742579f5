// The sound of alarms, for those who choose it: the more urgent, the higher, the more often.

import { button } from "./dom";
import { say } from "./say";
import type { Standing } from "./alarms";
import type { Priority } from "./session";

const KEY = "onescan-alarm-sound";

/** Per priority: the pitch, how many tones, and after how long they come again. */
const TUNES: Readonly<Record<Priority, { readonly pitch_hz: number; readonly tones: number; readonly each_ms: number }>> = {
  critical: { pitch_hz: 988, tones: 3, each_ms: 2_000 },
  high: { pitch_hz: 784, tones: 2, each_ms: 4_000 },
  medium: { pitch_hz: 659, tones: 1, each_ms: 8_000 },
  low: { pitch_hz: 523, tones: 1, each_ms: 15_000 },
};
const TONE_S = 0.16;
const GAP_S = 0.1;

export class AlarmSound {
  readonly key: HTMLButtonElement;
  /** How often it has sounded. */
  count = 0;
  private context: AudioContext | null = null;
  private isOn = window.localStorage.getItem(KEY) === "on";
  private last_ms = Number.NEGATIVE_INFINITY;
  private last = "";

  constructor() {
    this.key = button(say("Sound"), () => {
      this.isOn = !this.isOn;
      window.localStorage.setItem(KEY, this.isOn ? "on" : "off");
      this.key.setAttribute("aria-pressed", String(this.isOn));
      this.last_ms = Number.NEGATIVE_INFINITY;
    }, say("A sound for alarms that are not acknowledged"));
    this.key.setAttribute("aria-pressed", String(this.isOn));
  }

  /** Sounds for the most urgent alarm, again and again until it is acknowledged. */
  ring(urgent: Standing | null, now_ms: number): void {
    if (!this.isOn || urgent === null) return;
    const tune = TUNES[urgent.about.priority];
    const which = `${urgent.alarm} ${urgent.came_ns}`;
    if (which === this.last && now_ms - this.last_ms < tune.each_ms) return;
    [this.last, this.last_ms] = [which, now_ms];
    this.count += 1;
    this.play(tune.pitch_hz, tune.tones);
  }

  private play(pitch_hz: number, tones: number): void {
    this.context ??= new AudioContext();
    const { context } = this;
    // A browser lets a page sound once its viewer has pressed something.
    void context.resume().catch(() => undefined);
    for (let tone = 0; tone < tones; tone += 1) {
      const [from_s, oscillator, gain] = [context.currentTime + tone * (TONE_S + GAP_S), context.createOscillator(), context.createGain()];
      oscillator.frequency.value = pitch_hz;
      gain.gain.setValueAtTime(0, from_s);
      gain.gain.linearRampToValueAtTime(0.2, from_s + 0.01);
      gain.gain.linearRampToValueAtTime(0, from_s + TONE_S);
      oscillator.connect(gain).connect(context.destination);
      oscillator.start(from_s);
      oscillator.stop(from_s + TONE_S);
    }
  }
}
