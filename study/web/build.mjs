// SPDX-License-Identifier: MIT
// Builds the page: src/ -> dist/index.html, app.js, app.css.
import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import path from "node:path";
import { build } from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));
const source = (name) => path.join(here, "src", name);
const target = path.join(here, "dist");
const { version } = JSON.parse(await readFile(path.join(here, "package.json"), "utf8"));

await rm(target, { recursive: true, force: true });
await mkdir(target, { recursive: true });
await build({
  entryPoints: { app: source("main.ts"), "app-style": source("app.css") },
  outdir: target,
  entryNames: "[name]",
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome100", "firefox115", "safari16"],
  legalComments: "eof",
  define: { APP_VERSION: JSON.stringify(version) },
  logLevel: "warning",
});

// The address of each asset carries the hash of its bytes, so that no browser mixes two versions of the page.
let html = await readFile(source("index.html"), "utf8");
for (const [built, name] of [["app.js", "app.js"], ["app-style.css", "app.css"]]) {
  const bytes = await readFile(path.join(target, built));
  if (built !== name) await rm(path.join(target, built));
  await writeFile(path.join(target, name), bytes);
  const hash = createHash("sha256").update(bytes).digest("hex").slice(0, 12);
  html = html.replace(`/app/${name}`, `/app/${name}?v=${hash}`);
  console.log(`dist/${name}  ${(bytes.length / 1024).toFixed(1)} KiB`);
}
await writeFile(path.join(target, "index.html"), html);
