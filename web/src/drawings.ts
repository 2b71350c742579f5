// The drawings of a session's PLCs: which one is shown, of which instance, with the values that come for it.

import { say } from "./say";
import { make } from "./dom";
import { DrawingView } from "./drawing";
import type { Ask } from "./message";
import type { Session } from "./session";

export class Drawings {
  readonly root = make("div", { class: "drawings" });
  private readonly sheet = make("div", { class: "sheet", tabindex: "0", role: "region", "aria-label": say("Drawing") });
  private readonly instances = make("select", { "aria-label": say("Instance") });
  private view: DrawingView | null = null;
  private open: { drawing: number; instance: number } | null = null;

  constructor(
    private readonly session: Session,
    private readonly ask: (ask: Ask) => void,
  ) {
    this.instances.addEventListener("change", () => {
      if (this.open !== null) this.show(this.open.drawing, this.instances.selectedIndex);
    });
    this.root.append(this.instances, this.sheet);
  }

  /** The names of all drawings. */
  names(): readonly string[] {
    return this.session.drawings.map((one) => (one.part === null ? one.unit : `${one.unit}.${one.part}`));
  }

  /** Shows a drawing with the values of one of its instances. */
  show(drawing: number, instance = 0): void {
    const about = this.session.drawings[drawing];
    if (about === undefined) return;
    if (this.open?.drawing !== drawing) {
      this.view = new DrawingView(about);
      this.sheet.replaceChildren(this.view.root);
      this.instances.replaceChildren(...about.instances.map((one) => make("option", {}, `${one.client}: ${one.path}`)));
    }
    this.instances.selectedIndex = instance;
    this.instances.hidden = about.instances.length < 2;
    this.open = { drawing, instance };
    this.ask({ type: "draw", drawing, instance });
  }

  /** No values are needed any more. */
  close(): void {
    if (this.open !== null) this.ask({ type: "draw", drawing: null, instance: 0 });
  }

  /** Asks once more for what is shown. */
  again(): void {
    if (this.open !== null) this.ask({ type: "draw", ...this.open });
  }

  /** Takes the values of the states of a drawing. */
  handle(drawing: number, instance: number, values: readonly (number | null)[]): void {
    if (this.open?.drawing !== drawing || this.open.instance !== instance) return;
    const states = new Map((this.session.drawings[drawing]?.states ?? []).map((path, index) => [path, values[index] ?? null]));
    this.view?.show((path) => states.get(path) ?? null);
  }
}
