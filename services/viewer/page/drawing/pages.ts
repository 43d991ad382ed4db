// The map's cells as textures, one set per page (a square of tiles).
import { Area, kCellsAside, kTilesAside, Page } from "./page";
import { touch, touchBeside } from "./terrain";
import { kCells, kNoHeight, kTileCells, Tile, World } from "../world";

const kSizes = 1 + Math.floor(Math.log2(kCellsAside));  // mipmap levels of a picture
const kNone = 0;                             // unknown height: the initial content of a texture
const kZero = 1e-6;                          // m, stands for a height of exactly 0

export class Pages {
  readonly all = new Map<string, Page>();
  epoch = 0;  // us, origin of the times

  /// `smooth`: the texture filter for pictures drawn smaller.
  constructor(private gl: WebGL2RenderingContext, private world: World, private smooth: number) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  }

  /// Uploads the changes of the world to the textures.
  upload(): void {
    const { gl, world } = this;
    if (world.cleared) {
      for (const page of this.all.values()) for (const texture of texturesOf(page)) gl.deleteTexture(texture);
      this.all.clear();
      this.epoch = 0;
      world.cleared = false;
    }
    for (const tile of world.gone) this.uploadTile(tile, false);
    for (const tile of world.changed) this.uploadTile(tile, true);
    for (const page of this.all.values()) if (page.aged) this.uploadTimes(page);
    world.gone.clear();
    world.changed.clear();
  }

  bind(page: Page): void {
    const { gl } = this;
    for (const [i, texture] of texturesOf(page).entries()) {
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
      kHeights[i] = !isThere || tile.heights[i] === kNoHeight ? kNone : tile.zOrigin + tile.heights[i] * 0.002 || kZero;
    }
    if (this.epoch === 0) this.epoch = tile.utime;
    const [column, row] = [tile.x - px * kTilesAside, tile.y - py * kTilesAside];
    const put = (texture: WebGLTexture, format: number, type: number, values: ArrayBufferView) => {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, column * kCells, row * kCells, kCells, kCells, format, type, values);
    };
    page.tiles[row * kTilesAside + column] = isThere ? tile : undefined;
    touch(page, column, row);
    this.touchPagesBeside(px, py, column, row);
    page.unpainted = around(page.unpainted, column * kCells, row * kCells);
    gl.activeTexture(gl.TEXTURE0);
    put(page.cells, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE, kBytes);
    put(page.heights, gl.RED, gl.FLOAT, kHeights);
    page.seconds[row * kTilesAside + column] = (tile.utime - this.epoch) * 1e-6;
    page.aged = true;
  }

  private uploadTimes(page: Page): void {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, page.times);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kTilesAside, kTilesAside, gl.RED, gl.FLOAT, page.seconds);
    page.aged = false;
  }

  private touchPagesBeside(px: number, py: number, column: number, row: number): void {
    const last = kTilesAside - 1, beside = (place: number) => place === 0 ? [0, -1] : place === last ? [0, 1] : [0];
    for (const dx of beside(column)) for (const dy of beside(row)) {
      const other = dx || dy ? this.all.get(`${px + dx},${py + dy}`) : undefined;
      if (other) touchBeside(other, column - dx * kTilesAside, row - dy * kTilesAside);
    }
  }

  private newPage(x: number, y: number): Page {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0);
    const texture = (format: number, side: number, sizes = 1) => {
      const made = gl.createTexture()!;
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texStorage2D(gl.TEXTURE_2D, sizes, format, side, side);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      return made;
    };
    const picture = texture(gl.RGBA8, kCellsAside, kSizes);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, this.smooth);
    return { x, y, picture, cells: texture(gl.RGBA8UI, kCellsAside), times: texture(gl.R32F, kTilesAside),
      heights: texture(gl.R32F, kCellsAside), seconds: new Float32Array(kTilesAside * kTilesAside), aged: false, unpainted: null, paintedAs: "", hasSmaller: false, tiles: [], squares: new Map() };
  }
}

/// In the order of their texture units.
function texturesOf(page: Page): WebGLTexture[] {
  return [page.cells, page.heights, page.times, page.picture];
}

/// Extends the area by a tile and the cells around it, because the tile changes their relief.
function around(area: Area | null, column: number, row: number): Area {
  const { left, low, right, high } = area ?? { left: kCellsAside, low: kCellsAside, right: 0, high: 0 };
  return { left: Math.max(0, Math.min(left, column - 1)), low: Math.max(0, Math.min(low, row - 1)),
    right: Math.min(kCellsAside, Math.max(right, column + kCells + 1)), high: Math.min(kCellsAside, Math.max(high, row + kCells + 1)) };
}

const kBytes = new Uint8Array(4 * kTileCells);
const kHeights = new Float32Array(kTileCells);
