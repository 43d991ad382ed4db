// The dense cloud in WebGL2, in both views: a buffer per tile, made again when the tile changed.
import { Cloud, CloudTile, kPointBytes, kStep } from "../cloud";
import { kTileSize } from "../world";
import { Camera } from "./camera";
import { cloudRamp, CloudColour, Theme } from "./palette";
import { Program, unit } from "./program";

const kWithCard = 500_000, kInSoftware = 40_000, kDraft = 15_000;  // points that a machine draws in time
const kMostStride = 25;  // points: WebGL2's stride ends at 255 bytes
const kSeen = 5;         // times the eye's distance
const kHuge = 6;         // pixels, the largest point

const kVertex = `#version 300 es
uniform mat4 toClip;     // from m relative to the camera
uniform vec3 corner;     // of the tile: x, y relative to the camera, z in map
uniform float size;      // pixels, at the middle of the view
uniform vec2 range;      // m: the heights at the ends of the ramp
uniform int by;          // 0 height, 1 intensity, 2 surface, 3 line
uniform float flatFrom;  // the view from above: the height at the middle; -1e9: tilted
uniform vec3 ramp[8];
uniform vec3 unknown;
in vec3 place;           // steps
in vec4 values;          // intensity, surface, line
out vec3 shade;
void main() {
  vec3 at = corner + place * ${kStep};
  gl_Position = toClip * vec4(at, 1);
  // From above the highest point is seen; tilted, a point is before the ground on which it lies.
  if (flatFrom > -1e8) gl_Position.z = clamp((flatFrom - at.z) * 0.005, -0.99, 0.99) * gl_Position.w;
  else gl_Position.z -= 0.003 * gl_Position.w;
  gl_PointSize = clamp(size / gl_Position.w, 1.0, ${kHuge}.0);
  float saliency = by == 2 ? values.y : values.z;
  float share = by == 0 ? (at.z - range.x) / (range.y - range.x) : by == 1 ? sqrt(values.x) : (saliency * 255.0 - 1.0) / 127.0;  // the votes of a plane reach a half
  float on = clamp(share, 0.0, 1.0) * 7.0;
  int low = min(int(on), 6);
  shade = by >= 2 && saliency == 0.0 ? unknown : mix(ramp[low], ramp[low + 1], on - float(low));
}`;

const kFragment = `#version 300 es
precision mediump float;
uniform float grey;
in vec3 shade;
out vec4 colour;
void main() {
  vec3 ink = mix(shade, vec3(dot(shade, vec3(0.3, 0.59, 0.11))), grey);
  colour = vec4(ink, 1) * (1.0 - 0.6 * grey);
}`;

interface Kept { buffer: WebGLBuffer; version: number }

export class CloudPoints {
  private program: Program;
  private kept = new Map<CloudTile, Kept>();

  constructor(private gl: WebGL2RenderingContext, private isSlow: boolean) {
    this.program = new Program(gl, kVertex, kFragment, ["place", "values"]);
  }

  /// `dots`: pixels of the canvas per CSS pixel. `range`: m, the ends of the height ramp, as of the cells.
  draw(cloud: Cloud, camera: Camera, look: { theme: Theme; grey: number; draft: boolean; range: [number, number]; cloudBy: CloudColour }, dots: number): void {
    const { gl, program } = this, seen = [...cloud.tiles.values()].filter(tile => tile.n > 0 && isSeen(camera, tile));
    this.forget(cloud);
    if (seen.length === 0) return;
    const points = seen.reduce((sum, { n }) => sum + n, 0), budget = look.draft ? kDraft : this.isSlow ? kInSoftware : kWithCard;
    const stride = Math.min(kMostStride, Math.ceil(points / budget));
    program.use();
    gl.uniformMatrix4fv(program.at("toClip"), false, camera.matrix());
    gl.uniform1f(program.at("size"), Math.min(4, Math.max(1.5, camera.scale * 0.075)) * Math.sqrt(stride) * dots);
    gl.uniform2fv(program.at("range"), look.range);
    gl.uniform1i(program.at("by"), ["height", "intensity", "surface", "line"].indexOf(look.cloudBy));
    gl.uniform1f(program.at("flatFrom"), camera.isTilted ? -1e9 : camera.z);
    gl.uniform3fv(program.at("ramp"), cloudRamp(look.theme, look.cloudBy).flatMap(unit));
    gl.uniform3fv(program.at("unknown"), unit(look.theme === "light" ? [176, 182, 190] : [92, 100, 110]));
    gl.uniform1f(program.at("grey"), look.grey);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.enableVertexAttribArray(0);
    gl.enableVertexAttribArray(1);
    for (const tile of seen) {
      gl.uniform3f(program.at("corner"), tile.x * kTileSize - camera.x, tile.y * kTileSize - camera.y, tile.zOrigin);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.bufferOf(tile));
      gl.vertexAttribPointer(0, 3, gl.SHORT, false, stride * kPointBytes, 0);
      gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, stride * kPointBytes, 6);
      gl.drawArrays(gl.POINTS, 0, Math.ceil(tile.n / stride));
    }
    gl.disableVertexAttribArray(1);
    gl.enable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
  }

  private bufferOf(tile: CloudTile): WebGLBuffer {
    const { gl } = this;
    let kept = this.kept.get(tile);
    if (!kept) this.kept.set(tile, kept = { buffer: gl.createBuffer()!, version: -1 });
    if (kept.version !== tile.version) {
      gl.bindBuffer(gl.ARRAY_BUFFER, kept.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, tile.bytes, gl.DYNAMIC_DRAW);
      kept.version = tile.version;
    }
    return kept.buffer;
  }

  /// Frees the buffers of tiles that the cloud no longer has.
  private forget(cloud: Cloud): void {
    if (this.kept.size === 0) return;
    for (const [tile, { buffer }] of this.kept) {
      if (cloud.tiles.get(`${tile.x},${tile.y}`) === tile) continue;
      this.gl.deleteBuffer(buffer);
      this.kept.delete(tile);
    }
  }
}

function isSeen(camera: Camera, tile: CloudTile): boolean {
  const [x, y] = [(tile.x + 0.5) * kTileSize, (tile.y + 0.5) * kTileSize];
  let reach = kTileSize * camera.scale;
  if (camera.isTilted) {
    const ahead = Math.sin(camera.turn) * (x - camera.x) + Math.cos(camera.turn) * (y - camera.y);
    const w = 1 + ahead * Math.sin(camera.tilt) / camera.distance;
    if (w < 0.1) return Math.abs(ahead) * camera.scale < camera.height;  // beside the eye
    if (w > kSeen) return false;
    reach = 3 * reach / w;  // what is above the ground is seen higher
  }
  const [sx, sy] = camera.toScreen(x, y);
  return sx > -reach && sy > -reach && sx < camera.width + reach && sy < camera.height + reach;
}
