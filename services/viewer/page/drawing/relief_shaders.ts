// GLSL of the tilted view: the ground as a net over the cells' heights, what blocks as boxes, curbs as walls.
import { kPicture } from "./shaders";

/// A tile's ground: a net of `net` squares aside, in as many steps as its place on the screen is worth. Where a
/// neighbour has a coarser net, the net's edge lies on that one's, so that no gap is seen.
export const kNetVertex = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D cells;
uniform highp sampler2D heights;
uniform mat4 toClip;      // from m in map
uniform vec2 corner;      // of the page, m in map
uniform float cellsAside;
uniform int net;
in vec4 tile;             // column and row of its first cell in the page; m, ground where no cell tells; edges that are coarser
out highp vec2 cell;
out float light;
out float shown;          // 0: farther away than the map is drawn
uniform float reach;

float groundAt(ivec2 at) {
  float sum = 0.0, n = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 place = at - ivec2(i & 1, i >> 1);
    if (any(lessThan(place, ivec2(0))) || any(greaterThanEqual(place, ivec2(int(cellsAside))))) continue;
    float h = texelFetch(heights, place, 0).r;
    uint kind = texelFetch(cells, place, 0).r;
    if (h < -1e8 || kind == 0u || kind > 2u) continue;  // under what blocks nobody saw the ground
    sum += h;
    n += 1.0;
  }
  return n > 0.0 ? sum / n : tile.z;
}
float alongEdge(ivec2 first, ivec2 step, int at, int coarse) {
  int low = at / coarse * coarse;
  float share = float(at - low) / float(coarse);
  float from = groundAt(first + step * low);
  return share == 0.0 ? from : mix(from, groundAt(first + step * (low + coarse)), share);
}
void main() {
  int aside = net + 1, stride = 25 / net, coarse = net == 25 ? 5 : 25;
  ivec2 first = ivec2(tile.xy);
  ivec2 inside = ivec2(gl_VertexID % aside, gl_VertexID / aside) * stride;
  int edges = int(tile.w);
  float z;
  if ((edges & 1) != 0 && inside.x == 0) z = alongEdge(first, ivec2(0, 1), inside.y, coarse);
  else if ((edges & 2) != 0 && inside.x == 25) z = alongEdge(first + ivec2(25, 0), ivec2(0, 1), inside.y, coarse);
  else if ((edges & 4) != 0 && inside.y == 0) z = alongEdge(first, ivec2(1, 0), inside.x, coarse);
  else if ((edges & 8) != 0 && inside.y == 25) z = alongEdge(first + ivec2(0, 25), ivec2(1, 0), inside.x, coarse);
  else z = groundAt(first + inside);
  cell = vec2(first + inside);
  light = 1.0;
  gl_Position = toClip * vec4(corner + cell * 0.12, z, 1);
  shown = 1.0 - smoothstep(0.55 * reach, reach, gl_Position.w);
}`;

/// A face of the box on a cell that blocks.
export const kBlockVertex = `#version 300 es
precision highp float;
uniform mat4 toClip;
uniform vec2 corner;      // of the page, m in map
in vec4 face;             // column, row of the cell in the page; m, z of its foot; 8 * height in dm + side
out highp vec2 cell;
out float light;
out float shown;
uniform float reach;
void main() {
  int code = int(face.w), side = code & 7;
  float high = float(code >> 3) * 0.1;
  vec2 unit = vec2(gl_VertexID & 1, gl_VertexID >> 1);  // along the face, up
  vec2 at = face.xy;
  float z = face.z + high * unit.y;
  if (side == 0) { at += unit; z = face.z + high; }
  if (side == 1) at += vec2(1.0, unit.x);
  if (side == 2) at += vec2(0.0, 1.0 - unit.x);
  if (side == 3) at += vec2(1.0 - unit.x, 1.0);
  if (side == 4) at += vec2(unit.x, 0.0);
  cell = face.xy + 0.5;
  light = side == 0 ? 1.08 : (side == 2 || side == 3 ? 0.94 : 0.76) * (0.84 + 0.16 * unit.y);
  gl_Position = toClip * vec4(corner + at * 0.12, z, 1);
  shown = 1.0 - smoothstep(0.55 * reach, reach, gl_Position.w);
}`;

const kLit = `in highp vec2 cell;
in float light;
in float shown;
out vec4 colour;
vec4 lit(vec4 c) {
  if (c.a < 0.02) discard;
  return greyed(vec4(min(c.rgb * light, vec3(c.a)), c.a)) * shown;
}`;

export const kNetFragment = `${kPicture}${kLit}
void main() {
  colour = lit(colourOf(cell));
}`;

export const kBlockFragment = `${kPicture}${kLit}
void main() {
  colour = lit(colourOfOne(ivec2(floor(cell))));
}`;

export const kSolidVertex = `#version 300 es
uniform mat4 toClip;
uniform vec4 ink;
uniform float reach;
in vec4 point;            // m in map; light
out vec4 shade;
void main() {
  gl_Position = toClip * vec4(point.xyz, 1);
  gl_Position.z -= 0.003 * gl_Position.w;  // before the net's slope that stands for the same step
  shade = vec4(ink.rgb * abs(point.w), 1) * ink.a * (point.w < 0.0 ? 0.55 : 1.0) * (1.0 - smoothstep(0.55 * reach, reach, gl_Position.w));
}`;

export const kSolidFragment = `#version 300 es
precision mediump float;
uniform float grey;
in vec4 shade;
out vec4 colour;
void main() {
  float luma = dot(shade.rgb, vec3(0.3, 0.59, 0.11));
  colour = vec4(mix(shade.rgb, vec3(luma), grey), shade.a) * (1.0 - 0.45 * grey);
}`;
