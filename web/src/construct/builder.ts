// The machine is built here: what can be placed, what is placed, the keys of what is chosen.

import { say, type Text } from "../say";
import { broken, button, make } from "../dom";
import { Bench } from "./bench";
import { fieldset, type Surroundings } from "./form";
import { GROUPS, group_of, picture_of } from "./pictures";
import type { Client, Edit, EditState, FieldInfo, Finding, Given, Json, Library, SceneState, Sort, Table } from "./protocol";
import { free } from "./snap";

/** Things that are often placed, with what makes them so. */
const PLACES: readonly { readonly name: string; readonly about: string; readonly sort: Sort; readonly keys: Readonly<Record<string, Given>> }[] = [
  { name: "belt", about: say("a surface that a conveyor runs"), sort: "body", keys: { kind: "kinematic", shape: "box", size_m: [2, 0.3, 0.1], position_m: [0, 0, -0.05], friction: 0.8 } },
  { name: "box", about: say("a body that forces move; `box[0..3]` are four"), sort: "body", keys: { kind: "dynamic", shape: "box", size_m: [0.1, 0.1, 0.1], position_m: [0, 0, 0.05], mass_kg: 0.5, friction: 0.4 } },
  { name: "table", about: say("a body that stays"), sort: "body", keys: { kind: "fixed", shape: "box", size_m: [0.4, 0.4, 0.4], position_m: [0, 0, 0.2] } },
  { name: "zone", about: say("a room that only sources, sinks and sensors see"), sort: "body", keys: { kind: "fixed", shape: "box", size_m: [0.3, 0.3, 0.1], position_m: [0, 0, 0.05], collides: false } },
  { name: "roller", about: say("a body that is round"), sort: "body", keys: { kind: "dynamic", shape: "cylinder", radius_m: 0.05, length_m: 0.2, position_m: [0, 0, 0.1], mass_kg: 1 } },
  { name: "slide", about: say("a joint along an axis"), sort: "joint", keys: { kind: "prismatic", parent: "ground", axis: [1, 0, 0] } },
  { name: "hinge", about: say("a joint about an axis"), sort: "joint", keys: { kind: "revolute", parent: "ground", axis: [0, 0, 1] } },
];

/** The keys that most things of a sort have; the others are folded away. */
const MAIN: Readonly<Record<string, readonly string[]>> = {
  body: ["kind", "shape", "size_m", "radius_m", "length_m", "position_m", "mass_kg"],
  joint: ["kind", "parent", "child", "axis", "anchor_m"],
};

/** What is chosen: a table, or one that is about to be added. */
type Chosen = { readonly sort: Sort; readonly name: string; readonly draft: Map<string, Given> | null };

export class Builder {
  private readonly palette = make("nav", { class: "palette", "aria-label": say("What can be placed") });
  private readonly filter = make("input", { type: "search", class: "filter", placeholder: say("Filter"), "aria-label": say("Filter what can be placed") });
  private readonly shelf = make("div", { class: "shelf" });
  private readonly tree = make("div", { class: "tree" });
  private readonly inspector = make("div", { class: "inspector", role: "region", "aria-label": say("What is chosen") });
  private readonly scenes = make("select", { "aria-label": say("Scene") });
  private readonly signals = make("datalist", { id: "signals" });
  readonly bench: Bench;
  private state: EditState | null = null;
  private chosen: Chosen | null = null;

  constructor(
    place: HTMLElement,
    private readonly library: Library,
    private readonly change: (edits: readonly Edit[]) => Promise<boolean>,
  ) {
    const canvas = make("div", { class: "canvas" });
    const tools = make("div", { class: "toolbar bench-tools", role: "toolbar", "aria-label": say("View") });
    const stage = make("section", { class: "stage", "aria-label": say("Machine") }, canvas, tools);
    place.append(make("div", { class: "left" }, this.filter, this.palette), stage,
      make("div", { class: "right" }, this.scenes, make("h2", { class: "tree-title" }, say("In the scene")), this.tree, this.inspector), this.signals);
    this.palette.append(this.shelf);
    this.bench = new Bench(canvas, (body) => this.choose(body === null ? null : { sort: "body", name: body, draft: null }), (body, position_m) => {
      const scene = this.scene();
      if (scene !== null) void this.change([{ do: "move", scene: scene.file, body, position_m }]);
    });
    const grid = make("select", { "aria-label": say("Grid") }, ...[["0.1", "100 mm"], ["0.05", "50 mm"], ["0.01", "10 mm"], ["0.005", "5 mm"], ["0", say("no grid")]].map(([value, text]) => make("option", { value: value ?? "", selected: value === "0.05" }, text ?? "")));
    grid.addEventListener("change", () => (this.bench.grid_m = Number(grid.value)));
    tools.append(button(say("Whole machine"), () => this.bench.home()), make("label", {}, say("Grid"), grid));
    this.filter.addEventListener("input", () => this.stock());
    this.scenes.addEventListener("change", () => {
      this.chosen = null;
      this.paint();
    });
    this.stock();
  }

  show(state: EditState): void {
    this.state = state;
    const chosen = this.scenes.value;
    this.scenes.replaceChildren(...state.scenes.map((scene) => make("option", { value: scene.file, selected: scene.file === chosen }, scene.file)));
    this.scenes.hidden = state.scenes.length < 2;
    this.signals.replaceChildren(...state.signals.map((signal) => make("option", { value: signal })));
    if (this.chosen !== null && this.chosen.draft === null && this.table() === null) this.chosen = null;
    this.paint();
  }

  private scene(): SceneState | null {
    return this.state?.scenes.find((scene) => scene.file === this.scenes.value) ?? this.state?.scenes[0] ?? null;
  }

  private client(): Client | null {
    return this.state?.clients.find((client) => client.scene === this.scene()?.file) ?? null;
  }

  private table(): Table | null {
    const chosen = this.chosen;
    if (chosen === null) return null;
    return this.scene()?.tables.find((table) => table.sort === chosen.sort && table.name === chosen.name) ?? null;
  }

  private names(sort: string): readonly string[] {
    return (this.scene()?.tables ?? []).filter((table) => table.sort === sort).map((table) => table.name);
  }

  private choose(chosen: Chosen | null): void {
    this.chosen = chosen;
    this.paint();
  }

  private paint(): void {
    const scene = this.scene();
    if (scene === null) {
      this.inspector.replaceChildren(make("p", { class: "empty" }, say("The scenario has no plant with a scene.")));
      return;
    }
    this.bench.show(scene);
    this.bench.warn(new Set(scene.tables.filter((table) => this.found(scene.file, table).some((one) => one.is_error)).flatMap((table) => this.body_of(table) ?? (table.sort === "body" ? table.name : []))));
    this.bench.mark(this.chosen?.sort === "body" ? this.chosen.name : this.body_of(this.table()));
    this.list(scene);
    this.inspect();
  }

  /** The body that a thing is about, to show where it is. */
  private body_of(table: Table | null): string | null {
    if (table === null) return null;
    for (const key of ["belt", "body", "child"]) {
      const name = table.keys.get(key);
      if (typeof name === "string") return name;
    }
    const joint = this.scene()?.tables.find((one) => one.sort === "joint" && one.name === table.keys.get("joint"));
    return joint === undefined ? null : this.body_of(joint);
  }

  /** What can be placed. */
  private stock(): void {
    const wanted = this.filter.value.trim().toLowerCase();
    const has = (...texts: readonly string[]): boolean => texts.some((text) => text.toLowerCase().includes(wanted));
    const places = PLACES.filter((place) => has(place.name, place.about, place.sort)).map((place) =>
      this.ware(place.name, place.about, () => this.draft(place.sort, place.name, new Map(Object.entries(place.keys)))));
    const kinds = (title: Text | null): readonly HTMLElement[] => this.library.kinds.filter((kind) => group_of(kind.name) === title && has(kind.name.replaceAll("_", " "), kind.about)).map((kind) =>
      this.ware(kind.name, kind.about, () => this.draft("component", kind.name, new Map([["kind", kind.name]]))));
    const group = (title: string, wares: readonly HTMLElement[]): readonly HTMLElement[] =>
      wares.length === 0 ? [] : [make("h2", {}, title), make("div", { class: "wares" }, ...wares)];
    const [first, ...others] = GROUPS;
    const all = [
      ...group(say(first?.title ?? "Bodies and joints"), places),
      ...others.flatMap(({ title }) => group(say(title), kinds(title))), ...group(say("Your own"), kinds(null)),
    ];
    this.shelf.replaceChildren(...(all.length > 0 ? all : [make("p", { class: "empty" }, say("Nothing is called so."))]));
  }

  private ware(kind: string, about: string, press: () => void): HTMLElement {
    const name = kind.replaceAll("_", " ");
    const ware = make("button", { type: "button", class: "ware", title: about, "aria-label": say("Place {name}", { name }) }, picture_of(kind), make("span", { lang: "en" }, ...broken(name)));
    ware.addEventListener("click", press);
    return ware;
  }

  /** What the check finds in a table: of the findings of its file, those between its line and the next table's; and those of its signals. */
  private found(file: string, table: Table): readonly Finding[] {
    const next = Math.min(...(this.scene()?.tables ?? []).map((one) => one.line).filter((line) => line > table.line));
    const signals = [...table.keys].flatMap(([key, value]) => (key.endsWith("_signal") && typeof value === "string" ? [value] : []));
    return (this.state?.findings ?? []).filter((one) => {
      const isHere = one.file !== null && one.line !== null && is_same_file(one.file, file) && one.line >= table.line && one.line < next;
      return isHere || signals.some((signal) => one.message.startsWith(`${signal} `) || one.message.includes(`\`${signal}\``));
    });
  }

  private draft(sort: Sort, name: string, keys: Map<string, Given>): void {
    const others = this.names(sort);
    if (sort === "component") {
      // what there is only one of is what is meant
      for (const field of this.fields(sort, keys.get("kind") ?? null)) {
        const names = field.form.kind === "text" && field.form.names !== null ? this.names(field.form.names) : [];
        if (field.needed && names.length === 1 && names[0] !== undefined) keys.set(field.key, names[0]);
        if (field.needed && field.form.kind === "numbers") keys.set(field.key, field.key === "direction" ? [1, 0, 0] : [0, 0, 0]);
      }
    }
    this.choose({ sort, name: free(name, others), draft: keys });
    this.inspector.querySelector("input")?.select();
  }

  private list(scene: SceneState): void {
    const items = scene.tables.map((table) => {
      const kind = table.keys.get("kind");
      const is_chosen = this.chosen?.sort === table.sort && this.chosen.name === table.name && this.chosen.draft === null;
      const item = make("button", { type: "button", class: "item", "aria-pressed": String(is_chosen) }, make("span", {}, table.name), make("span", { class: "kind" }, typeof kind === "string" && table.sort === "component" ? kind.replaceAll("_", " ") : table.sort));
      const found = this.found(scene.file, table);
      if (found.length > 0) {
        item.classList.add(found.some((one) => one.is_error) ? "wrong" : "warned");
        item.append(make("span", { class: "mark", title: found.map((one) => one.message).join("\n") }, "⚠"));
      }
      item.addEventListener("click", () => this.choose({ sort: table.sort, name: table.name, draft: null }));
      return item;
    });
    this.tree.replaceChildren(...(items.length > 0 ? items : [make("p", { class: "empty" }, say("Nothing yet: place a body first."))]));
  }

  private fields(sort: Sort, kind: Json | Given): readonly FieldInfo[] {
    if (sort === "component") return this.library.kinds.find((one) => one.name === kind)?.fields ?? [];
    const main = MAIN[sort] ?? [];
    const rank = (field: FieldInfo): number => (main.includes(field.key) ? main.indexOf(field.key) : main.length);
    return [...(this.library.sorts.find((one) => one.sort === sort)?.fields ?? [])].sort((one, other) => rank(one) - rank(other));
  }

  private around(): Surroundings {
    return { names: (sort) => this.names(sort) };
  }

  /** Which keys are shown at once: of a body, the measures of its shape. */
  private main(sort: Sort, shape: Json | Given): ((field: FieldInfo) => boolean) | null {
    const keys = MAIN[sort];
    const off = shape === "box" ? ["radius_m", "length_m"] : shape === "sphere" ? ["size_m", "length_m"] : ["size_m"];
    return keys === undefined ? null : (field) => keys.includes(field.key) && !off.includes(field.key);
  }

  private inspect(): void {
    const chosen = this.chosen;
    if (chosen === null) {
      this.inspector.replaceChildren(make("p", { class: "empty" }, say("Place something from the left, or choose it in the machine. A chosen body is dragged, with Shift up and down.")));
    } else if (chosen.draft !== null) this.inspector.replaceChildren(...this.adding(chosen, chosen.draft));
    else this.inspector.replaceChildren(...this.changing(chosen, this.table()));
  }

  private adding(chosen: Chosen, draft: Map<string, Given>): readonly HTMLElement[] {
    const name = make("input", { type: "text", "aria-label": say("Name"), value: chosen.name });
    const kind = draft.get("kind") ?? null;
    const fields = this.fields(chosen.sort, kind);
    const form = fieldset(fields, new Map(draft) as ReadonlyMap<string, Json>, this.around(), (key, value) => {
      if (value === null) draft.delete(key);
      else draft.set(key, value);
    }, this.main(chosen.sort, draft.get("shape") ?? null));
    const add = button(say("Add"), () => void this.add(chosen.sort, name.value.trim(), fields, draft));
    add.classList.add("main-action");
    return [
      make("h2", {}, say("New {kind}", { kind: chosen.sort === "component" ? String(kind).replaceAll("_", " ") : chosen.sort })),
      make("div", { class: "field" }, make("span", { class: "field-name" }, "name"), make("span", { class: "control" }, name)),
      form,
      make("div", { class: "actions" }, add, button(say("Cancel"), () => this.choose(null))),
    ];
  }

  private async add(sort: Sort, name: string, fields: readonly FieldInfo[], draft: ReadonlyMap<string, Given>): Promise<void> {
    const scene = this.scene();
    if (scene === null) return;
    // in the order of the form, the kind first
    const order = ["kind", ...fields.map((field) => field.key).filter((key) => key !== "kind")];
    const keys = order.flatMap((key): [string, Given][] => {
      const value = draft.get(key);
      return value === undefined ? [] : [[key, value]];
    });
    const declared = keys.flatMap(([key, value]) => this.declaration(sort, draft.get("kind") ?? null, key, value, keys));
    const done = await this.change([{ do: "add", scene: scene.file, sort, name, keys }, ...declared]);
    if (done) this.choose({ sort, name, draft: null });
  }

  /** The signal of an input or an output, if the session has none of this name. */
  private declaration(sort: Sort, kind: Json | Given, key: string, value: Given | null, keys: readonly (readonly [string, Given | Json])[]): readonly Edit[] {
    if (sort !== "component" || typeof value !== "string") return [];
    const field = this.fields(sort, kind).find((one) => one.key === key);
    const type = this.library.kinds.find((one) => one.name === kind)?.types.get(key);
    if (field === undefined || type === undefined) return [];
    if (this.state?.signals.includes(value) ?? false) return [];
    const plant = this.client();
    const clients = this.state?.clients ?? [];
    const others = ["soft-plc", "gateway", "operator", "external", "opc-ua"].flatMap((one) => clients.filter((client) => client.kind === one));
    const writer = field.part === "output" ? plant : (others[0] ?? null);
    if (writer === null) return [];
    const is_real = keys.some(([one, given]) => one === "signal_type" && given === "REAL");
    return [{ do: "declare", signal: value, type: type === "LREAL" && is_real ? "REAL" : type, writer: writer.name }];
  }

  private changing(chosen: Chosen, table: Table | null): readonly HTMLElement[] {
    const scene = this.scene();
    if (table === null || scene === null) return [];
    const [sort, file] = [chosen.sort, scene.file];
    const name = make("input", { type: "text", "aria-label": say("Name"), value: table.name });
    name.addEventListener("change", () => {
      const to = name.value.trim();
      void this.change([{ do: "rename", scene: file, sort, name: table.name, to }]).then((done) => this.choose({ sort, name: done ? to : table.name, draft: null }));
    });
    const kind = table.keys.get("kind") ?? null;
    const fields = this.fields(sort, kind).filter((field) => !(sort === "component" && field.key === "kind"));
    const form = fieldset(fields, table.keys, this.around(), (key, value) => {
      const declared = this.declaration(sort, kind, key, value, [...table.keys]);
      void this.change([{ do: "set", scene: file, sort, name: table.name, key, value }, ...declared]).then((done) => {
        if (!done) this.paint();
      });
    }, this.main(sort, table.keys.get("shape") ?? null));
    const remove = button(say("Delete"), () => void this.change([{ do: "remove", scene: file, sort, name: table.name }]));
    return [
      make("h2", {}, sort === "component" && typeof kind === "string" ? kind.replaceAll("_", " ") : sort),
      make("div", { class: "field" }, make("span", { class: "field-name" }, "name"), make("span", { class: "control" }, name)),
      make("p", { class: "where" }, `${file}:${table.line}`),
      ...this.found(file, table).map((one) => make("p", { class: one.is_error ? "found wrong" : "found" }, one.message, ...(one.help === null ? [] : [make("span", { class: "help" }, ` ${one.help}`)]))),
      form,
      make("div", { class: "actions" }, remove),
    ];
  }
}

/** Whether a finding's file is the scene's: the check names it from where it was called. */
function is_same_file(found: string, file: string): boolean {
  return found === file || found.endsWith(`/${file}`);
}
