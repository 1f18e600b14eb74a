// Calls what the page and programs call as a rule, in a module that marks the functions that are called, and writes the marks:
// node marks.mjs MODULE.js MODULE.wasm MODELS MARKS COUNT

import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker, isMainThread, parentPort, workerData } from "node:worker_threads";

/** What each model is sliced with: profiles, settings, how it stands. */
const PRINTS = [
  {},
  { profiles: ["prusa-i3", "petg"], settings: { "support.enabled": "true", "support.style": "tree", "infill.pattern": "gyroid" } },
  { profiles: ["delta-round", "abs", "0.3mm"], settings: { "infill.pattern": "concentric", "seam.position": "aligned" } },
  { profiles: ["corexy-klipper", "speed"], settings: { "support.enabled": "true", "infill.pattern": "adaptive-cubic", "brim.width": "3" } },
  { stands: { rotate_deg: [33, 21, 10] } },
  { stands: { scale: [0.37, 0.37, 0.37] } },
  { stands: { rotate_deg: [0, 0, 27], scale: [1.7, 1.3, 0.9] } },
];

/** What all of them on one plate are sliced with. */
const TOGETHER = { settings: { "plate.arrange": "true" }, stands: { rotate_deg: [40, 15, 5], scale: [0.6, 0.6, 0.6] } };

const [script, file, folder, out, count] = process.argv.slice(2);

if (isMainThread) {
  const module = new WebAssembly.Module(readFileSync(file));
  const names = readdirSync(folder).filter((name) => !name.endsWith(".md"));
  const models = names.map((name) => ({ name, bytes: readFileSync(join(folder, name)) }));
  const work = [
    { models },
    ...models.map((model) => ({ models: [model], prints: PRINTS })),
    { models, prints: [TOGETHER] },
    ...made().map((model) => ({ models: [model], prints: [{}] })),
  ];
  const marks = new Uint8Array(Number(count));
  // An instance for each: some things are done by whatever needs them first.
  for (const one of work) {
    const worker = new Worker(new URL(import.meta.url), { argv: process.argv.slice(2), workerData: { module, ...one } });
    const found = await new Promise((done, fail) => worker.once("message", done).once("error", fail));
    found.forEach((mark, i) => { if (mark === 1) marks[i] = 1; });
    await worker.terminate();
  }
  writeFileSync(out, marks);
} else {
  const wasm = await import(pathToFileURL(script));
  const { module, memory, models, prints } = workerData;
  if (memory) {
    wasm.initSync({ module, memory });
    parentPort.postMessage("here");
    wasm.help();
  }
  let marked = wasm.initSync({ module }).memory;
  wasm.listen(() => {});
  if (!prints) plate(wasm, models);
  if (wasm.share) {
    marked = await shared(wasm, module);
    if (!prints) plate(wasm, models);
  }
  for (const print of prints ?? []) slice(wasm, models, print);
  parentPort.postMessage(new Uint8Array(marked.buffer).slice(0, Number(count)));
}

/** Divides all that follows among two threads; their memory. */
async function shared(wasm, module) {
  const memory = wasm.share(2);
  const worker = new Worker(new URL(import.meta.url), { argv: process.argv.slice(2), workerData: { module, memory } });
  await new Promise((here) => worker.once("message", here));
  return memory;
}

/** What the page does with models: one after the other, with the first print's settings changed once. */
function plate(wasm, models) {
  wasm.version();
  wasm.schema();
  wasm.profiles();
  const presets = new wasm.Presets([], new Uint32Array(), new Uint8Array());
  for (const { name, bytes } of models) {
    const session = new wasm.Session();
    session.set_presets(presets);
    session.add(name, bytes);
    session.mesh(name, 0);
    const project = JSON.parse(session.arrange(JSON.stringify({ models: [{ file: name }] })));
    for (const change of [{}, { "infill.density": "20 %" }]) {
      const revision = session.set_project(JSON.stringify({ ...project, settings: change }));
      while (session.step()) wasm.tell_waiting();
      session.preview(revision);
      session.gcode(revision);
    }
    session.free();
  }
  presets.free();
}

/** What the npm package does with models. */
function slice(wasm, files, { stands = {}, ...project }) {
  const models = new wasm.Models();
  for (const { name, bytes } of files) models.add(name, bytes);
  const placed = files.map(({ name }) => ({ file: name, ...stands }));
  const print = models.slice(JSON.stringify({ ...project, models: placed, allow_floating: true }), true);
  wasm.tell_waiting();
  print.gcode(false);
  print.summary();
  print.warnings();
  print.free();
  models.free();
}

/** Models that go through each other, and round ones. */
function made() {
  const pairs = [[12, 3, 6], [20, 4, 2], [9, 5, 8]].map(([p, q, apart]) => [...ball(15, 2, p, q, 0), ...ball(15, 2, q, p, apart)]);
  return [...pairs, ball(20, 3, 7, 9, 0), ball(25, 9, 5, 6, 0), ball(18, 1, 40, 31, 0)].map((triangles, i) => ({ name: `${i}.stl`, bytes: stl(triangles) }));
}

/** The triangles of a ball with p by q waves, of some height, on its surface. */
function ball(radius, height, p, q, x) {
  const [around, up] = [200, 100];
  const at = (i, j) => {
    const [u, v] = [(2 * Math.PI * (i % around)) / around, (Math.PI * j) / up];
    const r = radius + height * Math.sin(p * u) * Math.sin(q * v);
    return [x + r * Math.sin(v) * Math.cos(u), r * Math.sin(v) * Math.sin(u), -r * Math.cos(v)];
  };
  const triangles = [];
  for (let j = 0; j < up; j++) {
    for (let i = 0; i < around; i++) {
      if (j > 0) triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
      if (j < up - 1) triangles.push([at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
    }
  }
  return triangles;
}

function stl(triangles) {
  const bytes = new DataView(new ArrayBuffer(84 + 50 * triangles.length));
  bytes.setUint32(80, triangles.length, true);
  triangles.forEach((corners, i) => corners.flat().forEach((value, k) => bytes.setFloat32(96 + 50 * i + 4 * k, value, true)));
  return new Uint8Array(bytes.buffer);
}
