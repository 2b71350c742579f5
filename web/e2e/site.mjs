// The documents' site in a browser: a word is searched and its page found, at both widths, in both themes, offline.
// `docs/site/make`, then `node e2e/site.mjs BOOK [FOLDER]`; FOLDER takes the pictures.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { extname, join, normalize } from "node:path";
import axe from "axe-core";
import { chromium } from "playwright-core";

const [book, folder = null] = process.argv.slice(2);
const KINDS = {
  ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".png": "image/png",
  ".txt": "text/plain; charset=utf-8", ".json": "application/json", ".woff2": "font/woff2",
};

const server = createServer(async (request, response) => {
  const path = decodeURIComponent(new URL(request.url, "http://site").pathname);
  const file = join(book, normalize(path.endsWith("/") ? `${path}index.html` : path));
  try {
    const bytes = await readFile(file);
    response.writeHead(200, { "content-type": KINDS[extname(file)] ?? "application/octet-stream" }).end(bytes);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const site = `http://127.0.0.1:${server.address().port}`;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"],
});

async function open(path, width, colorScheme) {
  const page = await browser.newPage({ viewport: { width, height: 860 }, colorScheme });
  page.wrong = [];
  page.on("pageerror", (error) => page.wrong.push(String(error)));
  page.on("request", (request) => {
    if (!request.url().startsWith(site) && !request.url().startsWith("data:")) page.wrong.push(`loads ${request.url()}`);
  });
  page.on("response", (response) => {
    if (response.status() >= 400) page.wrong.push(`${response.status()} ${response.url()}`);
  });
  await page.goto(site + path);
  return page;
}

async function shoot(page, name) {
  if (folder !== null) await page.screenshot({ path: join(folder, `${name}.png`) });
}

/** Searches words as a reader does, and gives where the first results lead. */
async function searched(page, words) {
  const bar = page.locator("#mdbook-searchbar");
  if (!(await bar.isVisible())) await page.keyboard.press("s");
  await bar.waitFor();
  await bar.clear();
  await bar.pressSequentially(words);
  await page.locator("#mdbook-searchresults-header", { hasText: `'${words}'` }).waitFor();
  const results = page.locator("#mdbook-searchresults li a");
  return results.evaluateAll((links) => links.map((link) => link.getAttribute("href")));
}

/** Nothing of a page stands out of the window to the right. */
async function fits(page, what) {
  const over = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
  assert.ok(over <= 0, `${what} is ${over} px too wide`);
}

/** What is written can be read, and links are seen to be links. mdBook's own frame has findings of other kinds. */
async function can_be_read(page, what) {
  await page.evaluate(axe.source);
  const rules = ["color-contrast", "link-in-text-block", "image-alt", "heading-order", "document-title", "html-has-lang"];
  const { violations } = await page.evaluate((only) => window.axe.run(document, { runOnly: only }), rules);
  assert.deepEqual(violations.map((rule) => `${rule.id}: ${rule.nodes[0].html}`), [], what);
}

try {
  const wide = await open("/docs/index.html", 1280, "light");
  const parts = await wide.locator("nav .part-title").allInnerTexts();
  assert.deepEqual(parts.slice(0, 4), ["Tutorials", "How-to guides", "Reference", "Explanation"]);
  await fits(wide, "the index");
  await shoot(wide, "site-wide");
  await can_be_read(wide, "the index, light");
  for (const [words, wanted] of [["minimise", /docs\/minimise\.html/], ["twincat ci tutorial", /tutorials\/ci\.html/],
    ["light_barrier", /component\/index\.html/], ["N0101", /codes\/N0101\.html/]]) {
    const found = (await searched(wide, words)).slice(0, 10);
    assert.ok(found.some((link) => wanted.test(link)), `${words}: ${found.join(" ")}`);
    if (words === "minimise") await shoot(wide, "site-search");
  }
  const hit = wide.locator("#mdbook-searchresults li a").first();
  await hit.click();
  await wide.waitForLoadState();
  assert.match(wide.url(), /N0101/);
  assert.deepEqual(wide.wrong, []);

  const narrow = await open("/docs/tutorials/cell.html", 390, "dark");
  await fits(narrow, "a tutorial on a phone");
  await shoot(narrow, "site-narrow");
  await can_be_read(narrow, "a tutorial, dark");
  await narrow.locator("main img:visible").nth(1).scrollIntoViewIfNeeded();
  await shoot(narrow, "site-narrow-picture");
  assert.deepEqual(narrow.wrong, []);
  const light = await open("/docs/tutorials/cell.html", 1280, "light");
  await light.locator("main img:visible").nth(1).scrollIntoViewIfNeeded();
  await shoot(light, "site-picture");
  assert.deepEqual(light.wrong, []);
  console.log("site: searched, followed, read at two widths");
} finally {
  await browser.close();
  server.close();
}
