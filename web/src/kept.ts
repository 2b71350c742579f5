// What operators did as a case: its name, its text as it would be written, and whether it is.

import { button, make } from "./dom";
import type { Ask, Message } from "./message";
import { say } from "./say";

export type KeptCase = Extract<Message, { readonly type: "case" }>;

/** After the last key of a name, the case is shown again, ms. */
const TYPED_MS = 250;

/** Whether a case can be called so. */
export function is_name(name: string): boolean {
  return /^[A-Za-z0-9_-][A-Za-z0-9_.-]*$/.test(name);
}

export class CaseDialog {
  private readonly dialog = make("dialog", { class: "force case", "aria-labelledby": "case-title" });
  private readonly name = make("input", { type: "text", autocomplete: "off", value: "operated", "aria-label": say("Name of the case") });
  private readonly text = make("pre", { tabindex: "0", "aria-label": say("The case as it is written") });
  private readonly where = make("p", {});
  private readonly fault = make("p", { class: "fault", role: "alert" });
  private readonly done = make("p", { role: "status" });
  private readonly save: HTMLButtonElement;
  private timer: number | null = null;

  constructor(private readonly ask: (ask: Ask) => void) {
    this.save = button(say("Save"), () => this.want(true), say("Writes the case into the file"));
    this.name.addEventListener("input", () => {
      this.save.disabled = true;
      if (this.timer !== null) window.clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.want(false), TYPED_MS);
    });
    this.name.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && !this.save.disabled) this.want(true);
    });
    const label = make("label", {}, say("Name of the case"), " ", this.name);
    this.dialog.append(make("h2", { id: "case-title" }, say("Save as a case")), make("p", {}, say("A case repeats what operators did, to the digest.")), label,
      this.fault, this.text, this.where, this.done, make("div", { class: "toolbar" }, this.save, button(say("Close"), () => this.dialog.close())));
    document.body.append(this.dialog);
  }

  open(): void {
    [this.text.textContent, this.where.textContent, this.done.textContent, this.save.disabled] = ["", "", "", true];
    this.dialog.showModal();
    this.name.select();
    this.want(false);
  }

  /** True if an error of the session is shown here: it is about the case. */
  fail(message: string): boolean {
    if (!this.dialog.open) return false;
    this.fault.textContent = message;
    this.save.disabled = true;
    return true;
  }

  show({ name, text, path, saved, may_save }: KeptCase): void {
    if (name !== this.name.value) return;
    this.fault.textContent = "";
    this.text.textContent = text;
    this.where.textContent = may_save ? say("It goes into {path}.", { path }) : say("Copy it into {path}: this run was not begun with --save-cases.", { path });
    // What is there cannot be written once more.
    this.save.disabled = !may_save || saved;
    this.done.textContent = saved ? say("It is saved. Run it with --case {name}.", { name }) : "";
  }

  private want(save: boolean): void {
    this.timer = null;
    const name = this.name.value;
    this.fault.textContent = is_name(name) ? "" : say("A name has letters, digits, -, _ and a point.");
    if (is_name(name)) this.ask({ type: "case", name, save });
  }
}
