// GLSL. Strokes come from textures, see strokes.js: stroke i leads from the point of texel i to that of the next.

const STROKE_HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
layout(location = 0) in vec4 corner;
uniform usampler2D strokes;
uniform sampler2D values;
uniform int first;
uniform int mask;
uniform bool travels;
uniform int last;
uniform float part;
uniform bool byValue;
uniform vec3 colors[14];
uniform vec3 ramp[9];
out vec3 color;

/** Set by \`fetch\`: its points, width and height. */
vec3 start;
vec3 finish;
vec2 bead;
int role;

ivec2 texel(int index) {
  return ivec2(index & 2047, index >> 11);
}

/** Whether the stroke is seen. */
bool fetch(int index) {
  uvec4 here = texelFetch(strokes, texel(index), 0);
  role = int(here.w & 15u);
  if ((mask >> role & 1) == 0 || travels != (role == 13)) return false;
  start = uintBitsToFloat(here.xyz);
  finish = uintBitsToFloat(texelFetch(strokes, texel(index + 1), 0).xyz);
  if (index == last) finish = mix(start, finish, part);
  bead = 0.01 * vec2(here.w >> 4 & 16383u, here.w >> 18);
  color = colors[min(role, 13)];
  if (byValue && role != 13) {
    float place = 8.0 * texelFetch(values, texel(index), 0).r;
    int i = min(int(place), 7);
    color = mix(ramp[i], ramp[i + 1], place - float(i));
  }
  return true;
}
`;

/** A bead from above: a line with round ends, `view` from mm to the clip space, `pixel` mm in a pixel, `hair` half the width of travel. */
const FLAT_VERTEX = STROKE_HEAD + `
uniform vec4 view;
uniform float pixel;
uniform float hair;
out vec2 place;
flat out vec2 size;

void main() {
  if (!fetch(first + (gl_VertexID >> 2))) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  float half_width = travels ? hair : max(0.5 * bead.x, 0.6 * pixel);
  vec2 delta = finish.xy - start.xy;
  float length_mm = length(delta);
  vec2 along = length_mm > 0.0 ? delta / length_mm : vec2(1.0, 0.0);
  float reach = half_width + pixel;
  place = vec2(corner.x > 0.0 ? length_mm + reach : -reach, corner.y * reach);
  size = vec2(length_mm, half_width);
  vec2 at = start.xy + along * place.x + vec2(-along.y, along.x) * place.y;
  gl_Position = vec4(at * view.xy + view.zw, 0.0, 1.0);
}`;

const FLAT_FRAGMENT = `#version 300 es
precision highp float;
uniform float pixel;
uniform bool travels;
in vec3 color;
in vec2 place;
flat in vec2 size;
out vec4 result;

void main() {
  float away = length(vec2(place.x - clamp(place.x, 0.0, size.x), place.y));
  float cover = clamp((size.y - away) / pixel + 0.5, 0.0, 1.0);
  // A darker rim sets neighbouring beads apart, where they are large enough.
  float rim = travels ? 0.0 : smoothstep(0.62, 1.0, abs(place.y) / size.y) * clamp(size.y / pixel / 3.0 - 0.4, 0.0, 1.0);
  result = vec4(color * (1.0 - 0.38 * rim), 1.0) * cover;
}`;

/** A bead in space: a roof along the stroke, with pointed ends, whose ridge is towards the eye. `corner`: end, side, up, tip. */
const SOLID_VERTEX = STROKE_HEAD + `
uniform mat4 view;
uniform float thin;
uniform float upside;
uniform float pixel;
uniform vec3 back;
out vec3 normal;

void main() {
  if (!fetch(first + (gl_VertexID >> 3))) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec2 half_size = travels ? vec2(thin) : max(0.5 * bead, vec2(0.35 * pixel));
  vec3 delta = finish - start;
  float length_mm = length(delta);
  vec3 along = length_mm > 0.0 ? delta / length_mm : vec3(1.0, 0.0, 0.0);
  vec3 side = abs(along.z) > 0.99 ? vec3(1.0, 0.0, 0.0) : normalize(vec3(-along.y, along.x, 0.0));
  vec3 up = upside * cross(along, side);
  vec3 at = mix(start, finish, corner.x) + side * corner.y * half_size.x + up * corner.z * half_size.y
    + along * corner.w * half_size.x;
  at.z -= travels ? 0.0 : half_size.y;
  // From far away a bead is less than a pixel: its colours run together.
  vec3 mean = side * dot(side, back) + 0.45 * up;
  normal = mix(side * corner.y + up * corner.z + along * corner.w, mean, 0.75 * smoothstep(0.5, 1.5, pixel / max(bead.y, 0.01)));
  gl_Position = view * vec4(at, 1.0);
}`;

/** Two lights that move with the eye, one from above left, a weaker one from the right. */
const SOLID_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 lights[2];
uniform bool travels;
in vec3 color;
in vec3 normal;
out vec4 result;

void main() {
  vec3 n = normalize(normal);
  float light = 0.46 + 0.6 * max(dot(n, lights[0]), 0.0) + 0.18 * max(dot(n, lights[1]), 0.0);
  result = vec4(travels ? color : min(color * light, 1.0), 1.0);
}`;

/** Marks have shapes as well as colours: retraction ▼, un-retraction ▲, seam ◆. */
const MARK_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
layout(location = 1) in uint kind;
uniform mat4 view;
uniform int mask;
uniform float size;
uniform float lift;
uniform vec3 colors[3];
out vec3 color;
flat out uint shape;

void main() {
  shape = kind;
  color = colors[min(int(kind), 2)];
  gl_PointSize = size;
  gl_Position = (mask >> int(kind) & 1) == 1 ? view * vec4(at, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  // Triangles touch the point with their tip.
  gl_Position.y += (kind == 0u ? lift : kind == 1u ? -lift : 0.0) * gl_Position.w;
}`;

const MARK_FRAGMENT = `#version 300 es
precision highp float;
uniform float size;
uniform vec3 rim;
in vec3 color;
flat in uint shape;
out vec4 result;

void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float y = shape == 0u ? p.y : -p.y;
  float triangle = max(abs(p.x) * 0.87 + y * 0.5, -y) * 1.5;
  float away = shape == 2u ? abs(p.x) + abs(p.y) : triangle;
  float soft = 3.0 / size;
  float cover = clamp((1.0 - away) / soft, 0.0, 1.0);
  result = vec4(mix(color, rim, clamp((away - 0.72) / soft, 0.0, 1.0)), 1.0) * cover;
}`;

const LINE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
uniform mat4 view;
void main() { gl_Position = view * vec4(at, 1.0); }`;

const LINE_FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 color;
out vec4 result;
void main() { result = vec4(color, 1.0); }`;
