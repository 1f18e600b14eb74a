// Draws a print with WebGL 2.

/** Pixels drawn for one of the window, along each side: smoother than the card's own antialiasing, and cheaper in software. */
const OVERSAMPLING = 2;
/** Strokes that any card draws at a time, how long such a time may be, and how long nothing moves before more is drawn. */
const FIRST_BUDGET = 30000, SLICE_MS = 40, REST_MS = 120;

/** Beads have points at their ends where a pixel is smaller than this. */
const POINTED_MM = 0.12;

/** Size of a mark, in CSS pixels: smaller from far away. */
const markPixels = (camera) => (camera instanceof FlatCamera ? Math.min(Math.max(0.9 / camera.mm, 5), 10) : 8);

class GlPainter {
  /** Throws where WebGL 2 is not to be had. */
  constructor(canvas, print) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
    if (!gl) throw new Error("no WebGL 2");
    Object.assign(this, { canvas, gl, budget: FIRST_BUDGET, work: null });
    this.flat = program(gl, FLAT_VERTEX, FLAT_FRAGMENT);
    this.solid = program(gl, SOLID_VERTEX, SOLID_FRAGMENT);
    this.marks = program(gl, MARK_VERTEX, MARK_FRAGMENT);
    this.lines = program(gl, LINE_VERTEX, LINE_FRAGMENT);
    this.flatShape = new StrokeShape(gl, FLAT_CORNERS, FLAT_TRIANGLES, FLAT_AT_ONCE);
    this.solidShape = new StrokeShape(gl, SOLID_CORNERS, SOLID_TRIANGLES, SOLID_AT_ONCE);
    this.farShape = new StrokeShape(gl, SOLID_CORNERS, SOLID_FACES, SOLID_AT_ONCE);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const steps = this.prepare(print);
    let step = steps.next();
    while (!step.done) step = steps.next();
    this.show(step.value);
  }

  /** Brings a print to the card in steps, which nobody notices; what comes out in the end can be shown. */
  *prepare(print) {
    const strokes = new StrokeTexture(this.gl, print);
    yield* strokes.upload();
    let few = null;
    if (print.few) {
      few = { print: print.few, strokes: new StrokeTexture(this.gl, print.few) };
      yield* few.strokes.upload();
    }
    const buffers = {
      markPoints: this.buffer(print.markPoints), markKind: this.buffer(print.markKind), grid: this.buffer(gridLines(print)),
    };
    return { print, strokes, few, buffers };
  }

  /** From now on this print is drawn. */
  show(prepared) {
    this.stop();
    this.strokes?.free();
    this.few?.strokes.free();
    for (const buffer of Object.values(this.buffers ?? {})) this.gl.deleteBuffer(buffer);
    Object.assign(this, prepared, { values: null });
  }

  /** Takes up values of 0 to 1 for all strokes. */
  setValues(values) {
    this.values = values;
    this.strokes.setValues(values);
    this.few?.strokes.setValues(values, this.few.print.source);
  }

  /** The layers below at a glance. */
  glance() {
    if (!this.few) {
      const [x0, y0, x1, y1] = this.print.bounds, print = glance(this.print, Math.hypot(x1 - x0, y1 - y0) / 300);
      this.few = { print, strokes: new StrokeTexture(this.gl, print) };
      for (const _ of this.few.strokes.upload());
      if (this.values) this.few.strokes.setValues(this.values, print.source);
    }
    return this.few;
  }

  /**
   * Draws. `look`: mode, theme, colors, ramp, byValue, roleMask, markMask, glance (no more than that); `now`: layer, stroke (index of the one being
   * drawn), part (how much of it is done); `size`: CSS pixels and their ratio to device pixels. A print of more strokes
   * than the card draws at a time is drawn at a glance first, and with all of them while nothing moves.
   */
  draw(look, now, camera, size) {
    const { gl, canvas, print } = this, width = Math.round(size.width * size.ratio), height = Math.round(size.height * size.ratio);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.stop();
    const solid = look.mode === "3d", view = solid ? camera.matrix(size.width, size.height) : flatMatrix(camera, size);
    const begin = print.first[now.layer], end = Math.min(now.stroke + 1, print.first[now.layer + 1]);
    const frame = { look, now, camera, size, view, solid, begin, end };
    this.drawGround(frame);
    if (solid && begin > this.budget) {
      const few = this.glance();
      this.drawStrokes(frame, few.strokes, 0, few.print.first[now.layer], false);
      if (!look.glance) this.refine(frame);
    } else if (solid) {
      this.drawStrokes(frame, this.strokes, 0, begin, false);
    }
    this.drawOver(frame);
  }

  /** Background, grid, and the layer. */
  drawGround(frame) {
    const { gl, canvas } = this, { look, view, solid, begin, end } = frame;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...rgb(look.theme.background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawGrid(look, view.matrix, solid);
    this.drawStrokes(frame, this.strokes, begin, end, false);
  }

  /** Travels and marks. */
  drawOver(frame) {
    const { look, view, now, camera, size, begin, end } = frame;
    this.drawStrokes(frame, this.strokes, begin, end, true);
    this.drawMarks(look, view.matrix, now, camera, size);
  }

  /** Draws all strokes once nothing has moved for a while, as many at a time as the card is quick at, and shows them then. */
  refine(frame) {
    const { gl, canvas } = this, work = (this.work = { timer: 0 });
    let fence = null, begun = 0, rest = frame.begin;
    const step = () => {
      if (this.work !== work || gl.isContextLost()) return;
      if (fence) {
        if (gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED) return requestAnimationFrame(step);
        gl.deleteSync(fence);
        const took = Math.max(performance.now() - begun, 1);
        this.budget = Math.max(this.budget * Math.min(SLICE_MS / took, 2), FIRST_BUDGET);
      }
      begun = performance.now();
      this.aside();
      if (rest === frame.begin) this.drawGround(frame);
      const begin = Math.max(rest - Math.round(this.budget), 0);
      this.drawStrokes(frame, this.strokes, begin, rest, false);
      rest = begin;
      if (!rest) {
        this.drawOver(frame);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
        gl.blitFramebuffer(0, 0, canvas.width, canvas.height, 0, 0, canvas.width, canvas.height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
        this.work = null;
      }
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      if (!rest) return;
      fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      requestAnimationFrame(step);
    };
    work.timer = setTimeout(() => requestAnimationFrame(step), REST_MS);
  }

  /** What is drawn next goes to a picture aside, as large as the canvas. */
  aside() {
    const { gl, canvas } = this;
    this.picture ??= { frame: gl.createFramebuffer(), buffers: [gl.createRenderbuffer(), gl.createRenderbuffer()], width: 0, height: 0 };
    const { picture } = this, formats = [gl.RGBA8, gl.DEPTH_COMPONENT24], places = [gl.COLOR_ATTACHMENT0, gl.DEPTH_ATTACHMENT];
    gl.bindFramebuffer(gl.FRAMEBUFFER, picture.frame);
    if (picture.width === canvas.width && picture.height === canvas.height) return;
    [picture.width, picture.height] = [canvas.width, canvas.height];
    picture.buffers.forEach((buffer, i) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, formats[i], canvas.width, canvas.height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, places[i], gl.RENDERBUFFER, buffer);
    });
  }

  /** What is drawn in rest is out of date. */
  stop() {
    if (!this.work) return;
    clearTimeout(this.work.timer);
    this.work = null;
  }

  /** Strokes of a texture, or the travels among them. What is above is drawn first, since it hides what is below. */
  drawStrokes({ look, now, camera, size, view, solid }, strokes, begin, end, travels) {
    const { gl } = this, { handle, at } = solid ? this.solid : this.flat, pixel = camera.pixel(size.height);
    if (begin >= end || (travels && !((look.roleMask >> TRAVEL) & 1))) return;
    gl.useProgram(handle);
    gl.uniform1i(at.strokes, 0);
    gl.uniform1i(at.values, 1);
    gl.uniform1i(at.mask, look.roleMask);
    gl.uniform1i(at.travels, travels ? 1 : 0);
    gl.uniform1i(at.last, strokes === this.strokes ? now.stroke : -1);
    gl.uniform1f(at.part, now.part);
    gl.uniform1i(at.byValue, look.byValue ? 1 : 0);
    gl.uniform3fv(at["colors[0]"], look.colors);
    gl.uniform3fv(at["ramp[0]"], look.ramp);
    if (solid) {
      gl.uniformMatrix4fv(at.view, false, view.matrix);
      gl.uniform1f(at.thin, 0.8 * pixel);
      gl.uniform1f(at.pixel, pixel);
      gl.uniform3fv(at.back, view.back);
      gl.uniform1f(at.upside, camera.pitch < 0 ? -1 : 1);
      gl.uniform3fv(at["lights[0]"], lights(view));
    } else {
      gl.uniform4fv(at.view, view.flat);
      gl.uniform1f(at.pixel, pixel / size.ratio);
      gl.uniform1f(at.hair, 0.8 * pixel);
    }
    const near = pixel < POINTED_MM, shape = !solid ? this.flatShape : near ? this.solidShape : this.farShape, needed = solid ? gl.DEPTH_TEST : gl.BLEND;
    strokes.bind();
    shape.bind();
    gl.enable(needed);
    shape.draw(at.first, begin, end, solid && camera.pitch > 0);
    gl.disable(needed);
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
    this.attribute(0, buffers.markPoints, 3, 12 * first);
    this.attribute(1, buffers.markKind, 1, first, gl.UNSIGNED_BYTE, true);
    gl.enable(gl.BLEND);
    gl.drawArrays(gl.POINTS, 0, count);
    gl.disable(gl.BLEND);
  }

  drawGrid(look, matrix, solid) {
    const { gl, buffers } = this, { handle, at } = this.lines;
    gl.useProgram(handle);
    gl.uniformMatrix4fv(at.view, false, matrix);
    gl.uniform3fv(at.color, rgb(look.theme.bed));
    gl.disableVertexAttribArray(1);
    this.attribute(0, buffers.grid, 3, 0);
    if (solid) gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.LINES, 0, this.print.gridPoints);
    gl.disable(gl.DEPTH_TEST);
  }

  attribute(place, buffer, components, offset, type = this.gl.FLOAT, integer = false) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    if (integer) gl.vertexAttribIPointer(place, components, type, 0, offset);
    else gl.vertexAttribPointer(place, components, type, false, 0, offset);
  }

  buffer(data) {
    const { gl } = this, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    return buffer;
  }
}

/** A program of two shaders: its handle, and where its uniforms are. */
function program(gl, vertex, fragment) {
  const handle = gl.createProgram();
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

/** Lines on the bed, or around a print whose bed is not known, every 10 mm, or wider apart where that would be too many. */
function gridLines(print) {
  const [x0, y0, x1, y1] = print.bed ?? print.bounds, step = 10 ** Math.max(1, Math.ceil(Math.log10(Math.max(x1 - x0, y1 - y0) / 40)));
  const lines = [], line = (from, to) => lines.push(...from, 0, ...to, 0);
  if (print.bed) {
    for (let x = Math.ceil(x0 / step) * step; x <= x1; x += step) line([x, y0], [x, y1]);
    for (let y = Math.ceil(y0 / step) * step; y <= y1; y += step) line([x0, y], [x1, y]);
    for (const [a, b] of [[[x0, y0], [x1, y0]], [[x1, y0], [x1, y1]], [[x1, y1], [x0, y1]], [[x0, y1], [x0, y0]]]) line(a, b);
    print.gridPoints = lines.length / 3;
    return new Float32Array(lines);
  }
  const down = (v) => (Math.floor(v / step) - 1) * step, up = (v) => (Math.ceil(v / step) + 1) * step;
  const [left, right, low, high] = [down(x0), up(x1), down(y0), up(y1)];
  for (let x = left; x <= right; x += step) line([x, low], [x, high]);
  for (let y = low; y <= high; y += step) line([left, y], [right, y]);
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
