// From millimetres to the window. Panes share cameras, so that what is seen of one is seen of all.

/** Vertical angle of view, radians. */
const FIELD = 0.6;

/** From above: the point in the middle, and millimetres in a CSS pixel. */
class FlatCamera {
  constructor([x0, y0, x1, y1]) {
    this.box = [x0, y0, x1, y1];
    this.middle = [(x0 + x1) / 2, (y0 + y1) / 2];
    this.mm = 0.1;
  }
  fit(width, height) {
    const [x0, y0, x1, y1] = this.box;
    this.middle = [(x0 + x1) / 2, (y0 + y1) / 2];
    this.mm = 1.12 * Math.max((x1 - x0) / width, (y1 - y0) / height, 0.001);
  }
  /** Millimetres in a pixel. */
  pixel() {
    return this.mm;
  }
  drag(dx, dy) {
    this.middle = [this.middle[0] - dx * this.mm, this.middle[1] + dy * this.mm];
  }
  /** Zooms about a point, given in pixels from the middle of the pane. */
  zoom(factor, px, py) {
    const mm = Math.min(Math.max(this.mm * factor, 1e-4), 100);
    this.middle = [this.middle[0] + px * (this.mm - mm), this.middle[1] - py * (this.mm - mm)];
    this.mm = mm;
  }
  project([x, y], width, height) {
    return [(x - this.middle[0]) / this.mm + width / 2, height / 2 - (y - this.middle[1]) / this.mm];
  }
}

/** About a point: angles in radians, distance in mm. */
class TurnCamera {
  /** `outline`: points, three numbers each, that reach as far as the print does. */
  constructor(outline) {
    this.outline = outline;
    this.yaw = -0.6;
    this.pitch = 0.6;
    this.target = [0, 0, 0];
    this.distance = 100;
  }
  fit(width, height) {
    const { outline } = this, axes = Object.values(this.axes()), slope = Math.tan(FIELD / 2);
    const along = (axis, i) => axis[0] * outline[i] + axis[1] * outline[i + 1] + axis[2] * outline[i + 2];
    const middle = axes.map((axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < outline.length; i += 3) [low, high] = [Math.min(low, along(axis, i)), Math.max(high, along(axis, i))];
      return low <= high ? (low + high) / 2 : 0;
    });
    this.target = [0, 1, 2].map((i) => axes.reduce((sum, axis, k) => sum + axis[i] * middle[k], 0));
    this.distance = 1;
    // Far enough for every point.
    for (let i = 0; i < outline.length; i += 3) {
      const [right, up, back] = axes.map((axis, k) => along(axis, i) - middle[k]);
      const aside = Math.max(Math.abs(up), (Math.abs(right) * height) / width);
      this.distance = Math.max(this.distance, back + (1.12 * aside) / slope);
    }
  }
  axes() {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    return { right: [cy, sy, 0], up: [-sy * sp, cy * sp, cp], back: [sy * cp, -cy * cp, sp] };
  }
  /** Millimetres in a pixel of the middle. */
  pixel(height) {
    return (2 * this.distance * Math.tan(FIELD / 2)) / height;
  }
  turn(dx, dy) {
    this.yaw -= dx * 0.008;
    this.pitch = Math.min(Math.max(this.pitch + dy * 0.008, -1.57), 1.57);
  }
  drag(dx, dy, height) {
    const { right, up } = this.axes(), mm = this.pixel(height);
    this.target = this.target.map((t, i) => t - right[i] * dx * mm + up[i] * dy * mm);
  }
  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.5), 1e5);
  }
  /** Column-major, for WebGL. */
  matrix(width, height) {
    const { right, up, back } = this.axes(), dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const eye = this.target.map((t, i) => t + back[i] * this.distance);
    const f = 1 / Math.tan(FIELD / 2), near = this.distance * 0.02, far = this.distance * 40;
    const x = (f * height) / width, depth = (far + near) / (near - far), w = (2 * far * near) / (near - far);
    const columns = [0, 1, 2].map((i) => [x * right[i], f * up[i], depth * back[i], -back[i]]);
    const last = [-x * dot(right, eye), -f * dot(up, eye), -depth * dot(back, eye) + w, dot(back, eye)];
    return { matrix: new Float32Array([...columns.flat(), ...last]), eye, right, up, back };
  }
  project(point, width, height) {
    const { matrix: m } = this.matrix(width, height);
    const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [((row(0) / row(3) + 1) * width) / 2, ((1 - row(1) / row(3)) * height) / 2];
  }
}

/** Of some layers of a print those points that reach furthest in each of eight directions; what is no part of it is left out. */
function outlineOf({ points, role, first, layers }) {
  const outline = [], some = Math.min(layers, 64);
  for (const end of [TRAVEL - 1, JUMP]) {
    for (let n = 0; n < some; n++) {
      const layer = Math.round((n * (layers - 1)) / Math.max(some - 1, 1));
      const furthest = new Int32Array(8).fill(-1), reach = new Float64Array(8).fill(-Infinity);
      for (let i = first[layer]; i < first[layer + 1]; i++) {
        if (role[i] >= end) continue;
        const p = 3 * i + 3, x = points[p], y = points[p + 1];
        for (let k = 0; k < 8; k++) {
          const along = k < 4 ? (k & 1 ? x : y) : k & 1 ? x + y : x - y, far = k & 2 ? along : -along;
          if (far > reach[k]) [reach[k], furthest[k]] = [far, p];
        }
      }
      for (const p of furthest) if (p >= 0) outline.push(points[p], points[p + 1], points[p + 2]);
    }
    if (outline.length) break;
  }
  return outline;
}
