// Writes LICENCES.md: the packages whose code is in the bundle, with their licences.

import { readFile, writeFile } from "node:fs/promises";

const lock = JSON.parse(await readFile("package-lock.json", "utf8"));
const rows = Object.entries(lock.packages)
  .filter(([path, one]) => path !== "" && one.dev !== true)
  .map(([path, one]) => [path.replace(/^.*node_modules\//, ""), one.version, one.license])
  .sort((a, b) => (a[0] < b[0] ? -1 : 1));
for (const [name, , licence] of rows) if (licence === undefined) throw new Error(`the lock file has no licence of ${name}`);
const table = rows.map((row) => `| ${row.join(" | ")} |`).join("\n");
const text = `# Packages in the page\n\nGenerated from \`package-lock.json\` by \`npm run licences\`.\n\n| Package | Version | Licence |\n|---|---|---|\n${table}\n`;
if (process.argv.includes("--check")) {
  if ((await readFile("LICENCES.md", "utf8")) !== text) throw new Error("LICENCES.md is not that of the lock file: run `npm run licences`");
} else await writeFile("LICENCES.md", text);
