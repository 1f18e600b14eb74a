// What the package promises: each call, its errors, its end.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { MODELS, pathwright } from "./package.js";

const { PathwrightError, check, compare, convert, layers, order, profiles, reorder, schema, slice, time, version } = pathwright;
const cube = await readFile(join(MODELS, "calibration_cube.stl"));
const pins = await readFile(join(MODELS, "pin_forest.stl"));
const rejected = (kind) => (error) => error instanceof PathwrightError && error.kind === kind && error.message.length > 10;

test("a print has its file, its figures and its warnings", async () => {
  const seen = [];
  const { gcode, summary, warnings } = await slice(cube, { onProgress: (done, of) => seen.push([done, of]) });
  assert.match(new TextDecoder().decode(gcode.subarray(0, 200)), /^;/);
  assert.deepEqual(summary.size_mm, [20, 20, 20]);
  assert.equal(summary.layers.length, summary.layer_count);
  assert.ok(Array.isArray(warnings));
  assert.deepEqual(seen.at(-1), [summary.layer_count, summary.layer_count]);
});

test("layers come one by one, before the print", async () => {
  const stream = layers(cube, { settings: { "skirt.loops": 1 } }), seen = [];
  for (;;) {
    const { value, done } = await stream.next();
    if (done) {
      assert.equal(value.summary.layer_count, seen.length);
      break;
    }
    seen.push(value);
  }
  assert.deepEqual(seen.map((layer) => layer.index), [...seen.keys()]);
  const path = seen[1].paths.find(({ role }) => /perimeter/i.test(role));
  assert.equal(path.points.length, 3 * path.widths.length);
  assert.ok(Math.abs(path.points[2] - seen[1].z) < 1e-9 && path.widths.every((width) => width > 0.1));
});

test("who wants no more layers ends the slicing", async () => {
  for await (const layer of layers(cube)) if (layer.index === 2) break;
});

test("calls at the same time have workers of their own and the same results", async () => {
  const prints = await Promise.all([1, 2, 3].map(() => slice(cube)));
  assert.ok(prints.every(({ gcode }) => Buffer.from(gcode).equals(prints[0].gcode)));
});

test("models stand on one plate as they are told to", async () => {
  const files = [{ name: "a.stl", bytes: cube }, { name: "b.stl", bytes: pins }];
  const models = [{ file: "a.stl", at_mm: [60, 60, 0], rotate_deg: [0, 0, 45] }, { file: "b.stl", at_mm: [150, 150, 0], settings: { "walls.count": 4 } }];
  const { summary } = await slice(files, { models });
  assert.deepEqual(summary.models, ["a.stl", "b.stl"]);
  assert.ok(summary.size_mm[0] > 90);
});

test("binary G-code is written where it is wanted", async () => {
  const { gcode } = await slice(cube, { binary: true });
  assert.equal(new TextDecoder().decode(gcode.subarray(0, 4)), "GCDE");
});

test("a run ends when its signal is given, soon, and the next one goes on", async () => {
  const stop = new AbortController(), begun = slice(pins, { settings: { "layer.height": 0.06 }, signal: stop.signal, onProgress: () => stop.abort() });
  await assert.rejects(begun, { name: "AbortError" });
  await assert.rejects(slice(cube, { signal: AbortSignal.abort() }), { name: "AbortError" });
  assert.ok((await slice(cube)).gcode.length);
});

test("errors say what kind they are and where", async () => {
  await assert.rejects(slice(new TextEncoder().encode("solid nothing")), rejected("input"));
  await assert.rejects(slice(cube, { settings: { "layer.height": 90 } }), (error) => rejected("settings")(error) && error.key === "layer.height");
  await assert.rejects(slice(cube, { models: [{ file: "model", scale: [90, 90, 90] }] }), rejected("does_not_fit"));
  await assert.rejects(slice(cube, { infill: 1 }), rejected("usage"));
  await assert.rejects(slice(cube, { threads: 0 }), rejected("usage"));
  await assert.rejects(slice(17), rejected("usage"));
  await assert.rejects(compare(cube, { strategies: ["luck"] }), rejected("usage"));
  await assert.rejects(check("no G-code at all"), rejected("input"));
  await assert.rejects(order([[[0, 0], [1, 1]]], { effort: "none" }), rejected("usage"));
});

test("strategies are compared", async () => {
  const rows = await compare(cube, { strategies: ["nearest", "optimized"], certify: true });
  const shortest = await compare(cube, { strategies: ["optimized"], settings: { "order.cost": "length" } });
  assert.equal(rows[1].link_mm, shortest[0].link_mm, "lengths are what is compared");
  assert.deepEqual(rows.map(({ strategy }) => strategy), ["nearest", "optimized"]);
  assert.ok(rows[1].link_mm <= rows[0].link_mm && rows[1].bound_mm <= rows[1].link_mm + 1e-6);
});

test("finished G-code is reordered, checked and timed", async () => {
  const { gcode } = await slice(pins, { settings: { "order.strategy": "as-sliced" } });
  const { gcode: shorter, report } = await reorder(gcode);
  assert.ok(report.after.travel_mm < report.before.travel_mm && shorter.length);
  assert.equal((await check(shorter, { against: { name: "pins.stl", bytes: pins } })).errors, 0);
  assert.ok((await time(shorter)).total_s > 60);
});

test("polylines are ordered", async () => {
  const line = (y) => [[0, y], [50, y]];
  const { order: sequence, length_mm, bound_mm } = await order([line(0), line(2), line(1)], { certify: true });
  assert.equal(length_mm, 2);
  assert.ok(bound_mm <= 2 && sequence.length === 3 && sequence[1] === 2);
});

test("what can be set is listed", async () => {
  assert.ok((await schema()).groups.some(({ name }) => name === "infill"));
  assert.ok((await profiles()).some(({ name }) => name === "petg"));
  assert.match(await convert("my.ini", "layer_height = 0.3\n"), /height = 0.3/);
  assert.match(await version(), /^\d+\.\d+\.\d+$/);
});
