// Draws the plate with WebGL 2.

import { lights, program, rgb } from "../view.js";
import { COLOR_FRAGMENT, LINE_VERTEX, MESH_FRAGMENT, MESH_VERTEX, WIDE_VERTEX } from "./shaders.js";

const AXIS_COLORS = { light: ["#d2303a", "#1b8a40", "#2a6be0"], dark: ["#ff6b74", "#4cd07d", "#6ea8ff"] };
const LOOKS = {
  light: { back: "#eef1f4", bed: "#fbfcfd", grid: "#d9dfe4", rim: "#7d8a95", part: "#93a9bd", selected: "#f2a33c", bad: "#d8434c", worse: "#c1121f", face: "#1f7ae0" },
  dark: { back: "#14181c", bed: "#1d2429", grid: "#313a42", rim: "#788691", part: "#7f97ab", selected: "#f0a445", bad: "#e2545c", worse: "#ff6b74", face: "#4fb3ff" },
};
const ROLE_COLORS = { support_enforcer: "#3aa76d", support_blocker: "#d8434c" };

export class PlatePainter {
  /** Throws where WebGL 2 is not to be had. */
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("no WebGL 2");
    Object.assign(this, { canvas, gl, meshes: new Map(), bed: null });
    this.mesh = program(gl, MESH_VERTEX, MESH_FRAGMENT);
    this.line = program(gl, LINE_VERTEX, COLOR_FRAGMENT);
    this.wide = program(gl, WIDE_VERTEX, COLOR_FRAGMENT);
    this.scratch = gl.createBuffer();
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** `scene`: instances, bed, selected (indices), handles, hot (a handle), faces, hotFace; `theme`: light or dark. */
  draw(scene, camera, size, theme) {
    const { gl, canvas } = this, width = Math.round(size.width * size.ratio), height = Math.round(size.height * size.ratio);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const look = LOOKS[theme], view = camera.matrix(size.width, size.height);
    this.frame = { look, view, size, theme };
    gl.viewport(0, 0, width, height);
    gl.clearColor(...rgb(look.back), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    this.drawBed(scene.bed, camera.pitch > 0);
    const solid = (instance) => instance.role === "part";
    for (const instance of scene.instances.filter(solid)) this.drawInstance(instance, scene, 1);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const instance of scene.instances.filter((i) => !solid(i))) this.drawInstance(instance, scene, 0.45);
    for (const [i, face] of (scene.faces ?? []).entries()) this.drawFace(face, i === scene.hotFace);
    gl.depthMask(true);
    gl.disable(gl.DEPTH_TEST);
    for (const handle of scene.handles) this.drawHandle(handle, handle.axis === scene.hot);
    gl.disable(gl.BLEND);
    this.sweep(scene.instances);
  }

  drawBed(bed, above) {
    if (!bed) return;
    const { gl } = this, { look, view } = this.frame;
    if (this.bed?.of !== bed) this.bed = { of: bed, ...this.bedBuffers(bed) };
    // Lines lie on the bed and models on them: the bed yields.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 2);
    gl.enable(gl.BLEND);
    if (!above) gl.depthMask(false);
    this.plain(this.bed.fill, gl.TRIANGLE_FAN, look.bed, above ? 1 : 0.35);
    gl.depthMask(true);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    this.plain(this.bed.grid, gl.LINES, look.grid, 1);
    this.plain(this.bed.volume, gl.LINES, look.rim, 0.35);
    gl.disable(gl.BLEND);
    this.strip(this.bed.rim, look.rim, 1.2);
    const [x, y] = bed.origin_mm, reach = 0.08 * Math.max(...bed.size_mm);
    AXIS_COLORS[this.frame.theme].forEach((color, axis) => {
      const tip = [x, y, 0.05];
      tip[axis] += reach;
      this.strip([[x, y, 0.05], tip], color, 1.6);
    });
    return view;
  }

  bedBuffers({ outline, origin_mm: [x0, y0], size_mm: [w, h], height_mm: top, shape }) {
    const fill = outline.flatMap(([x, y]) => [x, y, 0]), grid = [], volume = [];
    const inside = (along, at) => {
      if (shape !== "circle") return along ? [y0, y0 + h] : [x0, x0 + w];
      const [middle, other, radius] = along ? [x0 + w / 2, y0 + h / 2, w / 2] : [y0 + h / 2, x0 + w / 2, h / 2];
      const half = Math.sqrt(Math.max(radius ** 2 - (at - middle) ** 2, 0));
      return [other - half, other + half];
    };
    const step = Math.max(w, h) > 600 ? 50 : 10, first = (v) => Math.ceil(v / step) * step;
    for (let x = first(x0); x <= x0 + w; x += step) {
      const [a, b] = inside(true, x);
      grid.push(x, a, 0, x, b, 0);
    }
    for (let y = first(y0); y <= y0 + h; y += step) {
      const [a, b] = inside(false, y);
      grid.push(a, y, 0, b, y, 0);
    }
    outline.forEach(([x, y], i) => {
      const [u, v] = outline[(i + 1) % outline.length];
      volume.push(x, y, top, u, v, top);
      if (outline.length <= 12 || i % Math.ceil(outline.length / 4) === 0) volume.push(x, y, 0, x, y, top);
    });
    const rim = [...outline, outline[0]].map(([x, y]) => [x, y, 0.02]);
    return { fill: new Float32Array(fill), grid: new Float32Array(grid), volume: new Float32Array(volume), rim };
  }

  drawInstance(instance, { selected }, alpha) {
    const { gl } = this, { look, view } = this.frame, { handle, at } = this.mesh;
    const chosen = selected.has(instance.index), part = instance.role === "part";
    const color = !instance.fits ? (chosen ? look.worse : look.bad) : chosen ? look.selected : part ? look.part : ROLE_COLORS[instance.role];
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, view.matrix);
    gl.uniformMatrix3fv(at.rows, true, instance.rows.flat());
    gl.uniform3fv(at.eye, view.eye);
    gl.uniform3fv(at["lights[0]"], lights(view));
    gl.uniform3fv(at.below, rgb(part ? look.worse : color));
    gl.uniform4f(at.color, ...rgb(color), alpha);
    for (const { mesh, shift } of instance.parts) {
      const buffers = this.upload(mesh);
      gl.uniform3fv(at.shift, shift);
      gl.bindVertexArray(buffers.array);
      gl.drawElements(gl.TRIANGLES, mesh.triangles.length, gl.UNSIGNED_INT, 0);
    }
    gl.bindVertexArray(null);
  }

  upload(mesh) {
    const { gl } = this;
    let buffers = this.meshes.get(mesh);
    if (buffers) return buffers;
    buffers = { array: gl.createVertexArray(), vertices: gl.createBuffer(), triangles: gl.createBuffer() };
    gl.bindVertexArray(buffers.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.vertices);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.vertices, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    this.meshes.set(mesh, buffers);
    return buffers;
  }

  /** Lets go of meshes that are no longer on the plate. */
  sweep(instances) {
    const { gl } = this, used = new Set(instances.flatMap((i) => i.parts.map((part) => part.mesh)));
    for (const [mesh, { array, vertices, triangles }] of this.meshes) {
      if (used.has(mesh)) continue;
      gl.deleteVertexArray(array);
      for (const buffer of [vertices, triangles]) gl.deleteBuffer(buffer);
      this.meshes.delete(mesh);
    }
  }

  drawFace({ points }, hot) {
    const { gl } = this, { look } = this.frame;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-2, -4);
    this.plain(new Float32Array(points.flat()), gl.TRIANGLE_FAN, look.face, hot ? 0.8 : 0.3);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    this.strip([...points, points[0]], look.face, hot ? 2 : 1);
  }

  drawHandle({ axis, points, tip }, hot) {
    const { look, theme } = this.frame, color = axis < 3 ? AXIS_COLORS[theme][axis] : look.face;
    this.strip(points, color, hot ? 3.4 : 2);
    if (tip) this.strip([toward(points[1], points[0], 0.12), points[1]], color, hot ? 7 : 5);
  }

  /** Points as they are: thin lines, or a fan. */
  plain(points, kind, color, alpha) {
    const { gl } = this, { handle, at } = this.line;
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, this.frame.view.matrix);
    gl.uniform4f(at.color, ...rgb(color), alpha);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
    gl.bufferData(gl.ARRAY_BUFFER, points, gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(kind, 0, points.length / 3);
  }

  /** A line through points, so many CSS pixels to each side. */
  strip(points, color, width) {
    const { gl } = this, { handle, at } = this.wide, { size, view } = this.frame, data = [];
    for (let i = 1; i < points.length; i++) {
      const [a, b] = [points[i - 1], points[i]];
      for (const [p, q, side] of [[a, b, 1], [a, b, -1], [b, a, 1], [a, b, 1], [b, a, 1], [b, a, -1]]) data.push(...p, ...q, side);
    }
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, view.matrix);
    gl.uniform2f(at.window, size.width, size.height);
    gl.uniform1f(at.width, width);
    gl.uniform4f(at.color, ...rgb(color), 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.STREAM_DRAW);
    for (const [place, count, offset] of [[0, 3, 0], [1, 3, 12], [2, 1, 24]]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 28, offset);
    }
    gl.drawArrays(gl.TRIANGLES, 0, data.length / 7);
    for (const place of [1, 2]) gl.disableVertexAttribArray(place);
  }
}

const toward = (a, b, share) => a.map((v, i) => v + (b[i] - v) * share);
