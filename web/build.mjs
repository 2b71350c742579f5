// Bundles the page into `dist`, or with `--tests` its tests into `build/test`.
import { build } from "esbuild";
import { copyFile, mkdir, readdir, rm } from "node:fs/promises";

if (process.argv.includes("--tests")) {
  await rm("build/test", { recursive: true, force: true });
  const tests = (await readdir("test")).filter((name) => name.endsWith(".test.ts"));
  await build({
    entryPoints: tests.map((name) => `test/${name}`),
    outdir: "build/test",
    outExtension: { ".js": ".mjs" },
    bundle: true,
    format: "esm",
    platform: "node",
    target: "node20",
    external: ["node:*", "typescript"],
  });
} else {
  await rm("dist", { recursive: true, force: true });
  await mkdir("dist", { recursive: true });
  await build({
    entryPoints: { page: "src/main.ts", edit: "src/construct/main.ts", report: "src/report/main.ts" },
    outdir: "dist",
    bundle: true,
    minify: true,
    format: "esm",
    target: ["chrome110", "firefox110", "safari16"],
    legalComments: "none",
    loader: { ".css": "css" },
  });
  await copyFile("src/index.html", "dist/index.html");
  await copyFile("src/construct/edit.html", "dist/edit.html");
}
