// The packed prints (see pack.rs) as arrays: one entry for each stroke, layer and mark.

const TRAVEL = 13, JUMP = 14, MARK = 15, TOOL_CHANGED = 3;
const Z_CHANGED = 1 << 4, BEAD_CHANGED = 1 << 5, SECTION_CHANGED = 1 << 6, SPEED_CHANGED = 1 << 7;

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Stroke i leads from point i to point i + 1. Positions in mm, beads in 0.01 mm, sections in mm², speeds in mm/s. */
function unpack(bytes, info) {
  const { strokes, marks, layers } = info, per = (type) => new type(layers);
  const print = {
    ...info,
    points: new Float32Array(3 * (strokes + 1)),
    role: new Uint8Array(strokes),
    tool: new Uint8Array(strokes),
    bead: new Uint16Array(2 * strokes),
    section: new Float32Array(strokes),
    speed: new Float32Array(strokes),
    markPoints: new Float32Array(3 * marks),
    markKind: new Uint8Array(marks),
    markStroke: new Uint32Array(marks),
    first: new Uint32Array(layers + 1),
    firstMark: new Uint32Array(layers + 1),
    z: per(Float64Array), time: per(Float64Array), print: per(Float64Array), travel: per(Float64Array),
    link: per(Float64Array), volume: per(Float64Array), travels: per(Uint32Array), retractions: per(Uint32Array),
    bound: per(Float64Array),
  };
  let at = 0;
  const unsigned = () => {
    let value = 0, scale = 1, byte;
    do {
      byte = bytes[at++];
      value += (byte & 127) * scale;
      scale *= 128;
    } while (byte > 127);
    return value;
  };
  const signed = () => {
    const value = unsigned();
    return value & 1 ? -(value + 1) / 2 : value / 2;
  };
  const { points, role, tool, bead, section, speed, markPoints, markKind, markStroke } = print;
  let x = 0, y = 0, z = 0, layerZ = 0, width = 0, height = 0, area = 0, feed = 0, drawing = 0, stroke = 0, mark = 0;
  for (let layer = 0; layer < layers; layer++) {
    layerZ += signed();
    print.z[layer] = layerZ * 0.005;
    print.time[layer] = unsigned() * 0.001;
    for (const key of ["print", "travel", "link", "volume"]) print[key][layer] = unsigned() * 0.01;
    print.travels[layer] = unsigned();
    print.retractions[layer] = unsigned();
    print.bound[layer] = (unsigned() - 1) * 0.01;
    for (let entries = unsigned(); entries > 0; entries--) {
      const head = bytes[at++], kind = head & 15;
      if (kind === MARK && head >> 4 === TOOL_CHANGED) {
        drawing = unsigned();
        continue;
      }
      if (kind === MARK) {
        markPoints[3 * mark] = x * 0.005;
        markPoints[3 * mark + 1] = y * 0.005;
        markPoints[3 * mark + 2] = z * 0.005;
        markKind[mark] = head >> 4;
        markStroke[mark++] = stroke;
        continue;
      }
      x += signed();
      y += signed();
      if (head & Z_CHANGED) z += signed();
      if (kind !== JUMP) {
        if (head & BEAD_CHANGED) {
          width = unsigned();
          height = unsigned();
        }
        if (head & SECTION_CHANGED) area = unsigned() * 0.002;
        if (head & SPEED_CHANGED) feed = unsigned() * 0.1;
      }
      role[stroke] = kind;
      tool[stroke] = drawing;
      bead[2 * stroke] = width;
      bead[2 * stroke + 1] = height;
      section[stroke] = kind < TRAVEL ? area : 0;
      speed[stroke++] = feed;
      points[3 * stroke] = x * 0.005;
      points[3 * stroke + 1] = y * 0.005;
      points[3 * stroke + 2] = z * 0.005;
    }
    print.first[layer + 1] = stroke;
    print.firstMark[layer + 1] = mark;
  }
  return print;
}

/** Seconds from the start of a layer to the end of each of its strokes, so that the last is the layer's time. */
function strokeTimes(print, layer) {
  const first = print.first[layer], count = print.first[layer + 1] - first;
  const times = new Float64Array(count), { points, role, speed } = print;
  let sum = 0;
  for (let i = 0; i < count; i++) {
    const p = 3 * (first + i);
    if (role[first + i] !== JUMP) {
      const length = Math.hypot(points[p + 3] - points[p], points[p + 4] - points[p + 1], points[p + 5] - points[p + 2]);
      sum += length / Math.max(speed[first + i], 0.1);
    }
    times[i] = sum;
  }
  const stretch = sum > 0 && print.time[layer] > 0 ? print.time[layer] / sum : 1;
  for (let i = 0; i < count; i++) times[i] *= stretch;
  return times;
}

/** Length of each role of a print, travel last. */
function roleLengths({ points, role, strokes }) {
  const sums = new Float64Array(JUMP + 1);
  for (let i = 0; i < strokes; i++) {
    const dx = points[3 * i + 3] - points[3 * i], dy = points[3 * i + 4] - points[3 * i + 1];
    sums[role[i]] += Math.sqrt(dx * dx + dy * dy);
  }
  return sums.slice(0, JUMP);
}

/** How many marks of each kind a print has. */
function markCounts({ markKind }) {
  const counts = [0, 0, 0];
  for (let i = 0; i < markKind.length; i++) counts[markKind[i]]++;
  return counts;
}
