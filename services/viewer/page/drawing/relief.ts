// The tilted view by WebGL2: the ground as nets over the tiles, boxes on what blocks, curbs as walls of their height.
// Far tiles have coarse nets and no boxes; beyond the reach there is nothing.
import { Blocks } from "./blocks";
import { Camera } from "./camera";
import { wallsOf } from "./curb_walls";
import { kPageSize, kTilesAside, Page, Pages } from "./pages";
import { Program } from "./program";
import { kBlockFragment, kBlockVertex, kNetFragment, kNetVertex, kSolidFragment, kSolidVertex } from "./relief_shaders";
import { kCells, kTileSize, Tile, World } from "../world";

const kNets = [25, 5, 1];          // squares aside
const kFine = 100, kMiddle = 12;    // pixels that a tile must be wide for the nets before the last
const kMostFine = 90;              // tiles
const kMostFaces = 60_000;
const kReach = 6;                  // of the eye's distance

interface Seen { tile: Tile; width: number; net: number }
interface Net { indices: WebGLBuffer; count: number }

export class Relief {
  private nets: Net[];
  private net: Program;
  private block: Program;
  private solid: Program;
  private instances: WebGLBuffer;
  private walls: WebGLBuffer;
  private numWalls = -1;  // points; -1: of other curbs
  private blocks: Blocks;

  constructor(private gl: WebGL2RenderingContext, private world: World, private pages: Pages) {
    this.blocks = new Blocks(world);
    this.net = new Program(gl, kNetVertex, kNetFragment, ["tile"]);
    this.block = new Program(gl, kBlockVertex, kBlockFragment, ["face"]);
    this.solid = new Program(gl, kSolidVertex, kSolidFragment, ["point"]);
    this.nets = kNets.map(n => netOf(gl, n));
    this.instances = gl.createBuffer()!;
    this.walls = gl.createBuffer()!;
  }

  curbsChanged(): void { this.numWalls = -1; }

  /// `style` sets the uniforms of kPicture, `paint` brings a page's picture up to date; `curbs`: their colour, or null.
  draw(camera: Camera, style: (program: Program) => void, paint: (page: Page) => void, cells: boolean, curbs: number[] | null, grey: number): void {
    const { gl } = this, toClip = camera.matrix(), reach = kReach;
    gl.enable(gl.DEPTH_TEST);
    if (cells) {
      const seen = byPage(this.look(camera), this.pages);
      for (const page of seen.keys()) paint(page);
      for (const program of [this.net, this.block]) {
        program.use();
        style(program);
        gl.uniformMatrix4fv(program.at("toClip"), false, toClip);
        gl.uniform1f(program.at("reach"), reach);
      }
      for (const [page, tiles] of seen) {
        this.pages.bind(page);
        this.drawNets(page, tiles);
        this.drawBlocks(page, tiles);
      }
    }
    if (curbs) {
      this.solid.use();
      gl.uniformMatrix4fv(this.solid.at("toClip"), false, toClip);
      gl.uniform4fv(this.solid.at("ink"), curbs);
      gl.uniform1f(this.solid.at("reach"), reach);
      gl.uniform1f(this.solid.at("grey"), grey);
      this.drawWalls();
    }
    gl.disable(gl.DEPTH_TEST);
  }

  /// The tiles in view, the widest on the screen first, with their nets.
  private look(camera: Camera): Seen[] {
    const [c, s] = [Math.cos(camera.turn), Math.sin(camera.turn)];
    const [rise, far] = [Math.sin(camera.tilt), camera.distance];
    const seen: Seen[] = [];
    for (const tile of this.world.tiles.values()) {
      const [x, y] = [(tile.x + 0.5) * kTileSize, (tile.y + 0.5) * kTileSize];
      const w = 1 + (s * (x - camera.x) + c * (y - camera.y)) * rise / far;
      if (w < 0.1 || w > kReach) continue;
      const width = kTileSize * camera.scale / w, [sx, sy] = camera.toScreen(x, y);
      if (sx < -width || sy < -width || sx > camera.width + width || sy > camera.height + 2 * width) continue;
      seen.push({ tile, width, net: 2 });
    }
    seen.sort((a, b) => b.width - a.width);
    seen.forEach((one, i) => { one.net = one.width > kFine && i < kMostFine ? 0 : one.width > kMiddle ? 1 : 2; });
    return seen;
  }

  private drawNets(page: Page, tiles: Seen[]): void {
    const { gl, net } = this;
    net.use();
    gl.uniform2f(net.at("corner"), page.x * kPageSize, page.y * kPageSize);
    const nets = new Map(tiles.map(({ tile, net }) => [`${tile.x},${tile.y}`, net]));
    const coarser = (tile: Tile, dx: number, dy: number, own: number) => (nets.get(`${tile.x + dx},${tile.y + dy}`) ?? own) > own;
    kNets.forEach((squares, level) => {
      const values: number[] = [];
      for (const { tile, net } of tiles) {
        if (net !== level) continue;
        const edges = (coarser(tile, -1, 0, net) ? 1 : 0) | (coarser(tile, 1, 0, net) ? 2 : 0) |
          (coarser(tile, 0, -1, net) ? 4 : 0) | (coarser(tile, 0, 1, net) ? 8 : 0);
        values.push((tile.x - page.x * kTilesAside) * kCells, (tile.y - page.y * kTilesAside) * kCells, this.blocks.of(tile).ground, edges);
      }
      if (values.length === 0) return;
      this.fill(new Float32Array(values));
      gl.uniform1i(net.at("net"), squares);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.nets[level].indices);
      gl.drawElementsInstanced(gl.TRIANGLES, this.nets[level].count, gl.UNSIGNED_SHORT, 0, values.length / 4);
    });
    gl.vertexAttribDivisor(0, 0);
  }

  private drawBlocks(page: Page, tiles: Seen[]): void {
    const { gl, block } = this, parts: Float32Array[] = [];
    let faces = 0;
    for (const { tile, net } of tiles) {
      const shape = this.blocks.of(tile);
      if (net === 2 || faces + shape.faces.length / 4 > kMostFaces) continue;
      parts.push(shape.faces);
      faces += shape.faces.length / 4;
    }
    if (faces === 0) return;
    const all = new Float32Array(4 * faces);
    let at = 0;
    for (const part of parts) { all.set(part, at); at += part.length; }
    block.use();
    gl.uniform2f(block.at("corner"), page.x * kPageSize, page.y * kPageSize);
    this.fill(all);
    gl.enable(gl.CULL_FACE);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, faces);
    gl.disable(gl.CULL_FACE);
    gl.vertexAttribDivisor(0, 0);
  }

  /// One vec4 an instance.
  private fill(values: Float32Array): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(0, 1);
  }

  private drawWalls(): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.walls);
    if (this.numWalls < 0) {
      const points = wallsOf(this.world.curbs.values());
      gl.bufferData(gl.ARRAY_BUFFER, points, gl.DYNAMIC_DRAW);
      this.numWalls = points.length / 4;
    }
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.TRIANGLES, 0, this.numWalls);
  }
}

function byPage(seen: Seen[], pages: Pages): Map<Page, Seen[]> {
  const found = new Map<Page, Seen[]>();
  for (const one of seen) {
    const page = pages.all.get(`${Math.floor(one.tile.x / kTilesAside)},${Math.floor(one.tile.y / kTilesAside)}`);
    if (!page) continue;
    const list = found.get(page);
    if (list) list.push(one);
    else found.set(page, [one]);
  }
  return found;
}

function netOf(gl: WebGL2RenderingContext, n: number): Net {
  const indices: number[] = [];
  for (let y = 0; y < n; ++y) for (let x = 0; x < n; ++x) {
    const at = y * (n + 1) + x;
    indices.push(at, at + 1, at + n + 1, at + 1, at + n + 2, at + n + 1);
  }
  const buffer = gl.createBuffer()!;
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(indices), gl.STATIC_DRAW);
  return { indices: buffer, count: indices.length };
}
