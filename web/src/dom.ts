// Elements of the page.

import { breakable } from "./format";

const SVG = "http://www.w3.org/2000/svg";

type Attributes = Readonly<Record<string, string | boolean>>;

/** An element with attributes and what is in it; `true` sets an attribute without a value, `false` leaves it out. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...inside: readonly (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(name, "");
    else if (value !== false) element.setAttribute(name, value);
  }
  element.append(...inside);
  return element;
}

/** An element of a drawing. */
export function draw<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Readonly<Record<string, string | number>>,
  ...inside: readonly (Node | string)[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...inside);
  return element;
}

/** A name that is broken between its parts only. */
export function broken(name: string): readonly (Node | string)[] {
  return breakable(name).flatMap((part, at) => (at === 0 ? [part] : [document.createElement("wbr"), part]));
}

/** The element of the page's frame with this id. */
export function frame(id: string): HTMLElement {
  const element = document.getElementById(id);
  if (element === null) throw new Error(`index.html has no element \`${id}\``);
  return element;
}

/** A button that says what it does. */
export function button(label: string, press: () => void, title = label): HTMLButtonElement {
  const element = make("button", { type: "button", title }, label);
  element.addEventListener("click", press);
  return element;
}
