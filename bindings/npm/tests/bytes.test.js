// The modules write the bytes of the program: every bundled model with four profiles, in one thread and in two.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { promisify } from "node:util";
import { MODELS, pathwright, PROGRAM } from "./package.js";

const PROFILES = [
  [],
  ["prusa-i3", "petg"],
  ["delta-round", "abs", "0.3mm"],
  ["corexy-klipper", "speed"],
];
/** What each is sliced with besides, so that more than the defaults is compared. */
const SETTINGS = [{}, { "support.enabled": true, "support.style": "tree", "infill.pattern": "gyroid" }, { "infill.pattern": "concentric", "seam.position": "aligned" }, { "support.enabled": true, "infill.pattern": "adaptive-cubic", "brim.width": 3 }];

const run = promisify(execFile);
const names = (await readdir(MODELS)).filter((name) => !name.endsWith(".md")).sort();

test("there are twelve models", () => assert.equal(names.length, 12));

for (const name of names) {
  test(`${name}: four profiles give the program's bytes`, async () => {
    const folder = await mkdtemp(join(tmpdir(), "pathwright-"));
    const bytes = await readFile(join(MODELS, name));
    try {
      for (const [index, profiles] of PROFILES.entries()) {
        const settings = SETTINGS[index], out = join(folder, `${index}.gcode`);
        const options = [...profiles.flatMap((profile) => ["--profile", profile]), ...Object.entries(settings).flatMap(([key, value]) => ["--set", `${key}=${value}`])];
        await run(PROGRAM, ["slice", join(MODELS, name), "-o", out, "--threads", "2", "--allow-floating", "--quiet", ...options]);
        for (const threads of [1, 2]) {
          const { gcode } = await pathwright.slice({ name, bytes }, { profiles, settings, threads, allowFloating: true });
          assert.ok((await readFile(out)).equals(gcode), `${name}, ${profiles.join(" + ") || "default"}, threads: ${threads}`);
        }
      }
    } finally {
      await rm(folder, { recursive: true });
    }
  });
}
