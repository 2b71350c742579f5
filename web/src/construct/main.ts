// The editor of a scenario: connections are drawn, a machine is built, and the server writes both.

import { say } from "../say";
import "../page.css";
import "./edit.css";
import { button, frame, make } from "../dom";
import { begin_theme } from "../theme";
import { begin_words } from "../header";
import { Builder } from "./builder";
import { Editor } from "./editor";
import type { EditState, Finding, Refusal } from "./protocol";
import { WiringView } from "./wiring";

interface Seen {
  readonly revision: () => number;
  /** The corners of what is framed, on the screen. */
  readonly corners: () => readonly { readonly x: number; readonly y: number }[];
  readonly screen: (body: string) => { readonly x: number; readonly y: number } | null;
}

declare global {
  interface Window {
    /** What tests read. */
    onescanEdit?: Seen;
  }
}

function findings(all: readonly Finding[]): readonly HTMLElement[] {
  if (all.length === 0) return [make("p", { class: "empty" }, say("Nothing is wrong."))];
  return all.map((finding) => {
    const where = finding.file === null ? "" : `${finding.file}${finding.line === null ? "" : `:${finding.line}`}`;
    const row = make("li", { class: finding.is_error ? "finding error" : "finding" }, make("span", { class: "where" }, where), make("span", {}, finding.message));
    if (finding.help !== null) row.append(make("span", { class: "help" }, finding.help));
    return row;
  });
}

async function begin(): Promise<void> {
  begin_words();
  begin_theme();
  const parts: { wiring?: WiringView; builder?: Builder } = {};
  const notice = frame("notice");
  const refuse = (refusal: Refusal | null, is_theirs = false): void => {
    notice.hidden = refusal === null;
    if (refusal === null) return;
    const where = refusal.references.map((one) => ` ${one.file}:${one.line}`).join(",");
    notice.replaceChildren(`${refusal.message}${where === "" ? "" : ` (${where.trim()})`} `, ...(is_theirs ? [button(say("Read again"), () => void editor.want({ want: "reload" }))] : []));
  };
  const show = (state: EditState): void => {
    frame("title").textContent = state.scenario;
    document.title = say("{scenario} · onescan edit", { scenario: state.scenario });
    undo.disabled = state.undo === null;
    redo.disabled = state.redo === null;
    undo.title = state.undo === null ? say("Nothing to take back") : say("Take back: {undo}", { undo: state.undo });
    redo.title = state.redo === null ? say("Nothing to do again") : say("Do again: {redo}", { redo: state.redo });
    const errors = state.findings.filter((finding) => finding.is_error).length;
    const status = frame("check");
    status.textContent = state.changed.length > 0 ? say("changed by somebody else") : errors === 0 ? say("sound") : say("{errors} wrong", { errors });
    status.className = errors === 0 && state.changed.length === 0 ? "sound" : "wrong";
    frame("findings-list").replaceChildren(...findings(state.findings));
    if (state.changed.length > 0) {
      refuse({ message: say("Somebody else has changed {state}: read the files again before you change anything.", { state: state.changed.join(", ") }), file: null, line: null, references: [] }, true);
    }
    parts.wiring?.show(state);
    parts.builder?.show(state);
  };
  const editor = await Editor.open(show, refuse);
  const undo = button(say("Undo"), () => void editor.want({ want: "undo" }));
  const redo = button(say("Redo"), () => void editor.want({ want: "redo" }));
  frame("controls").append(undo, redo, button(say("Read again"), () => void editor.want({ want: "reload" }), say("Read the files again")));
  window.addEventListener("keydown", (event) => {
    const is_field = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || is_field) return;
    event.preventDefault();
    void editor.want({ want: event.shiftKey ? "redo" : "undo" });
  });
  tabs();
  parts.builder = new Builder(frame("build"), editor.library, (edits) => editor.want({ want: "change", edits }));
  parts.wiring = new WiringView(frame("wiring"), (one, other) => void editor.want({ want: "join", one, other }), (tip) => void editor.want({ want: "part", tip }));
  show(editor.state);
  const bench = parts.builder.bench;
  window.onescanEdit = { revision: () => editor.state.revision, corners: () => bench.corners(), screen: (body) => bench.screen(body) };
}

/** The two sheets, by mouse and arrow keys. */
function tabs(): void {
  const all = [...frame("sheets-of-edit").querySelectorAll<HTMLButtonElement>("[role=tab]")];
  const open = (chosen: HTMLButtonElement): void => {
    for (const tab of all) {
      tab.setAttribute("aria-selected", String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      frame(tab.dataset.sheet ?? "").hidden = tab !== chosen;
    }
  };
  all.forEach((tab, index) => {
    tab.addEventListener("click", () => open(tab));
    tab.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
      const next = all[(index + 1) % all.length];
      if (next === undefined) return;
      open(next);
      next.focus();
    });
  });
}

begin().catch((error: unknown) => {
  const notice = frame("notice");
  notice.replaceChildren(say("The scenario cannot be shown: {error}.", { error: error instanceof Error ? error.message : String(error) }), " ", button(say("Try again"), () => window.location.reload()));
  notice.hidden = false;
});
