// Strokes where shaders find them: one texel each. Plain triangles that fetch their stroke are faster than instances of
// so few corners, in software many times over.

/** As in the shaders. */
const TEXELS = 2048;
/** So many strokes go into one call, since indices have 16 bits. */
const FLAT_AT_ONCE = 16384, SOLID_AT_ONCE = 8192;

/** Corners of a stroke: end ±1 and side ±1 of the flat one; end, side, up and tip of the solid one. */
const FLAT_CORNERS = [[-1, -1, 0, 0], [1, -1, 0, 0], [-1, 1, 0, 0], [1, 1, 0, 0]];
const SOLID_CORNERS = [0, 1].flatMap((end) => [[end, -1, 0, 0], [end, 0, 1, 0], [end, 1, 0, 0], [end, 0, 0, 2 * end - 1]]);
const FLAT_TRIANGLES = [0, 1, 2, 2, 1, 3];
/** The two faces towards the eye, and the points at both ends, which are seen from near. */
const SOLID_FACES = [0, 1, 4, 1, 5, 4, 1, 2, 5, 2, 6, 5];
const SOLID_TRIANGLES = [...SOLID_FACES, 0, 1, 3, 1, 2, 3, 4, 5, 7, 5, 6, 7];

/** So many rows go to the card at a time, 4 MB. */
const ROWS_AT_ONCE = 128;

/** The texels of a print's strokes (`points`, `role`, `bead`), four words each. */
function strokeWords({ points, role, bead, strokes }) {
  const words = new Uint32Array(4 * TEXELS * (Math.floor(strokes / TEXELS) + 1)), floats = new Float32Array(words.buffer);
  for (let i = 0; i <= strokes; i++) {
    floats[4 * i] = points[3 * i];
    floats[4 * i + 1] = points[3 * i + 1];
    floats[4 * i + 2] = points[3 * i + 2];
    words[4 * i + 3] = role[i] | (bead[2 * i] << 4) | (bead[2 * i + 1] << 18);
  }
  return words;
}

/** The strokes of a print as textures, which `upload` fills. Throws if the card has no room for so many. */
class StrokeTexture {
  constructor(gl, print) {
    Object.assign(this, { gl, print, strokes: print.strokes });
    this.rows = Math.floor(print.strokes / TEXELS) + 1;
    if (this.rows > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("too many strokes");
    this.texture = this.create();
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, TEXELS, this.rows);
    this.values = this.create();
    this.setValues([]);
  }

  /** Gives the strokes to the card, so many at a time that nobody waits. */
  *upload() {
    const { gl, print, rows, texture } = this, words = print.words ?? strokeWords(print);
    for (let row = 0; row < rows; row += ROWS_AT_ONCE) {
      const count = Math.min(ROWS_AT_ONCE, rows - row), part = words.subarray(4 * TEXELS * row, 4 * TEXELS * (row + count));
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, TEXELS, count, gl.RGBA_INTEGER, gl.UNSIGNED_INT, part);
      yield;
    }
  }

  /** Lets go of the card's memory. */
  free() {
    for (const texture of [this.texture, this.values]) this.gl.deleteTexture(texture);
  }

  create() {
    const { gl } = this, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return texture;
  }

  /** Takes up values of 0 to 1: that of stroke i, or of what the stroke is made from. */
  setValues(values, source = null) {
    const { gl } = this, bytes = new Uint8Array(TEXELS * this.rows);
    for (let i = 0; values.length && i < this.strokes; i++) bytes[i] = Math.round(255 * values[source ? source[i] : i]);
    gl.bindTexture(gl.TEXTURE_2D, this.values);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, TEXELS, this.rows, 0, gl.RED, gl.UNSIGNED_BYTE, bytes);
  }

  /** For the shaders that draw next. */
  bind() {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.values);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
  }
}

/** Corners and triangles of as many strokes as one call draws. */
class StrokeShape {
  constructor(gl, corners, triangles, atOnce) {
    Object.assign(this, { gl, atOnce, indices: triangles.length });
    const places = new Int8Array(4 * corners.length * atOnce), indices = new Uint16Array(triangles.length * atOnce);
    const flat = corners.flat();
    for (let i = 0; i < places.length; i++) places[i] = flat[i % flat.length];
    for (let i = 0; i < indices.length; i++) {
      indices[i] = Math.floor(i / triangles.length) * corners.length + triangles[i % triangles.length];
    }
    [this.places, this.triangles] = [gl.createBuffer(), gl.createBuffer()];
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.bufferData(gl.ARRAY_BUFFER, places, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  }

  bind() {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.BYTE, false, 0, 0);
    gl.disableVertexAttribArray(1);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
  }

  /** Draws the strokes from `begin` to `end`; `first`: the uniform that takes the first one of a call. */
  draw(first, begin, end, backwards) {
    const { gl, atOnce } = this, calls = Math.ceil((end - begin) / atOnce);
    for (let call = 0; call < calls; call++) {
      const at = begin + atOnce * (backwards ? calls - 1 - call : call);
      gl.uniform1i(first, at);
      gl.drawElements(gl.TRIANGLES, this.indices * Math.min(atOnce, end - at), gl.UNSIGNED_SHORT, 0);
    }
  }
}

/** Roles, as colors.rs numbers them, that hide others inside: walls seen from outside, bridges, top surfaces, skirt, support, ironing, the rest. */
const OUTSIDE = [0, 2, 5, 6, 8, 9, 11, 12].reduce((mask, role) => mask | (1 << role), 0);

/** A print of fewer strokes for a glance: the outside alone, without layers and points nearer than `step` to the last. */
function glance(print, step) {
  const { points, role, bead, first, layers } = print, kept = [], source = [], beads = [], starts = new Uint32Array(layers + 1);
  let end = -1, z = -step;
  for (let layer = 0; layer < layers; layer++) {
    // The beads of a layer that stays fill the place of those left out below it.
    const rise = print.z[layer] - z, stays = rise >= step || rise < 0;
    if (stays) z = print.z[layer];
    for (let i = first[layer]; stays && i < first[layer + 1]; i++) {
      if (!((OUTSIDE >> role[i]) & 1)) continue;
      // A stroke from somewhere else begins with a jump there.
      if (end !== i) {
        kept.push(i);
        source.push(-1);
        beads.push(0, 0);
      }
      end = i + 1;
      const from = 3 * kept[kept.length - 1], to = 3 * end, goesOn = end < first[layer + 1] && role[end] === role[i];
      if (goesOn && Math.max(Math.abs(points[to] - points[from]), Math.abs(points[to + 1] - points[from + 1])) < step) continue;
      kept.push(end);
      source.push(i);
      const width = bead[2 * i], height = bead[2 * i + 1], more = Math.min(Math.max((100 * rise) / (height || 1), 1), 5);
      beads.push((width * (1 + more)) / 2, height * more);
    }
    starts[layer + 1] = source.length;
  }
  // Point i + 1 ends stroke i.
  const strokes = source.length, few = {
    strokes, first: starts, source, points: new Float32Array(3 * (strokes + 1)), role: new Uint8Array(strokes), bead: Uint16Array.from(beads),
  };
  for (let i = 0; i < strokes; i++) {
    for (let axis = 0; axis < 3; axis++) few.points[3 * i + 3 + axis] = points[3 * kept[i] + axis];
    few.role[i] = source[i] < 0 ? JUMP : role[source[i]];
  }
  return few;
}
