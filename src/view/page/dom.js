// Elements and numbers.

const find = (id) => document.getElementById(id);

/** An element with attributes (`on…`: listeners) and children. */
function element(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    // As an attribute it would be refused where a page allows no styles but its own file's.
    else if (key === "style") node.style.cssText = value;
    else if (value !== false && value !== null) node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children);
  return node;
}

const fixed = (value, digits) => value.toFixed(digits).replace("-", "−");

/** Millimetres, or metres where they are many. */
const length = (mm) => (mm >= 10000 ? `${fixed(mm / 1000, 1)} m` : mm >= 1000 ? `${fixed(mm / 1000, 2)} m` : `${fixed(mm, 1)} mm`);

function duration(seconds) {
  if (seconds < 60) return `${fixed(seconds, 1)} s`;
  const whole = Math.round(seconds), two = (n) => String(n).padStart(2, "0");
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h ? `${h} h ${two(m)} min` : `${m} min ${two(s)} s`;
}

const percent = (share) => (share === null || share === undefined ? "–" : `${fixed(100 * share, 1)} %`);

/** How far above a bound something is; null without a bound. */
const gapOf = (mm, bound) => (bound > 0 ? Math.max(mm / bound - 1, 0) : bound === 0 && mm < 0.005 ? 0 : null);
