// Makes bundle/page.js and bundle/page.css from src/; --check says whether those that are checked in are current.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const result = await build({
  absWorkingDir: here,
  entryPoints: ["src/page.ts", "src/page.css"],
  outdir: "bundle",
  bundle: true,
  minify: true,
  charset: "ascii",
  format: "iife",
  target: ["es2020"],
  legalComments: "none",
  write: false,
});
const check = process.argv.includes("--check");
await mkdir(join(here, "bundle"), { recursive: true });
for (const { path, text } of result.outputFiles) {
  if (/<\/(script|style)|\)bundle"/i.test(text)) throw new Error(`${path} would end the element that holds it`);
  const there = await readFile(path, "utf8").catch(() => "");
  if (there === text) continue;
  if (check) {
    console.error(`${path} is not what src/ gives: run 'npm run build' in ${here}`);
    process.exitCode = 1;
  } else {
    await writeFile(path, text);
  }
}
