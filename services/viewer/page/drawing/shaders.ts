// GLSL of the map's cells (painted into one picture per page, which is then drawn) and of the LiDAR's points.

const kRamp = `uniform int mode;            // 0 class, 1 height, 2 cost, 3 confidence, 4 age
uniform vec3 ramp[8];
vec3 onRamp(float share) {
  float place = clamp(share, 0.0, 1.0) * 7.0;
  int low = min(int(place), 6);
  return mix(ramp[low], ramp[low + 1], place - float(low));
}
`;

/// Covers a whole page, one pixel per cell.
export const kPaintVertex = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0, 0, 1);
}`;

/// The colour of a cell. The page's textures: `cells` has class, cost, confidence, and 255 where a tile is; `heights`
/// has m, 0 if unknown. In the mode age only the known cells are marked: their colours change all the time.
export const kPaintFragment = `#version 300 es
precision highp float;
precision highp usampler2D;
precision highp sampler2D;
uniform usampler2D cells;
uniform sampler2D heights;
uniform vec4 classes[5];
uniform vec2 range;          // m: the ends of the ramp
uniform float relief;        // how strong
out vec4 colour;
${kRamp}
float heightAt(ivec2 at) {
  return texelFetch(heights, clamp(at, ivec2(0), textureSize(heights, 0) - 1), 0).r;
}
float shade(ivec2 at, float h) {
  float e = heightAt(at + ivec2(1, 0)), w = heightAt(at - ivec2(1, 0));
  float n = heightAt(at + ivec2(0, 1)), s = heightAt(at - ivec2(0, 1));
  vec2 slope = vec2((e == 0.0 ? h : e) - (w == 0.0 ? h : w), (n == 0.0 ? h : n) - (s == 0.0 ? h : s)) / 0.24;
  return clamp(dot(slope, vec2(0.45, -0.65)) * 0.9, -0.28, 0.22);  // light from the north-west
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec4 values = texelFetch(cells, at, 0);
  float h = heightAt(at);
  vec4 c = vec4(0);
  if (values.a > 0u) {
    if (mode == 0) c = classes[values.r];
    if (mode == 1 && h != 0.0) c = vec4(onRamp((h - range.x) / (range.y - range.x)), 1);
    if (mode == 2 && values.g < 255u) c = vec4(onRamp(float(values.g) / 254.0), 1);
    if (mode == 3 && values.r > 0u) c = vec4(onRamp(float(values.b) / 255.0), 1);
    if (mode == 4 && values.r > 0u) c = vec4(1);
    if (c.a > 0.0 && relief > 0.0 && h != 0.0) c.rgb *= 1.0 + relief * shade(at, h);
  }
  colour = vec4(c.rgb * c.a, c.a);
}`;

/// For a shader that shows the picture of a page. `times`: of the tiles, s.
export const kPicture = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D picture;
uniform sampler2D times;
uniform float now;           // s
uniform float grey;          // 1: what is seen is old
uniform vec3 paper;
uniform float cellsAside;
${kRamp}
vec4 aged(vec4 c, vec2 cell) {
  if (mode != 4 || c.a == 0.0) return c;
  ivec2 tile = clamp(ivec2(floor(cell)) / 25, ivec2(0), textureSize(times, 0) - 1);
  return vec4(c.rgb * onRamp(log2(1.0 + max(0.0, now - texelFetch(times, tile, 0).r)) / log2(601.0)), c.a);
}
vec4 colourOfOne(ivec2 cell) {
  return aged(texelFetch(picture, cell, 0), vec2(cell));
}
vec4 greyed(vec4 c) {
  if (grey == 0.0) return c;
  float luma = dot(c.rgb, vec3(0.3, 0.59, 0.11));
  return vec4(mix(c.rgb, mix(vec3(luma), paper * c.a, 0.45), grey), c.a);
}
`;

/// The colour of a fragment. Where cells are smaller than pixels it is their mean, from the picture's mipmaps.
export const kColourOf = `vec4 colourOf(vec2 cell) {
  return aged(texture(picture, cell / cellsAside, -0.4), cell);
}
`;

/// A page is one quad.
export const kPageVertex = `#version 300 es
uniform mat4 toClip;      // from m relative to the camera
uniform vec2 corner;      // of the page, m relative to the camera
uniform float side;       // m
uniform float cellsAside;
out highp vec2 cell;
void main() {
  vec2 unit = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  cell = unit * cellsAside;
  gl_Position = vec4((toClip * vec4(corner + unit * side, 0, 1)).xy, 0, 1);
}`;

/// Blended with the paper here, so that the frame buffer need not be read: that matters without a graphics card.
const kOnPaper = `vec4 onPaper(vec4 c) { return vec4(c.rgb + paper * (1.0 - c.a), 1); }
`;

/// For every look.
export const kPageFragment = `${kPicture}${kColourOf}${kOnPaper}
in highp vec2 cell;
out vec4 colour;
void main() {
  colour = onPaper(greyed(colourOf(cell)));
}`;

/// The unchanged picture: neither by age nor grey. `look`: GLSL that reads it.
const asItIs = (look: string) => `#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D picture;
uniform vec3 paper;
uniform float cellsAside;
${kOnPaper}
in highp vec2 cell;
out vec4 colour;
void main() {
  colour = onPaper(${look});
}`;
/// For cells smaller than pixels, and for larger ones, where a pixel has the colour of one cell.
export const kFarFragment = asItIs("texture(picture, cell / cellsAside, -0.4)");
export const kNearFragment = asItIs("texelFetch(picture, ivec2(min(cell, cellsAside - 1.0)), 0)");

export const kPointVertex = `#version 300 es
uniform mat4 toClip;     // from m in map
uniform mat4 toMap;      // from base_link
uniform float size;      // pixels
uniform int byIntensity;
uniform vec3 ramp[8];
in vec4 point;           // x, y, z in base_link, m; intensity
out vec4 shade;
void main() {
  gl_Position = toClip * (toMap * vec4(point.xyz, 1));
  gl_Position.z -= 0.004 * gl_Position.w;  // before the ground on which it lies
  gl_PointSize = size;
  float share = byIntensity == 1 ? sqrt(point.w) : smoothstep(0.05, 2.6, point.z);
  float place = clamp(share, 0.0, 1.0) * 7.0;
  int low = min(int(place), 6);
  shade = vec4(mix(ramp[low], ramp[low + 1], place - float(low)), mix(0.45, 0.95, share));
}`;

export const kPointFragment = `#version 300 es
precision mediump float;
uniform float grey;
in vec4 shade;
out vec4 colour;
void main() {
  if (length(gl_PointCoord - 0.5) > 0.5) discard;
  vec3 ink = mix(shade.rgb, vec3(dot(shade.rgb, vec3(0.3, 0.59, 0.11))), grey);
  colour = vec4(ink * shade.a, shade.a) * (1.0 - 0.6 * grey);
}`;

/// A canvas over the whole ground, pixel for pixel; its first row is the highest.
export const kSheetFragment = `#version 300 es
precision highp float;
uniform sampler2D picture;
out vec4 colour;
void main() {
  colour = texelFetch(picture, ivec2(gl_FragCoord.x, float(textureSize(picture, 0).y) - gl_FragCoord.y), 0);
}`;
