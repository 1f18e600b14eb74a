// The module is divided: prints need its first part only.

import assert from "node:assert/strict";
import { cp, mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { MODELS, PACKAGE } from "./package.js";

const cube = await readFile(join(MODELS, "calibration_cube.stl"));

for (const threads of [1, 2]) {
  test(`a print in ${threads} thread(s) loads nothing of the rest, a comparison does`, async () => {
    const folder = await mkdtemp(join(tmpdir(), "pathwright-"));
    try {
      await cp(PACKAGE, folder, { recursive: true, filter: (path) => !path.endsWith("_rest.wasm") });
      const { compare, slice } = await import(pathToFileURL(join(folder, "index.js")));
      assert.ok((await slice(cube, { threads })).gcode.length);
      await assert.rejects(compare(cube, { threads }), /_rest\.wasm/);
    } finally {
      await rm(folder, { recursive: true });
    }
  });
}
