// The map's cells in textures: of a page each, a square of tiles.
import { kCells, kNoHeight, kTileCells, kTileSize, Tile, World } from "../world";

export const kTilesAside = 32;               // of a page: 96 m
export const kCellsAside = kTilesAside * kCells;
export const kPageSize = kTilesAside * kTileSize;  // m
const kNone = -1e9;                          // height where none is known

/// `cells`: class, cost, confidence, 255 where a tile is. `heights`: m. `times`: of each tile's newest points, s.
export interface Page { x: number; y: number; cells: WebGLTexture; heights: WebGLTexture; times: WebGLTexture }

export class Pages {
  readonly all = new Map<string, Page>();
  epoch = 0;  // us, from which the times count

  constructor(private gl: WebGL2RenderingContext, private world: World) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  }

  /// Takes what became other in the world into the textures.
  upload(): void {
    const { gl, world } = this;
    if (world.cleared) {
      for (const { cells, heights, times } of this.all.values()) for (const texture of [cells, heights, times]) gl.deleteTexture(texture);
      this.all.clear();
      this.epoch = 0;
      world.cleared = false;
    }
    for (const tile of world.gone) this.uploadTile(tile, false);
    for (const tile of world.changed) this.uploadTile(tile, true);
    world.gone.clear();
    world.changed.clear();
  }

  bind(page: Page): void {
    const { gl } = this;
    for (const [i, texture] of [page.cells, page.heights, page.times].entries()) {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    }
  }

  private uploadTile(tile: Tile, isThere: boolean): void {
    const { gl } = this;
    const [px, py] = [Math.floor(tile.x / kTilesAside), Math.floor(tile.y / kTilesAside)];
    const key = `${px},${py}`;
    let page = this.all.get(key);
    if (!page) this.all.set(key, page = this.newPage(px, py));
    for (let i = 0; i < kTileCells; ++i) {
      kBytes[4 * i] = tile.classes[i];
      kBytes[4 * i + 1] = tile.costs[i];
      kBytes[4 * i + 2] = tile.confidences[i];
      kBytes[4 * i + 3] = isThere ? 255 : 0;
      kHeights[i] = !isThere || tile.heights[i] === kNoHeight ? kNone : tile.zOrigin + tile.heights[i] * 0.002;
    }
    if (this.epoch === 0) this.epoch = tile.utime;
    const [column, row] = [tile.x - px * kTilesAside, tile.y - py * kTilesAside];
    const put = (texture: WebGLTexture, side: number, format: number, type: number, values: ArrayBufferView) => {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, column * side, row * side, side, side, format, type, values);
    };
    gl.activeTexture(gl.TEXTURE0);
    put(page.cells, kCells, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE, kBytes);
    put(page.heights, kCells, gl.RED, gl.FLOAT, kHeights);
    put(page.times, 1, gl.RED, gl.FLOAT, new Float32Array([(tile.utime - this.epoch) * 1e-6]));
  }

  private newPage(x: number, y: number): Page {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0);
    const texture = (format: number, side: number) => {
      const made = gl.createTexture()!;
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texStorage2D(gl.TEXTURE_2D, 1, format, side, side);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      return made;
    };
    const page = { x, y, cells: texture(gl.RGBA8UI, kCellsAside), times: texture(gl.R32F, kTilesAside), heights: texture(gl.R32F, kCellsAside) };
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kCellsAside, kCellsAside, gl.RED, gl.FLOAT, new Float32Array(kCellsAside * kCellsAside).fill(kNone));
    return page;
  }
}

const kBytes = new Uint8Array(4 * kTileCells);
const kHeights = new Float32Array(kTileCells);
