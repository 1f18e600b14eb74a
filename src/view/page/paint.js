// What colour a stroke has, and which strokes are seen.

const COLORINGS = {
  role: null,
  tool: { label: "Tool", unit: "", digits: 0 },
  speed: { label: "Speed", unit: "mm/s", digits: 0 },
  flow: { label: "Flow", unit: "mm³/s", digits: 1 },
  order: { label: "Order of printing", unit: "", digits: 0 },
  time: { label: "Layer time", unit: "s", digits: 1 },
};

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

/** Values of all strokes of a print, and the least and greatest of them; travel does not count. */
function valuesOf(print, coloring) {
  const { role, tool, speed, section, first, strokes } = print, values = new Float32Array(strokes);
  let low = Infinity, high = -Infinity;
  for (let layer = 0; layer < print.layers; layer++) {
    const begin = first[layer], end = first[layer + 1];
    for (let i = begin; i < end; i++) {
      const value =
        coloring === "speed" ? speed[i]
        : coloring === "tool" ? tool[i] + 1
        : coloring === "flow" ? speed[i] * section[i]
        : coloring === "order" ? (100 * (i - begin)) / Math.max(end - begin - 1, 1)
        : print.time[layer];
      values[i] = value;
      if (role[i] < TRAVEL) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
  }
  return { values, low, high };
}

/** Scales values to 0..1 within common limits. */
function scaleValues(values, low, high) {
  const factor = high > low ? 1 / (high - low) : 0;
  for (let i = 0; i < values.length; i++) values[i] = Math.min(Math.max((values[i] - low) * factor, 0), 1);
  return values;
}

/** The ramp's colour for a value of 0..1, as CSS. */
function rampColor(ramp, value) {
  const at = Math.min(Math.max(value, 0), 1) * (ramp.length - 1), i = Math.min(Math.floor(at), ramp.length - 2);
  const a = rgb(ramp[i]), b = rgb(ramp[i + 1]);
  return `rgb(${a.map((c, k) => Math.round(255 * (c + (b[k] - c) * (at - i)))).join(" ")})`;
}
