// The sources of the PLC with the values of their variables at the end of each line.

import { say } from "./say";
import { EditorState, StateEffect, StateField } from "@codemirror/state";
import { Decoration, EditorView, WidgetType, keymap, lineNumbers, type DecorationSet } from "@codemirror/view";
import { make } from "./dom";
import { shown } from "./format";
import { words, type WordKind } from "./highlight";
import type { Session, Source } from "./session";

/** Values beside a line; what is true or false has its own colour and form. */
class Values extends WidgetType {
  constructor(private readonly all: readonly string[]) {
    super();
  }

  override eq(other: Values): boolean {
    return other.all.join("\n") === this.all.join("\n");
  }

  override toDOM(): HTMLElement {
    const element = document.createElement("span");
    element.className = "line-values";
    for (const one of this.all) {
      const kind = / = TRUE\b/.test(one) ? " true" : / = FALSE\b/.test(one) ? " false" : "";
      element.append(make("span", { class: `line-value${kind}` }, one));
    }
    return element;
  }
}

const COLOURED: Readonly<Record<WordKind, Decoration>> = {
  key: Decoration.mark({ class: "word-key" }), say: Decoration.mark({ class: "word-say" }),
  text: Decoration.mark({ class: "word-text" }), number: Decoration.mark({ class: "word-number" }),
};
const executed_line = Decoration.line({ class: "executed" });
const set_values = StateEffect.define<DecorationSet>();
const values_field = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update: (before, change) => {
    for (const effect of change.effects) if (effect.is(set_values)) return effect.value;
    return before.map(change.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** What stands beside a line of the PLC's variables. */
export interface Inner {
  readonly reading: (variable: number) => string | null;
  readonly was_executed: (file: string, line: number) => boolean | null;
}

export class SourceView {
  private readonly editor: EditorView;
  private source: Source | null = null;

  constructor(
    place: HTMLElement,
    private readonly session: Session,
    private readonly values: ReadonlyMap<number, number>,
    private readonly inner: Inner,
  ) {
    this.editor = new EditorView({ parent: place, state: this.state("") });
    // Arrow keys scroll it.
    const { scrollDOM } = this.editor;
    scrollDOM.tabIndex = 0;
    scrollDOM.setAttribute("role", "group");
    scrollDOM.setAttribute("aria-label", say("Source, scrolled by arrow keys"));
  }

  open(source: Source): void {
    this.source = source;
    this.editor.setState(this.state(source.text));
    this.show();
  }

  /** The signals whose values stand beside the open source. */
  signals(): readonly number[] {
    const names = new Set(this.source?.lines.flatMap((line) => line.variables) ?? []);
    return this.session.signals.flatMap((signal, index) => (names.has(signal.name) ? [index] : []));
  }

  /** The variables of the PLC whose values stand beside the open source. */
  variables(): readonly number[] {
    return [...new Set(this.source?.lines.flatMap((line) => line.inner) ?? [])];
  }

  show(): void {
    const source = this.source;
    if (source === null) return;
    const lines = this.editor.state.doc.lines;
    const marks = source.lines.flatMap((line) => {
      const all = [...line.variables.map((name) => this.reading(name)), ...line.inner.map((one) => this.inner.reading(one))];
      const known = all.filter((one) => one !== null);
      if (line.line < 1 || line.line > lines || known.length === 0) return [];
      return [Decoration.widget({ widget: new Values(known), side: 1 }).range(this.editor.state.doc.line(line.line).to)];
    });
    const executed = Array.from({ length: lines }, (_, index) => index + 1).flatMap((line) =>
      this.inner.was_executed(source.path, line) === true ? [executed_line.range(this.editor.state.doc.line(line).from)] : []);
    this.editor.dispatch({ effects: set_values.of(Decoration.set([...marks, ...executed], true)) });
  }

  private reading(name: string): string | null {
    const index = this.session.signals.findIndex((one) => one.name === name);
    const signal = this.session.signals[index];
    return signal === undefined ? null : `${name} = ${shown(signal, this.values.get(index))}`;
  }

  private state(text: string): EditorState {
    const label = EditorView.contentAttributes.of({ "aria-label": say("Source of the PLC, read only") });
    const coloured = words(text).map(({ from, to, kind }) => COLOURED[kind].range(from, to));
    return EditorState.create({
      doc: text,
      extensions: [EditorState.readOnly.of(true), lineNumbers(), keymap.of([]), label, values_field, EditorView.decorations.of(Decoration.set(coloured))],
    });
  }
}
