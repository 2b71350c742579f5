// What words of a PLC's source are, to be coloured: IEC 61131-3, ST and IL, and SCL's names in quotes.

export type WordKind = "key" | "say" | "text" | "number";

export interface Word {
  readonly from: number;
  readonly to: number;
  readonly kind: WordKind;
}

const KEYS = new Set(`PROGRAM END_PROGRAM FUNCTION END_FUNCTION FUNCTION_BLOCK END_FUNCTION_BLOCK METHOD END_METHOD PROPERTY END_PROPERTY INTERFACE
END_INTERFACE NAMESPACE END_NAMESPACE TYPE END_TYPE STRUCT END_STRUCT UNION END_UNION VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_GLOBAL VAR_EXTERNAL
VAR_TEMP VAR_CONFIG VAR_ACCESS VAR_INST VAR_STAT END_VAR CONSTANT RETAIN NON_RETAIN PERSISTENT AT IF THEN ELSIF ELSE END_IF CASE OF END_CASE FOR TO BY DO
END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT EXIT CONTINUE RETURN AND OR XOR NOT MOD ARRAY REF_TO POINTER REFERENCE EXTENDS IMPLEMENTS
CONFIGURATION END_CONFIGURATION RESOURCE ON END_RESOURCE TASK WITH BEGIN REGION END_REGION ORGANIZATION_BLOCK END_ORGANIZATION_BLOCK
INITIAL_STEP STEP END_STEP TRANSITION FROM END_TRANSITION ACTION END_ACTION BOOL BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT
REAL LREAL TIME LTIME DATE TOD DT STRING WSTRING THIS SUPER`.split(/\s+/));

/** Comments, strings, pragmas, literals with a type, numbers, words. */
const TOKEN = /\(\*[\s\S]*?(?:\*\)|$)|\/\*[\s\S]*?(?:\*\/|$)|\/\/[^\n]*|\{[^}\n]*\}|'(?:\$.|[^'$\n])*'?|"(?:\$.|[^"$\n])*"?|\b[A-Za-z_]\w*#[\w.:+-]*|\b\d[\w.#]*|[A-Za-z_]\w*/g;

/** The words of a source that have a colour, in order. */
export function words(text: string): readonly Word[] {
  return [...text.matchAll(TOKEN)].flatMap((match) => {
    const [word] = match;
    const kind = kind_of(word);
    return kind === null ? [] : [{ from: match.index, to: match.index + word.length, kind }];
  });
}

function kind_of(word: string): WordKind | null {
  const first = word[0] ?? "";
  if (/^(\(\*|\/\*|\/\/|\{)/.test(word)) return "say";
  if (first === "'" || first === '"') return "text";
  if (/\d/.test(first) || /^[A-Za-z_]\w*#/.test(word) || /^(TRUE|FALSE|NULL)$/i.test(word)) return "number";
  return KEYS.has(word.toUpperCase()) ? "key" : null;
}

/** The programs that a source declares. */
export function programs(text: string): readonly string[] {
  // What stands in a comment declares nothing.
  const bare = words(text).filter(({ kind }) => kind === "say").reduceRight((all, { from, to }) => all.slice(0, from) + all.slice(to), text);
  return [...bare.matchAll(/^\s*(?:PROGRAM|ORGANIZATION_BLOCK)\s+"?(\w+)/gim)].map((match) => match[1] as string);
}

/** The source that the sheet begins with: the program with the most variables, which is the machine's own; else the first. */
export function main_source(sources: readonly { readonly text: string }[], variables: readonly string[]): number {
  const counts = sources.map(({ text }) => {
    const mine = programs(text).map((name) => `${name}.`.toLowerCase());
    if (mine.length === 0) return -1;
    return variables.filter((path) => mine.some((name) => path.toLowerCase().startsWith(name))).length;
  });
  const most = Math.max(...counts);
  return most < 0 ? 0 : counts.indexOf(most);
}
