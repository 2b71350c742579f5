// A form of the keys of a table: units, ranges and presets as the library has them.

import { say } from "../say";
import { make } from "../dom";
import type { FieldInfo, Given, Json } from "./protocol";

/** What a form knows beside its fields. */
export interface Surroundings {
  /** Names of things of a sort, as bodies. */
  readonly names: (sort: string) => readonly string[];
}

/** What `changed` is called with: a value, or that the key is to go. */
export type Changed = (key: string, value: Given | null) => void;

const PART_TITLES: readonly (readonly [readonly string[], string, boolean])[] = [
  [["binding"], say("Where"), true],
  [["parameter"], say("Parameters"), true],
  [["input", "output"], say("Signals"), true],
  [["wire"], say("Constants and wires"), false],
];

function bounds(field: FieldInfo): string {
  if (field.form.kind !== "number" && field.form.kind !== "whole") return "";
  const { least, most } = field.form;
  return least === null || most === null ? "" : say(", {least} to {most}", { least, most });
}

/** The form; with `keys` each is shown as it is, `main` names those that are not hidden away. */
export function fieldset(fields: readonly FieldInfo[], keys: ReadonlyMap<string, Json>, around: Surroundings, changed: Changed, main: ((field: FieldInfo) => boolean) | null = null): HTMLElement {
  const form = make("div", { class: "fields" });
  for (const [parts, title, is_open] of PART_TITLES) {
    const own = fields.filter((field) => parts.includes(field.part));
    if (own.length === 0) continue;
    const first = own.filter((field) => main === null || main(field) || keys.has(field.key));
    const rest = own.filter((field) => !first.includes(field));
    const section = make("details", { class: "part", open: is_open && first.length > 0 }, make("summary", {}, title));
    section.append(...first.map((field) => row(field, keys.get(field.key), around, changed)));
    if (rest.length > 0) {
      section.append(make("details", { class: "more" }, make("summary", {}, say("more")), ...rest.map((field) => row(field, keys.get(field.key), around, changed))));
    }
    form.append(section);
  }
  return form;
}

function row(field: FieldInfo, value: Json | undefined, around: Surroundings, changed: Changed): HTMLElement {
  const label = make("span", { class: "field-name" }, field.part === "output" ? `${field.name} →` : field.part === "input" ? `→ ${field.name}` : field.name);
  if (field.needed) label.append(make("abbr", { title: say("needed") }, " *"));
  const about = [field.about, bounds(field).slice(2)].filter((text) => text !== "").join("; ");
  const group = make("div", { class: "field", title: about }, label, control(field, value, around, changed));
  return group;
}

function control(field: FieldInfo, value: Json | undefined, around: Surroundings, changed: Changed): HTMLElement {
  const name = `${field.key}${field.unit === null ? "" : say(" in {unit}", { unit: field.unit })}`;
  const unit = field.unit === null || field.part === "input" || field.part === "output" ? [] : [make("span", { class: "unit" }, field.unit)];
  const preset = field.preset === null ? "" : String(field.preset);
  const { form, key } = field;
  const notify = (given: Given | null): void => changed(key, given);
  switch (form.kind) {
    case "number":
    case "whole": {
      const input = make("input", {
        type: "number", "aria-label": name, placeholder: preset, step: form.kind === "whole" ? "1" : "any",
        ...(form.least === null ? {} : { min: String(form.least) }), ...(form.most === null ? {} : { max: String(form.most) }),
        value: typeof value === "number" ? String(value) : "",
      });
      input.addEventListener("change", () => {
        if (input.value === "") notify(null);
        else if (input.reportValidity()) notify(input.valueAsNumber);
      });
      return make("span", { class: "control" }, input, ...unit);
    }
    case "flag":
      return choice(name, ["true", "false"], value === undefined ? "" : String(value), preset, (word) => notify(word === null ? null : word === "true"));
    case "choice":
      return choice(name, form.words, typeof value === "string" ? value : "", preset, notify);
    case "numbers": {
      const numbers = Array.isArray(value) ? (value as readonly Json[]) : [];
      const inputs = Array.from({ length: form.count }, (_, index) => {
        const axis = form.count === 3 ? ["x", "y", "z"][index] ?? "" : String(index + 1);
        const known = numbers[index];
        return make("input", { type: "number", step: "any", "aria-label": say("{axis} of {name}", { axis, name }), placeholder: axis, value: typeof known === "number" ? String(known) : "" });
      });
      for (const input of inputs) {
        input.addEventListener("change", () => {
          const filled = inputs.filter((one) => one.value !== "");
          // one number makes the others 0; none takes the key away
          if (filled.length === 0) notify(null);
          else notify(inputs.map((one) => (one.value === "" ? 0 : one.valueAsNumber)));
        });
      }
      return make("span", { class: "control numbers" }, ...inputs, ...unit);
    }
    case "texts": {
      const names = form.names === null ? [] : around.names(form.names);
      const chosen = new Set(Array.isArray(value) ? (value as readonly Json[]).map(String) : []);
      const boxes = names.map((one) => {
        const box = make("input", { type: "checkbox", value: one, checked: chosen.has(one) });
        box.addEventListener("change", () => {
          if (box.checked) chosen.add(one);
          else chosen.delete(one);
          notify(chosen.size === 0 ? null : [...chosen]);
        });
        return make("label", { class: "check" }, box, one);
      });
      return make("span", { class: "control checks", role: "group", "aria-label": name }, ...boxes);
    }
    case "text": {
      if (form.names !== null) {
        const ground = key === "parent" || key === "body" ? ["ground"] : [];
        const names = [...ground, ...around.names(form.names)];
        const known = typeof value === "string" ? value : "";
        return choice(name, known === "" || names.includes(known) ? names : [known, ...names], known, preset, notify);
      }
      const is_signal = field.part === "input" || field.part === "output";
      const input = make("input", { type: "text", "aria-label": name, placeholder: is_signal ? say("no signal") : "", value: typeof value === "string" ? value : "", ...(is_signal ? { list: "signals" } : {}) });
      input.addEventListener("change", () => notify(input.value.trim() === "" ? null : input.value.trim()));
      return make("span", { class: "control" }, input);
    }
  }
}

function choice(name: string, words: readonly string[], value: string, preset: string, notify: (word: string | null) => void): HTMLElement {
  const none = make("option", { value: "" }, preset === "" ? "–" : `${preset} (preset)`);
  const select = make("select", { "aria-label": name }, none, ...words.map((word) => make("option", { value: word, selected: word === value }, word)));
  select.addEventListener("change", () => notify(select.value === "" ? null : select.value));
  return make("span", { class: "control" }, select);
}
