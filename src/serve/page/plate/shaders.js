// GLSL of the plate.

/** Facets that are lit as the eye sees them; no normals are needed. */
export const MESH_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
uniform mat4 view;
uniform mat3 rows;
uniform vec3 shift;
out vec3 place;
void main() {
  place = rows * at + shift;
  gl_Position = view * vec4(place, 1.0);
}`;

export const MESH_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 color;
uniform vec3 eye;
uniform vec3 lights[2];
uniform vec3 below;
in vec3 place;
out vec4 result;
void main() {
  vec3 n = normalize(cross(dFdx(place), dFdy(place)));
  if (dot(n, eye - place) < 0.0) n = -n;
  float light = 0.42 + 0.55 * max(dot(n, lights[0]), 0.0) + 0.22 * max(dot(n, lights[1]), 0.0);
  // What is under the bed cannot be printed.
  vec3 base = place.z < -0.01 ? below : color.rgb;
  result = vec4(min(base * light, 1.0), 1.0) * color.a;
}`;

export const LINE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
uniform mat4 view;
void main() { gl_Position = view * vec4(at, 1.0); }`;

/** A line as wide as pixels: both ends come with each corner. */
export const WIDE_VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 other;
layout(location = 2) in float side;
uniform mat4 view;
uniform vec2 window;
uniform float width;
void main() {
  vec4 a = view * vec4(at, 1.0), b = view * vec4(other, 1.0);
  vec2 along = (b.xy / b.w - a.xy / a.w) * window;
  float far = length(along);
  vec2 across = far > 0.0 ? vec2(-along.y, along.x) / far : vec2(0.0, 1.0);
  gl_Position = a;
  gl_Position.xy += across * side * width / window * a.w;
}`;

export const COLOR_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 color;
out vec4 result;
void main() { result = vec4(color.rgb * color.a, color.a); }`;
