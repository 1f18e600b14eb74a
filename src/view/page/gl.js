// Draws a print with WebGL 2.

/** Corners of a stroke: (end ±1, side ±1) of the flat one; end, side, up and tip of the solid one. */
const FLAT_CORNERS = new Float32Array([-1, -1, 0, 0, 1, -1, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0]);
const SOLID_CORNERS = new Float32Array(
  [0, 1].flatMap((end) => [
    [end, -1, 0, 0], [end, 0, 1, 0], [end, 1, 0, 0], [end, 0, 0, 2 * end - 1],
  ]).flat(),
);
/** The two faces towards the eye, then the points at both ends. */
const SOLID_TRIANGLES = new Uint8Array([0, 1, 4, 1, 5, 4, 1, 2, 5, 2, 6, 5, 0, 1, 3, 1, 2, 3, 4, 5, 7, 5, 6, 7]);
/** With more strokes than this the points are left out. */
const FINE_STROKES = 200000, COARSE_TRIANGLES = 12;

/** Size of a mark, in CSS pixels: smaller from far away. */
const markPixels = (camera) => (camera instanceof FlatCamera ? Math.min(Math.max(1.2 / camera.mm, 5), 11) : 8);

class GlPainter {
  /** Throws where WebGL 2 is not to be had. */
  constructor(canvas, print) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("no WebGL 2");
    Object.assign(this, { canvas, gl, print });
    this.flat = this.program(FLAT_VERTEX, FLAT_FRAGMENT);
    this.solid = this.program(SOLID_VERTEX, SOLID_FRAGMENT);
    this.marks = this.program(MARK_VERTEX, MARK_FRAGMENT);
    this.lines = this.program(LINE_VERTEX, LINE_FRAGMENT);
    this.buffers = {
      flat: this.buffer(FLAT_CORNERS), solid: this.buffer(SOLID_CORNERS), points: this.buffer(print.points),
      role: this.buffer(print.role), bead: this.buffer(print.bead), value: this.buffer(new Float32Array(print.strokes)),
      markPoints: this.buffer(print.markPoints), markKind: this.buffer(print.markKind), grid: this.buffer(gridLines(print)),
    };
    this.triangles = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, SOLID_TRIANGLES, gl.STATIC_DRAW);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Takes up values of 0 to 1 for all strokes. */
  setValues(values) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffers.value);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, values, this.gl.STATIC_DRAW);
  }

  /**
   * Draws. `look`: mode, theme, colors, ramp, byValue, roleMask, markMask; `now`: layer, stroke (index of the one under
   * way), part (how much of it is done); `size`: CSS pixels and their ratio to device pixels.
   */
  draw(look, now, camera, size) {
    const { gl, canvas, print } = this, width = Math.round(size.width * size.ratio), height = Math.round(size.height * size.ratio);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(...rgb(look.theme.background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const first = print.first[now.layer], count = Math.min(now.stroke + 1, print.first[now.layer + 1]) - first;
    const solid = look.mode === "3d";
    const view = solid ? camera.matrix(size.width, size.height) : flatMatrix(camera, size);
    this.drawGrid(look, view.matrix, solid);
    if (solid) {
      gl.enable(gl.DEPTH_TEST);
      this.strokes(this.solid, look, view, now, 0, first + count, false, size, camera);
      this.strokes(this.solid, look, view, now, first, count, true, size, camera);
      gl.disable(gl.DEPTH_TEST);
    } else {
      gl.enable(gl.BLEND);
      this.strokes(this.flat, look, view, now, first, count, false, size, camera);
      this.strokes(this.flat, look, view, now, first, count, true, size, camera);
    }
    gl.enable(gl.BLEND);
    this.drawMarks(look, view.matrix, now, camera, size);
    gl.disable(gl.BLEND);
  }

  strokes(program, look, view, now, begin, count, travels, size, camera) {
    const { gl, buffers } = this, solid = program === this.solid;
    if (count <= 0) return;
    gl.useProgram(program.handle);
    const { at } = program;
    gl.uniform1i(at.mask, look.roleMask);
    gl.uniform1i(at.travels, travels ? 1 : 0);
    gl.uniform1i(at.last, now.stroke - begin);
    gl.uniform1f(at.part, now.part);
    gl.uniform1i(at.byValue, look.byValue ? 1 : 0);
    gl.uniform3fv(at["colors[0]"], look.colors);
    gl.uniform3fv(at["ramp[0]"], look.ramp);
    if (solid) {
      gl.uniformMatrix4fv(at.view, false, view.matrix);
      gl.uniform1f(at.thin, 0.0011 * camera.distance);
      gl.uniform1f(at.upside, camera.pitch < 0 ? -1 : 1);
      gl.uniform3fv(at["lights[0]"], lights(view));
    } else {
      gl.uniform4fv(at.view, view.flat);
      gl.uniform1f(at.pixel, camera.mm / size.ratio);
    }
    this.attribute(0, solid ? buffers.solid : buffers.flat, 4, 0, 0);
    this.attribute(1, buffers.points, 3, 12 * begin, 1);
    this.attribute(2, buffers.points, 3, 12 * (begin + 1), 1);
    this.attribute(3, buffers.role, 1, begin, 1, gl.UNSIGNED_BYTE, true);
    this.attribute(4, buffers.bead, 2, 4 * begin, 1, gl.UNSIGNED_SHORT);
    this.attribute(5, buffers.value, 1, 4 * begin, 1);
    if (solid) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
      const corners = count > FINE_STROKES ? COARSE_TRIANGLES : SOLID_TRIANGLES.length;
      gl.drawElementsInstanced(gl.TRIANGLES, corners, gl.UNSIGNED_BYTE, 0, count);
    } else {
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    }
  }

  drawMarks(look, matrix, now, camera, size) {
    const { gl, buffers, print } = this;
    const first = print.firstMark[now.layer], end = print.firstMark[now.layer + 1];
    const count = countBelow(print.markStroke, first, end, now.stroke + 1) - first;
    if (count <= 0 || !look.markMask) return;
    const { handle, at } = this.marks;
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, matrix);
    gl.uniform1i(at.mask, look.markMask);
    gl.uniform1f(at.size, markPixels(camera) * size.ratio);
    gl.uniform1f(at.lift, (0.75 * markPixels(camera)) / size.height);
    gl.uniform3fv(at["colors[0]"], look.markColors);
    gl.uniform3fv(at.rim, rgb(look.theme.background));
    this.attribute(0, buffers.markPoints, 3, 12 * first, 0);
    this.attribute(1, buffers.markKind, 1, first, 0, gl.UNSIGNED_BYTE, true);
    for (let i = 2; i < 6; i++) gl.disableVertexAttribArray(i);
    gl.drawArrays(gl.POINTS, 0, count);
  }

  drawGrid(look, matrix, solid) {
    const { gl, buffers } = this, { handle, at } = this.lines;
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, matrix);
    gl.uniform3fv(at.color, rgb(look.theme.bed));
    for (let i = 1; i < 6; i++) gl.disableVertexAttribArray(i);
    this.attribute(0, buffers.grid, 3, 0, 0);
    if (solid) gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.LINES, 0, this.print.gridPoints);
    gl.disable(gl.DEPTH_TEST);
  }

  attribute(place, buffer, components, offset, divisor, type = this.gl.FLOAT, integer = false) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    if (integer) gl.vertexAttribIPointer(place, components, type, 0, offset);
    else gl.vertexAttribPointer(place, components, type, false, 0, offset);
    gl.vertexAttribDivisor(place, divisor);
  }

  buffer(data) {
    const { gl } = this, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return buffer;
  }

  program(vertex, fragment) {
    const { gl } = this, handle = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(handle, shader);
    }
    gl.linkProgram(handle);
    if (!gl.getProgramParameter(handle, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getProgramInfoLog(handle) || "shaders");
    }
    const at = {};
    for (let i = gl.getProgramParameter(handle, gl.ACTIVE_UNIFORMS) - 1; i >= 0; i--) {
      const { name } = gl.getActiveUniform(handle, i);
      at[name] = gl.getUniformLocation(handle, name);
    }
    return { handle, at };
  }
}

/** The lights' directions, upper left and right, as seen by the eye. */
function lights({ right, up, back }) {
  return [[-0.45, 0.65, 0.6], [0.7, 0.1, 0.4]].flatMap((light) => {
    const length = Math.hypot(...light);
    return [0, 1, 2].map((i) => (right[i] * light[0] + up[i] * light[1] + back[i] * light[2]) / length);
  });
}

/** The view from above, as a matrix and as scale and shift. */
function flatMatrix(camera, size) {
  const sx = 2 / (camera.mm * size.width), sy = 2 / (camera.mm * size.height), [mx, my] = camera.middle;
  const flat = [sx, sy, -mx * sx, -my * sy];
  return { flat, matrix: new Float32Array([sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 0, 0, flat[2], flat[3], 0, 1]) };
}

/** Lines on the bed around a print, every 10 mm, or wider apart where that would be too many. */
function gridLines(print) {
  const [x0, y0, x1, y1] = print.bounds, step = 10 ** Math.max(1, Math.ceil(Math.log10(Math.max(x1 - x0, y1 - y0) / 40)));
  const down = (v) => (Math.floor(v / step) - 1) * step, up = (v) => (Math.ceil(v / step) + 1) * step;
  const [left, right, low, high] = [down(x0), up(x1), down(y0), up(y1)], lines = [];
  for (let x = left; x <= right; x += step) lines.push(x, low, 0, x, high, 0);
  for (let y = low; y <= high; y += step) lines.push(left, y, 0, right, y, 0);
  print.gridPoints = lines.length / 3;
  return new Float32Array(lines);
}

/** How far a sorted array stays below a value, between two places. */
function countBelow(array, from, to, value) {
  while (from < to) {
    const middle = (from + to) >> 1;
    if (array[middle] < value) from = middle + 1;
    else to = middle;
  }
  return from;
}
