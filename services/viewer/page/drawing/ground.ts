// The map's cells and the LiDAR's points in WebGL2: the view from above; Relief draws the tilted one.
import { Camera } from "./camera";
import { CloudPoints } from "./cloud_points";
import { kDistant, paintDistant } from "./distant";
import { Painter } from "./painter";
import { kCellsAside, kPageSize, Page } from "./page";
import { Pages } from "./pages";
import { classColours, CloudColour, kPaint, Mode, pointRamp, ramp, Rgb, Theme } from "./palette";
import { Program, unit } from "./program";
import { Relief } from "./tilted/relief";
import { drawsInSoftware } from "./software";
import { kFarFragment, kNearFragment, kPageFragment, kPageVertex, kPaintVertex, kPointFragment, kPointVertex, kSheetFragment } from "./shaders";
import { kCellSize, Pose, World } from "../world";

export interface Look {
  theme: Theme; mode: Mode; grid: boolean; relief: boolean; points: boolean; cloud: boolean; curbs: boolean; markings: boolean;
  byIntensity: boolean;     // points; otherwise by height
  cloudBy: CloudColour;
  range: [number, number];  // m, ends of the height ramp
  now: number;              // us, reference time of the ages
  grey: number;             // 0 .. 1: how stale the map is
  greyPoints: number;       // the same of the LiDAR's points
  draft: boolean;           // draws the tilted view coarser and faster
  paper: Rgb;
}

const kScanKept = 1.5e6;  // us of the drive for which a scan is shown, where it was measured

/// `cellWidth`: of the page's nearest cells, CSS pixels.
export type Paint = (page: Page, cellWidth: number) => WebGLTexture;

export class Ground {
  private gl!: WebGL2RenderingContext;
  private pages!: Pages;
  private painter!: Painter;
  private relief: Relief | null = null;  // made at the first tilt: compiling shaders takes time
  private isSlow = false;
  private flat!: { any: Program; far: Program; near: Program };  // for every look, and the faster ones
  private point!: Program;
  private sheet!: Program;
  private marks!: WebGLTexture;
  private points!: WebGLBuffer;
  private numPoints = 0;
  private cloud!: CloudPoints;
  private lost = false;

  /// Throws if there is no WebGL2.
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

  curbsChanged(): void { this.relief?.curbsChanged(); }
  markingsChanged(): void { this.relief?.markingsChanged(); }

  private setUp(): void {
    const isSlow = this.isSlow = drawsInSoftware();
    const gl = this.canvas.getContext("webgl2", { antialias: !isSlow });
    if (!gl) throw new Error("The map cannot be drawn here: this browser has no WebGL2. Switch its graphics acceleration on, or take a current Firefox, Chrome, Edge or Safari");
    this.gl = gl;
    this.pages = new Pages(gl, this.world, isSlow ? gl.LINEAR_MIPMAP_NEAREST : gl.LINEAR_MIPMAP_LINEAR);
    this.painter = new Painter(gl, this.pages);
    this.relief = null;
    const [any, far, near] = [kPageFragment, kFarFragment, kNearFragment].map(fragment => new Program(gl, kPageVertex, fragment));
    this.flat = { any, far: far.prepare(), near: near.prepare() };
    this.point = new Program(gl, kPointVertex, kPointFragment, ["point"]);
    this.sheet = new Program(gl, kPaintVertex, kSheetFragment);
    if (isSlow) this.sheet.prepare();
    this.marks = gl.createTexture()!;
    this.points = gl.createBuffer()!;
    this.cloud = new CloudPoints(gl, isSlow);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  draw(camera: Camera, look: Look): void {
    if (this.lost) return;
    const { gl, canvas, world } = this;
    this.pages.upload();
    if (world.scanChanged) this.uploadScan();
    const paint = this.painting(camera, look);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (camera.isTilted) {
      const curbs = look.curbs ? [...unit(classColours(look.theme, look.mode)[2]!), 1] : null;
      const markings = look.markings ? [...unit(kPaint[look.theme]), 1] : null;
      this.relief ??= new Relief(gl, world, this.pages, this.isSlow);
      this.relief.draw(camera, program => this.style(program, look), paint, look.grid, isPlain(look), curbs, markings, look.grey, look.draft);
    } else if (look.grid) {
      this.drawPages(camera, look, paint);
    }
    if (look.cloud) this.cloud.draw(world.cloud, camera, look, canvas.width / camera.width);
    const pose = world.scanPose, age = pose && world.state?.pose ? world.state.pose.utime - pose.utime : 0;
    if (look.points && pose && age < kScanKept && this.numPoints > 0) this.drawPoints(camera, look, pose);
    this.pages.forget();
  }

  /// Lays a canvas of the same size over what was drawn.
  lay(canvas: HTMLCanvasElement): void {
    if (this.lost) return;
    const { gl, sheet } = this;
    sheet.use();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.marks);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.uniform1i(sheet.at("picture"), 0);
    gl.disableVertexAttribArray(0);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  private uploadScan(): void {
    const { gl, world } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.points);
    gl.bufferData(gl.ARRAY_BUFFER, world.scan, gl.DYNAMIC_DRAW);
    this.numPoints = world.scan.length / 4;
    world.scanChanged = false;
  }

  /// Brings the picture of a page up to date and returns it.
  private painting(camera: Camera, look: Look): Paint {
    const { gl } = this, { theme, mode, relief, range } = look;
    const name = [theme, mode, relief, ...mode === "height" ? range : []].join(" ");
    const isSmall = camera.isTilted || this.cellWidth(camera) < 1.5;
    const style = (program: Program) => {
      gl.uniform1i(program.at("cells"), 0);
      gl.uniform1i(program.at("heights"), 1);
      this.ramp(program, look);
      gl.uniform4fv(program.at("classes"), classColours(theme, mode).flatMap(c => c ? [...unit(c), 1] : [0, 0, 0, 0]));
      gl.uniform2fv(program.at("range"), range);
      gl.uniform1f(program.at("relief"), relief ? 1 : 0);
    };
    return (page, cellWidth) => cellWidth * devicePixelRatio < kDistant ? paintDistant(gl, page, name, look, this.pages.smooth)
      : this.painter.paint(page, name, style, isSmall);
  }

  private ramp(program: Program, look: Look): void {
    const { gl } = this;
    gl.uniform1i(program.at("mode"), ["height", "cost", "confidence", "age"].indexOf(look.mode) + 1);
    gl.uniform3fv(program.at("ramp"), ramp(look.mode).flatMap(unit));
  }

  /// Sets the uniforms of kPicture, and the textures that the meshes need.
  private style(program: Program, look: Look): void {
    const { gl } = this;
    ["cells", "heights", "times", "picture"].forEach((name, i) => gl.uniform1i(program.at(name), i));
    this.ramp(program, look);
    gl.uniform1f(program.at("now"), (look.now - this.pages.epoch) * 1e-6);
    gl.uniform1f(program.at("grey"), look.grey);
    gl.uniform3fv(program.at("paper"), unit(look.paper));
    gl.uniform1f(program.at("cellsAside"), kCellsAside);
  }

  /// Width of a cell in pixels of the screen.
  private cellWidth(camera: Camera): number {
    return camera.scale * kCellSize * this.canvas.width / camera.width;
  }

  private drawPages(camera: Camera, look: Look, paint: Paint): void {
    const { gl } = this;
    const flat = !isPlain(look) ? this.flat.any : this.cellWidth(camera) < 1 ? this.flat.far : this.flat.near;
    const seen = [...this.pages.all.values()].filter(page => isSeen(camera, page.x, page.y));
    if (seen.length === 0) return;
    const pictures = seen.map(page => paint(page, camera.scale * kCellSize));
    flat.use();
    this.style(flat, look);
    gl.uniform1f(flat.at("side"), kPageSize);
    gl.uniformMatrix4fv(flat.at("toClip"), false, camera.matrix());
    gl.disableVertexAttribArray(0);
    gl.disable(gl.BLEND);
    for (const [i, page] of seen.entries()) {
      this.pages.bind(page, pictures[i]);
      gl.uniform2f(flat.at("corner"), page.x * kPageSize - camera.x, page.y * kPageSize - camera.y);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    gl.enable(gl.BLEND);
  }

  private drawPoints(camera: Camera, look: Look, pose: Pose): void {
    const { gl, point } = this;
    point.use();
    gl.uniformMatrix4fv(point.at("toClip"), false, camera.matrix());
    gl.uniformMatrix4fv(point.at("toMap"), false, matrixOf(pose, camera));
    gl.uniform1f(point.at("size"), Math.min(4, Math.max(1.6, camera.scale * 0.05)) * this.canvas.width / camera.width);
    gl.uniform1f(point.at("grey"), look.greyPoints);
    gl.uniform1i(point.at("byIntensity"), look.byIntensity ? 1 : 0);
    gl.uniform3fv(point.at("ramp"), pointRamp(look.theme).flatMap(unit));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.points);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 0, 0);
    if (camera.isTilted) gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.POINTS, 0, this.numPoints);
    gl.disable(gl.DEPTH_TEST);
  }
}

/// Whether the pictures of the pages are shown unchanged.
function isPlain(look: Look): boolean {
  return look.grey === 0 && look.mode !== "age";
}

/// Rotation and translation from base_link to m relative to the camera, column-major: yaw, pitch, roll.
function matrixOf({ x, y, z, roll, pitch, yaw }: Pose, camera: Camera): number[] {
  const [cr, sr, cp, sp, cy, sy] = [roll, pitch, yaw].flatMap(a => [Math.cos(a), Math.sin(a)]);
  return [cy * cp, sy * cp, -sp, 0, cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr, 0,
    cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr, 0, x - camera.x, y - camera.y, z, 1];
}

function isSeen(camera: Camera, x: number, y: number): boolean {
  const [sx, sy] = camera.toScreen((x + 0.5) * kPageSize, (y + 0.5) * kPageSize);
  const reach = kPageSize * camera.scale * 0.71;
  return sx > -reach && sy > -reach && sx < camera.width + reach && sy < camera.height + reach;
}
