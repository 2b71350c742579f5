// The languages of the page beside English. A new one is a file as `de.ts` and its line here.

import { de } from "./de";

/** A text of the page, in English. */
export type Text = keyof typeof de;

/** What each text is in a language. */
export type Words = Readonly<Record<Text, string>>;

export const WORDS: Readonly<Record<string, Words>> = { de };

/** What a word is in a language, if it is a text of the page. */
export function own_words(words: Words | undefined, word: string): string {
  return word in de ? words?.[word as Text] ?? word : word;
}
