// The package as it is packed and installed, and the examples of its README, word for word.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm, symlink, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";
import { MODELS, PACKAGE } from "./package.js";

const run = promisify(execFile);

test("installed in a fresh folder it does what its README says", async () => {
  const folder = await mkdtemp(join(tmpdir(), "pathwright-"));
  try {
    const { stdout } = await run("npm", ["pack", "--json", "--pack-destination", folder], { cwd: PACKAGE });
    const [{ filename, files }] = JSON.parse(stdout);
    assert.ok(files.some(({ path }) => path === "pathwright_bg.wasm") && files.some(({ path }) => path === "index.d.ts"));
    await writeFile(join(folder, "package.json"), '{ "private": true }');
    await run("npm", ["install", "--offline", "--no-audit", "--no-fund", join(folder, filename)], { cwd: folder });
    await symlink(MODELS, join(folder, "models"));
    const readme = await readFile(join(folder, "node_modules/pathwright/README.md"), "utf8");
    const examples = [...readme.matchAll(/^```js\n(.*?)^```$/gms)].map(([, code]) => code);
    assert.ok(examples.length >= 6);
    await writeFile(join(folder, "examples.mjs"), examples.join("\n"));
    const done = await run(process.execPath, ["examples.mjs"], { cwd: folder });
    assert.match(done.stdout, /settings layer.height/);
    assert.ok((await readFile(join(folder, "cube.gcode"))).length > 10_000);
  } finally {
    await rm(folder, { recursive: true });
  }
});
