// What the tests work with: the package as `cargo run -p xtask -- npm` has made it, the program, the bundled models.

import { fileURLToPath, pathToFileURL } from "node:url";
import { resolve } from "node:path";

const root = fileURLToPath(new URL("../../../", import.meta.url));
const target = resolve(root, process.env.CARGO_TARGET_DIR ?? "target");

export const PACKAGE = process.env.PATHWRIGHT_NPM ?? resolve(target, "npm");
export const PROGRAM = process.env.PATHWRIGHT ?? resolve(target, "debug/pathwright");
export const MODELS = resolve(root, "models");
export const ROOT = root;
export const pathwright = await import(pathToFileURL(resolve(PACKAGE, "index.js")));
