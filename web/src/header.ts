// The texts of the page's frame, and the choice of its language.

import { make } from "./dom";
import { choose_language, language, languages, say, type Text } from "./say";

/** Puts the frame into the reader's language: what `data-say` and `data-say-label` name. */
export function begin_words(): void {
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll<HTMLElement>("[data-say]")) element.textContent = say(element.dataset.say as Text);
  for (const element of document.querySelectorAll<HTMLElement>("[data-say-label]")) {
    element.setAttribute("aria-label", say(element.dataset.sayLabel as Text));
    if (element.tagName === "BUTTON") element.title = say(element.dataset.sayLabel as Text);
  }
  for (const element of document.querySelectorAll<HTMLElement>("[data-say-title]")) element.title = say(element.dataset.sayTitle as Text);
  const choice = make("select", { id: "language", "aria-label": say("Language"), title: say("Language") },
    ...languages().map(([name, own]) => make("option", { value: name, lang: name, selected: name === language }, own)));
  choice.addEventListener("change", () => choose_language(choice.value));
  document.getElementById("theme")?.before(choice);
}
