// Points, turns and boxes; millimetres and degrees. Nothing here knows the page.

const RAD = Math.PI / 180;

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const add = (a, b) => a.map((v, i) => v + b[i]);
export const sub = (a, b) => a.map((v, i) => v - b[i]);
export const times = (a, f) => a.map((v) => v * f);
export const normal = (a) => times(a, 1 / (Math.hypot(...a) || 1));

/** A turn about X, then Y, then Z as three rows. */
export function rotation([x, y, z]) {
  const [sx, cx, sy, cy, sz, cz] = [x, y, z].flatMap((angle) => [sine(angle), sine(angle + 90)]);
  return [
    [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
    [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
    [-sy, cy * sx, cy * cx],
  ];
}

/** Exact at quarter turns. */
function sine(angle) {
  const turn = ((angle % 360) + 360) % 360;
  return turn % 90 === 0 ? [0, 1, 0, -1][turn / 90] : Math.sin(turn * RAD);
}

/** The angles of a turn; of several answers the one with the smallest angle about Y. */
export function angles(m) {
  const y = Math.asin(Math.min(Math.max(-m[2][0], -1), 1));
  // Looking along an axis, X and Z turn about the same one.
  const [x, z] = Math.abs(m[2][0]) < 1 - 1e-12
    ? [Math.atan2(m[2][1], m[2][2]), Math.atan2(m[1][0], m[0][0])]
    : [0, Math.atan2(-m[0][1], m[1][1])];
  return [x, y, z].map((angle) => tidy(angle / RAD));
}

/** An angle of −180 (not included) to 180, without the dust of arithmetic. */
export function tidy(angle) {
  const near = Math.round(angle * 1e4) / 1e4, turned = near - 360 * Math.ceil((near - 180) / 360);
  return Object.is(turned, -0) ? 0 : Math.round(turned * 1e4) / 1e4;
}

export const multiply = (a, b) => a.map((row) => [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k]));
export const apply = (m, v) => m.map((row) => dot(row, v));

/** The angles after a further turn about an axis of the bed. */
export function turned(rotate, axis, degrees) {
  const further = [0, 0, 0];
  further[axis] = degrees;
  return angles(multiply(rotation(further), rotation(rotate)));
}

/** The shortest turn that leads one direction to another, as rows. */
export function between(from, to) {
  const a = normal(from), b = normal(to), c = dot(a, b), axis = cross(a, b), s = Math.hypot(...axis);
  if (s < 1e-9) return c > 0 ? rotation([0, 0, 0]) : about(Math.abs(a[0]) < 0.9 ? normal(cross(a, [1, 0, 0])) : normal(cross(a, [0, 1, 0])), Math.PI);
  return about(times(axis, 1 / s), Math.atan2(s, c));
}

function about([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}

/** Angles with which a face of an untransformed model, given by its normal, lies on the bed. */
export function layDown(model, face) {
  // Normals shrink where the model grows.
  const now = apply(rotation(model.rotate_deg), face.map((v, i) => v / model.scale[i]));
  return angles(multiply(between(now, [0, 0, -1]), rotation(model.rotate_deg)));
}

/** Scale and turn as one: three rows. */
export const linear = (model) => rotation(model.rotate_deg).map((row) => row.map((v, i) => v * model.scale[i]));

/** The box of points (three numbers each) under three rows: low and high corner. */
export function boxOf(points, rows) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const [[a, b, c], [d, e, f], [g, h, k]] = rows;
  for (let i = 0; i < points.length; i += 3) {
    const x = points[i], y = points[i + 1], z = points[i + 2];
    const p = a * x + b * y + c * z, q = d * x + e * y + f * z, r = g * x + h * y + k * z;
    if (p < low[0]) low[0] = p;
    if (p > high[0]) high[0] = p;
    if (q < low[1]) low[1] = q;
    if (q > high[1]) high[1] = q;
    if (r < low[2]) low[2] = r;
    if (r > high[2]) high[2] = r;
  }
  return low[0] <= high[0] ? { low, high } : { low: [0, 0, 0], high: [0, 0, 0] };
}

/** Where a ray meets the plane through a point; null if it does not. */
export function meets(ray, point, direction) {
  const slope = dot(ray.along, direction);
  if (Math.abs(slope) < 1e-9) return null;
  const far = dot(sub(point, ray.from), direction) / slope;
  return far > 0 ? add(ray.from, times(ray.along, far)) : null;
}

/** How far along a ray it meets the nearest triangle of a mesh; Infinity: nowhere. The ray is in the mesh's coordinates. */
export function nearest(ray, vertices, triangles) {
  const [ox, oy, oz] = ray.from, [dx, dy, dz] = ray.along;
  let best = Infinity;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i], b = 3 * triangles[i + 1], c = 3 * triangles[i + 2];
    const ax = vertices[a], ay = vertices[a + 1], az = vertices[a + 2];
    const ex = vertices[b] - ax, ey = vertices[b + 1] - ay, ez = vertices[b + 2] - az;
    const fx = vertices[c] - ax, fy = vertices[c + 1] - ay, fz = vertices[c + 2] - az;
    const px = dy * fz - dz * fy, py = dz * fx - dx * fz, pz = dx * fy - dy * fx;
    const det = ex * px + ey * py + ez * pz;
    if (det > -1e-12 && det < 1e-12) continue;
    const tx = ox - ax, ty = oy - ay, tz = oz - az, u = (tx * px + ty * py + tz * pz) / det;
    if (u < 0 || u > 1) continue;
    const qx = ty * ez - tz * ey, qy = tz * ex - tx * ez, qz = tx * ey - ty * ex, v = (dx * qx + dy * qy + dz * qz) / det;
    if (v < 0 || u + v > 1) continue;
    const far = (fx * qx + fy * qy + fz * qz) / det;
    if (far > 0 && far < best) best = far;
  }
  return best;
}

/** The inverse of three rows. */
export function inverse(m) {
  const [a, b, c] = m, r = [cross(b, c), cross(c, a), cross(a, b)], det = dot(a, r[0]) || 1e-30;
  return [0, 1, 2].map((i) => [0, 1, 2].map((k) => r[k][i] / det));
}
