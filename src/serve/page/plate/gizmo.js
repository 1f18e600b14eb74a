// Handles around the selected object: where they are, which one is meant, and what dragging one does.

import { add, cross, dot, meets, sub, times } from "../geometry.js";

const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const RING = 48;

/** Handles for a tool: `axis` (3: all) with the points of its line, in mm. `unit`: mm of a CSS pixel there. */
export function handles(tool, instance, unit) {
  const middle = add(instance.at, [0, 0, instance.size[2] / 2]), reach = instance.size.map((s) => s / 2 + 26 * unit);
  if (tool === "move") {
    return (instance.role === "part" ? [0, 1] : [0, 1, 2]).map((axis) => ({ axis, tip: true, points: [middle, add(middle, times(AXES[axis], reach[axis]))] }));
  }
  if (tool === "scale") {
    const corner = add(middle, instance.size.map((s) => s / 2 + 8 * unit));
    const axes = [0, 1, 2].map((axis) => ({ axis, tip: true, points: [middle, add(middle, times(AXES[axis], reach[axis]))] }));
    return [...axes, { axis: 3, tip: true, points: [middle, corner] }];
  }
  if (tool !== "turn") return [];
  const radius = Math.max(Math.hypot(...instance.size) / 2 + 8 * unit, 40 * unit);
  return [0, 1, 2].map((axis) => ({ axis, tip: false, points: ring(middle, axis, radius) }));
}

function ring(middle, axis, radius) {
  const [u, v] = [AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]];
  return Array.from({ length: RING + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / RING;
    return add(middle, add(times(u, radius * Math.cos(angle)), times(v, radius * Math.sin(angle))));
  });
}

/** The handle within reach of a place in the window, if any; `project`: mm to pixels. */
export function handleAt(list, [x, y], project, reach) {
  let best = null, least = reach;
  for (const handle of list) {
    const points = handle.points.map(project);
    for (let i = 1; i < points.length; i++) {
      // An arrow is meant at its outer half: its inner one lies over the object.
      const [from, to] = [handle.tip ? middleOf(points[0], points[1]) : points[i - 1], points[i]];
      const far = toSegment([x, y], from, to);
      if (far < least) [best, least] = [handle, far];
    }
  }
  return best;
}

const middleOf = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];

function toSegment([x, y], [ax, ay], [bx, by]) {
  const dx = bx - ax, dy = by - ay, along = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
  return Math.hypot(x - ax - along * dx, y - ay - along * dy);
}

/** A drag of the object itself over the bed: gives how far, in mm. */
export function dragFlat(ray, from) {
  const to = meets(ray, from, [0, 0, 1]);
  return to && sub(to, from);
}

/** How far a ray is along an axis through a point, mm. */
export function alongAxis(ray, middle, axis) {
  const a = AXES[axis], side = cross(a, ray.along), plane = cross(side, a), at = meets(ray, middle, plane);
  return at ? dot(sub(at, middle), a) : null;
}

/** The angle of a ray about an axis through a point, degrees. */
export function angleAt(ray, middle, axis) {
  const at = Math.abs(dot(ray.along, AXES[axis])) < 0.08 ? null : meets(ray, middle, AXES[axis]) ?? meets({ from: ray.from, along: times(ray.along, -1) }, middle, AXES[axis]);
  if (!at) return null;
  const d = sub(at, middle);
  return (Math.atan2(d[(axis + 2) % 3], d[(axis + 1) % 3]) * 180) / Math.PI;
}

/** An angle at the nearest multiple of 45° if it is near to it, else at a whole degree; `free`: as it is. */
export function snap(degrees, free) {
  if (free) return degrees;
  const step = 45 * Math.round(degrees / 45);
  return Math.abs(degrees - step) < 4 ? step : Math.round(degrees);
}
