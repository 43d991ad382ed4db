// The map's cells and the LiDAR's points, drawn by WebGL2. Cells live in textures of a page each, a square of tiles.
import { Camera } from "./camera";
import { classColours, Mode, ramp, Rgb, Theme } from "./palette";
import { kPageFragment, kPageVertex, kPointFragment, kPointVertex } from "./shaders";
import { kCells, kNoHeight, kTileCells, kTileSize, Pose, Tile, World } from "../world";

const kTilesAside = 32;                      // of a page: 96 m
const kCellsAside = kTilesAside * kCells;
const kNone = -1e9;                          // height where none is known

interface Page { x: number; y: number; cells: WebGLTexture; heights: WebGLTexture }

export interface Look {
  theme: Theme; mode: Mode; grid: boolean; relief: boolean; points: boolean;
  range: [number, number];  // m, of the height ramp
  grey: number;             // 0 .. 1: old
  paper: Rgb;
}

export class Ground {
  private gl!: WebGL2RenderingContext;
  private pages = new Map<string, Page>();
  private pageProgram!: WebGLProgram;
  private pointProgram!: WebGLProgram;
  private points!: WebGLBuffer;
  private numPoints = 0;
  private lost = false;

  /// Throws where there is no WebGL2.
  constructor(private canvas: HTMLCanvasElement, private world: World, redraw: () => void) {
    this.setUp();
    canvas.addEventListener("webglcontextlost", event => { event.preventDefault(); this.lost = true; });
    canvas.addEventListener("webglcontextrestored", () => {
      this.lost = false;
      this.setUp();
      for (const tile of world.tiles.values()) world.changed.add(tile);
      world.scanChanged = true;
      redraw();
    });
  }

  private setUp(): void {
    const gl = this.canvas.getContext("webgl2", { antialias: false, premultipliedAlpha: true, preserveDrawingBuffer: false });
    if (!gl) throw new Error("This browser has no WebGL2, which draws the map.");
    this.gl = gl;
    this.pages.clear();
    this.pageProgram = program(gl, kPageVertex, kPageFragment);
    this.pointProgram = program(gl, kPointVertex, kPointFragment);
    this.points = gl.createBuffer()!;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.points);
    const place = gl.getAttribLocation(this.pointProgram, "point");
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 4, gl.FLOAT, false, 0, 0);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /// Takes what became other in the world into the textures.
  private upload(): void {
    const { gl, world } = this;
    if (world.cleared) {
      for (const page of this.pages.values()) { gl.deleteTexture(page.cells); gl.deleteTexture(page.heights); }
      this.pages.clear();
      world.cleared = false;
    }
    for (const tile of world.changed) this.uploadTile(tile);
    world.changed.clear();
    if (world.scanChanged) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.points);
      gl.bufferData(gl.ARRAY_BUFFER, world.scan, gl.DYNAMIC_DRAW);
      this.numPoints = world.scan.length / 4;
      world.scanChanged = false;
    }
  }

  private uploadTile(tile: Tile): void {
    const { gl } = this;
    const [px, py] = [Math.floor(tile.x / kTilesAside), Math.floor(tile.y / kTilesAside)];
    const key = `${px},${py}`;
    let page = this.pages.get(key);
    if (!page) this.pages.set(key, page = this.newPage(px, py));
    for (let i = 0; i < kTileCells; ++i) {
      kCellBytes.set([tile.classes[i], tile.costs[i], tile.confidences[i], 255], 4 * i);
      kHeights[i] = tile.heights[i] === kNoHeight ? kNone : tile.zOrigin + tile.heights[i] * 0.002;
    }
    const [column, row] = [(tile.x - px * kTilesAside) * kCells, (tile.y - py * kTilesAside) * kCells];
    gl.bindTexture(gl.TEXTURE_2D, page.cells);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, column, row, kCells, kCells, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE, kCellBytes);
    gl.bindTexture(gl.TEXTURE_2D, page.heights);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, column, row, kCells, kCells, gl.RED, gl.FLOAT, kHeights);
  }

  private newPage(x: number, y: number): Page {
    const { gl } = this;
    const texture = (format: number) => {
      const made = gl.createTexture()!;
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texStorage2D(gl.TEXTURE_2D, 1, format, kCellsAside, kCellsAside);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      return made;
    };
    return { x, y, cells: texture(gl.RGBA8UI), heights: texture(gl.R32F) };
  }

  draw(camera: Camera, look: Look, pose: Pose | null): void {
    if (this.lost) return;
    this.upload();
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (look.grid) this.drawPages(camera, look);
    if (look.points && pose && this.numPoints > 0) this.drawPoints(camera, look, pose);
  }

  private drawPages(camera: Camera, look: Look): void {
    const { gl, pageProgram } = this;
    const at = (name: string) => gl.getUniformLocation(pageProgram, name);
    gl.useProgram(pageProgram);
    gl.uniform1i(at("cells"), 0);
    gl.uniform1i(at("heights"), 1);
    gl.uniform1i(at("mode"), ["height", "cost", "confidence"].indexOf(look.mode) + 1);
    gl.uniform4fv(at("classes"), classColours(look.theme, look.mode).flatMap(c => c ? [...unit(c), 1] : [0, 0, 0, 0]));
    gl.uniform3fv(at("ramp"), ramp(look.mode).flatMap(unit));
    gl.uniform2fv(at("range"), look.range);
    gl.uniform1f(at("relief"), look.relief ? 1 : 0);
    gl.uniform1f(at("grey"), look.grey);
    gl.uniform3fv(at("paper"), unit(look.paper));
    gl.uniform1f(at("cellsAside"), kCellsAside);
    gl.uniform1f(at("side"), kTilesAside * kTileSize);
    const [c, s] = [Math.cos(camera.turn), Math.sin(camera.turn)];
    const cellsAPixel = camera.width / this.canvas.width / camera.scale / 0.12;
    gl.uniform2f(at("pixelX"), c * cellsAPixel, -s * cellsAPixel);
    gl.uniform2f(at("pixelY"), s * cellsAPixel, c * cellsAPixel);
    gl.uniformMatrix3fv(at("toClip"), false, clipMatrix(camera, camera.x, camera.y, 0));
    for (const page of this.pages.values()) {
      if (!isSeen(camera, page.x, page.y)) continue;
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, page.heights);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, page.cells);
      gl.uniform2f(at("corner"), page.x * kTilesAside * kTileSize, page.y * kTilesAside * kTileSize);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
  }

  private drawPoints(camera: Camera, look: Look, pose: Pose): void {
    const { gl, pointProgram } = this;
    const at = (name: string) => gl.getUniformLocation(pointProgram, name);
    gl.useProgram(pointProgram);
    const m = clipMatrix(camera, camera.x - pose.x, camera.y - pose.y, pose.yaw);
    gl.uniformMatrix4fv(at("toClip"), false, [m[0], m[1], 0, 0, m[3], m[4], 0, 0, 0, 0, 1, 0, m[6], m[7], 0, 1]);
    gl.uniform1f(at("size"), Math.min(4, Math.max(1.6, camera.scale * 0.05)) * this.canvas.width / camera.width);
    gl.uniform1f(at("grey"), look.grey);
    const dark = look.theme === "dark";
    gl.uniform3fv(at("low"), unit(dark ? [130, 145, 160] : [110, 120, 132]));
    gl.uniform3fv(at("high"), unit(dark ? [255, 150, 210] : [190, 20, 110]));
    gl.drawArrays(gl.POINTS, 0, this.numPoints);
  }
}

const kCellBytes = new Uint8Array(4 * kTileCells);
const kHeights = new Float32Array(kTileCells);

function unit(colour: Rgb): Rgb {
  return colour.map(v => v / 255) as Rgb;
}

/// From m, turned by `yaw` and counted from `x`, `y` before the camera's middle, to clip space; by columns.
function clipMatrix(camera: Camera, x: number, y: number, yaw: number): number[] {
  const turn = camera.turn + yaw;
  const [kx, ky] = [2 * camera.scale / camera.width, 2 * camera.scale / camera.height];
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  const [cc, cs] = [Math.cos(camera.turn), Math.sin(camera.turn)];
  const [ox, oy] = [2 * camera.offsetX / camera.width, -2 * camera.offsetY / camera.height];
  return [kx * c, ky * s, 0, -kx * s, ky * c, 0, ox - kx * (cc * x - cs * y), oy - ky * (cs * x + cc * y), 1];
}

function isSeen(camera: Camera, x: number, y: number): boolean {
  const side = kTilesAside * kTileSize;
  const [sx, sy] = camera.toScreen((x + 0.5) * side, (y + 0.5) * side);
  const reach = side * camera.scale * 0.71;
  return sx > -reach && sy > -reach && sx < camera.width + reach && sy < camera.height + reach;
}

function program(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const made = gl.createProgram()!;
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(kind)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
      throw new Error(gl.getShaderInfoLog(shader) ?? "a shader does not compile");
  }
  gl.linkProgram(made);
  return made;
}
