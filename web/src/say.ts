// The page's own texts in the language of its reader. In the code they are English; a language is a table in `words/`.

import { own_words, WORDS, type Text } from "./words";

export type { Text } from "./words";

const KEY = "onescan-language";

/** What the viewer has chosen; where nothing can be kept, nobody has. */
function kept(): string | null {
  try {
    return globalThis.localStorage?.getItem(KEY) ?? null;
  } catch {
    return null;
  }
}

/** The language for somebody who has chosen `chosen`, or whose browser prefers `preferred`, in this order. */
export function language_for(chosen: string | null, preferred: readonly string[]): string {
  const known = (name: string): boolean => name === "en" || name in WORDS;
  if (chosen !== null && known(chosen)) return chosen;
  return preferred.map((one) => one.split("-")[0] ?? "").find(known) ?? "en";
}

/** The language of this page. It is read again with a new language. */
export const language = typeof document === "undefined" ? "en" : language_for(kept(), navigator.languages);

/** The languages that there are, each by its own name. */
export function languages(): readonly (readonly [string, string])[] {
  return [["en", "English"], ...Object.keys(WORDS).map((name) => [name, WORDS[name]?.["English"] ?? name] as const)];
}

/** Reads the page again in another language, which is remembered. */
export function choose_language(name: string): void {
  window.localStorage.setItem(KEY, name);
  window.location.reload();
}

/** A text with its parts: `{name}` stands for one. */
export function filled(text: string, parts: Readonly<Record<string, string | number>>): string {
  return text.replace(/\{(\w+)\}/g, (hole, name: string) => String(parts[name] ?? hole));
}

/** A text of the page. */
export function say(text: Text, parts: Readonly<Record<string, string | number>> = {}): string {
  return filled(WORDS[language]?.[text] ?? text, parts);
}

/** A word that somebody else has given: a text of the page where it is one. */
export function say_word(word: string): string {
  return own_words(WORDS[language], word);
}

let translations: ReadonlyMap<string, string> = new Map();

/** Takes the scenario's translations of its own texts. */
export function translate(all: ReadonlyMap<string, ReadonlyMap<string, string>>): void {
  translations = all.get(language) ?? new Map();
}

/** A text of the scenario, in the language of the page where the scenario has it. */
export function own(text: string): string {
  return translations.get(text) ?? text;
}
