// GLSL of the tilted view: the ground as a mesh over the cells' heights, obstacles and walls as boxes, curbs as walls.
import { kColourOf, kPicture } from "../shaders";

export const kNetVertex = `#version 300 es
precision highp float;
uniform mat4 toClip;      // from m relative to the camera
uniform vec2 corner;      // of the page, m relative to the camera
uniform float reach;
in vec3 point;            // column and row in the page; m
out highp vec2 cell;
out float shown;          // 0: farther away than the map is drawn
void main() {
  cell = point.xy;
  gl_Position = toClip * vec4(corner + cell * 0.12, point.z, 1);
  shown = 1.0 - smoothstep(0.55 * reach, reach, gl_Position.w);
}`;

/// A point of a box on blocking cells, in the colour of one of them.
export const kBlockVertex = `${kPicture}
uniform mat4 toClip;
uniform vec2 corner;      // of the page, m relative to the camera
uniform float reach;
in vec4 point;            // column and row in the page; m; light
in vec2 place;            // of the cell
out vec4 shade;
void main() {
  gl_Position = toClip * vec4(corner + point.xy * 0.12, point.z, 1);
  vec4 c = colourOfOne(ivec2(place));
  shade = greyed(vec4(min(c.rgb * point.w, vec3(c.a)), c.a)) * (1.0 - smoothstep(0.55 * reach, reach, gl_Position.w));
}`;

export const kNetFragment = `${kPicture}${kColourOf}
in highp vec2 cell;
in float shown;
out vec4 colour;
void main() {
  vec4 c = colourOf(cell);
  if (c.a < 0.02) discard;
  colour = greyed(c) * shown;
}`;

/// The same for the unchanged picture, neither by age nor grey: faster without a graphics card.
export const kPlainNetFragment = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D picture;
uniform float cellsAside;
in highp vec2 cell;
in float shown;
out vec4 colour;
void main() {
  vec4 c = texture(picture, cell / cellsAside, -0.4);
  if (c.a < 0.02) discard;
  colour = c * shown;
}`;

export const kBlockFragment = `#version 300 es
precision mediump float;
in vec4 shade;
out vec4 colour;
void main() {
  if (shade.a < 0.02) discard;
  colour = shade;
}`;

export const kSolidVertex = `#version 300 es
uniform mat4 toClip;
uniform vec4 ink;
uniform float reach;
uniform vec2 anchor;      // m relative to the camera
in vec4 point;            // m relative to the anchor; light
out vec4 shade;
void main() {
  gl_Position = toClip * vec4(point.xy + anchor, point.z, 1);
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
