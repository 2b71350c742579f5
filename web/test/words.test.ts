import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import ts from "typescript";
import { filled, language_for, say } from "../src/say";
import { WORDS, type Text } from "../src/words";
import { de } from "../src/words/de";

/** All of the page's own code: not what is generated, nor the tables. */
function files(folder: string): string[] {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = `${folder}/${entry.name}`;
    if (entry.isDirectory()) return ["generated", "words"].includes(entry.name) ? [] : files(path);
    return path.endsWith(".ts") || path.endsWith(".html") ? [path] : [];
  });
}

/** Texts for programmers: errors of the protocol, shaders, the words of a programming language, keys of shapes. */
const FOR_PROGRAMMERS = new Set(["src/field.ts", "src/checks.ts", "src/session.ts", "src/edges.ts", "src/shot.ts", "src/highlight.ts", "src/shapes.ts"]);
/** Calls that take names of classes, selectors, keys and the like, and no texts. */
const NO_TEXT = /classList|querySelector|setProperty|getPropertyValue|matchMedia|addEventListener|removeEventListener|\bfail$|\bframe$|setAttribute$/;
/** Attributes that nobody reads. */
const ATTRIBUTES = new Set(["class", "style", "type", "role", "id", "for", "kind", "viewBox", "sort"]);
const KEYS = /^(Arrow(Left|Right|Up|Down)|Enter|Escape|Delete|Backspace|Shift|Page(Up|Down)|Home|End)$/;

/** Whether a text is for people: words with a blank between them, or one that begins with a capital. */
function isForPeople(text: string): boolean {
  if (KEYS.test(text) || /^(body plain|\d+px [\w-]+)$/.test(text)) return false;
  return /\p{L}{2,} \p{L}/u.test(text) || /^\p{Lu}\p{Ll}{2,}/u.test(text) || /§ \p{Ll}{3,}|\p{Ll}{3,}[:,]? §/u.test(text);
}

function literals(path: string): string[] {
  const source = ts.createSourceFile(path, readFileSync(path, "utf8"), ts.ScriptTarget.Latest, true);
  const found: string[] = [];
  const visit = (node: ts.Node): void => {
    if (ts.isImportDeclaration(node) || ts.isThrowStatement(node) || ts.isTypeNode(node)) return;
    if (ts.isPropertyAssignment(node) && ATTRIBUTES.has(node.name.getText().replaceAll('"', ""))) return;
    if (ts.isNewExpression(node) && /Error$/.test(node.expression.getText())) return;
    if (ts.isBinaryExpression(node) && /className|\.style\.|\.font$/.test(node.left.getText())) return;
    if (ts.isCallExpression(node)) {
      const called = node.expression.getText();
      if (/\bsay$/.test(called)) return void node.arguments.slice(1).forEach(visit);
      const isLabel = /setAttribute$/.test(called) && /aria-label|title|placeholder/.test(node.arguments[0]?.getText() ?? "");
      if (NO_TEXT.test(called) && !isLabel) return void node.arguments.filter((one) => !ts.isStringLiteralLike(one) && !ts.isTemplateExpression(one)).forEach(visit);
      // Sheets are called by the keys of the table.
      if (/\b(sheets\.add|tabs\?\.open)$/.test(called)) return void node.arguments.slice(1).forEach(visit);
    }
    const text = ts.isStringLiteralLike(node) ? node.text
      : ts.isTemplateExpression(node) ? [node.head.text, ...node.templateSpans.map((span) => span.literal.text)].join("§") : null;
    if (text !== null && isForPeople(text) && !(text in de)) {
      found.push(`${path}:${source.getLineAndCharacterOfPosition(node.getStart()).line + 1}: ${text}`);
    }
    ts.forEachChild(node, visit);
  };
  visit(source);
  return found;
}

test("no text stands outside of the table", () => {
  const code = files("src").filter((path) => path.endsWith(".ts") && !FOR_PROGRAMMERS.has(path));
  assert.deepEqual(code.flatMap(literals), []);
  for (const path of files("src").filter((one) => one.endsWith(".html"))) {
    const html = readFileSync(path, "utf8");
    const named = [...html.matchAll(/data-say(?:-\w+)?="([^"]*)"/g)].map((match) => match[1] ?? "");
    assert.deepEqual(named.filter((text) => !(text in de)), [], path);
    // What is written in an element is its own text, to be seen before the script has run.
    const written = [...html.matchAll(/<(\w+)([^>]*)>([^<\s][^<]*)</g)].filter(([, tag, more, text]) => tag !== "title" && /\p{L}{2}/u.test(text ?? "") && !(more ?? "").includes(`data-say="${text}"`));
    assert.deepEqual(written.map(([all]) => all).filter((all) => !all.includes("onescan")), [], path);
    assert.doesNotMatch(html, /aria-label="|placeholder="| title="/, path);
  }
});

test("each text of the table is used, and its parts are those of the English one", () => {
  const code = files("src").map((path) => readFileSync(path, "utf8")).join("\n");
  const isThere = (text: string): boolean => code.includes(JSON.stringify(text)) || new RegExp(`\\b${text.replace(/[^\w]/g, ".")}:|\\b(operator|trainer|pass|fail|open|complete|stopped|English)\\b`).test(text) || code.includes(`"${text}"`);
  assert.deepEqual(Object.keys(de).filter((text) => !isThere(text)), []);
  const parts = (text: string): string[] => [...text.matchAll(/\{\w+\}/g)].map(([part]) => part).sort();
  for (const [language, words] of Object.entries(WORDS)) {
    for (const [text, there] of Object.entries(words)) {
      assert.deepEqual(parts(there), parts(text), `${language}: ${text}`);
      assert.equal(there.startsWith(" "), text.startsWith(" "), `${language}: ${text}`);
    }
  }
});

test("the language is the one that was chosen, or the browser's first that there is", () => {
  assert.equal(language_for("de", ["en-GB"]), "de");
  assert.equal(language_for("tlh", ["de-AT", "en"]), "de");
  assert.equal(language_for(null, ["fr-FR", "de", "en"]), "de");
  assert.equal(language_for(null, ["fr-FR"]), "en");
});

test("parts are put where they are named", () => {
  assert.equal(say("{count} times", { count: 3 }), "3 times");
  assert.equal(filled("von {least} bis {most}, {other}", { least: 1, most: 2 }), "von 1 bis 2, {other}");
  const text: Text = "No alarm.";
  assert.equal(WORDS["de"]?.[text], "Kein Alarm.");
});
