// The map's cells as textures, one set per page (a square of tiles). A page has the textures of its cells only while it
// is seen close up.
import { Area, Close, kCellsAside, kTilesAside, Page } from "./page";
import { touch, touchBeside } from "./tilted/terrain";
import { kCells, kNoHeight, kTileCells, Tile, World } from "../world";

const kSizes = 1 + Math.floor(Math.log2(kCellsAside));  // mipmap levels of a picture
const kNone = 0;                             // unknown height: the initial content of a texture
const kZero = 1e-6;                          // m, stands for a height of exactly 0
const kMaxClose = 40;                       // pages, of 8 MB each, that are kept without being in view

export class Pages {
  readonly all = new Map<string, Page>();
  epoch = 0;  // us, origin of the times
  private picture = 0;  // number of the picture of the map that is drawn

  /// `smooth`: the texture filter for pictures drawn smaller.
  constructor(private gl: WebGL2RenderingContext, private world: World, readonly smooth: number) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  }

  /// Uploads the changes of the world to the textures.
  upload(): void {
    const { gl, world } = this;
    ++this.picture;
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

  /// Binds the textures; `picture` is one of the page's two.
  bind(page: Page, picture: WebGLTexture): void {
    const { gl } = this;
    for (const [i, texture] of [page.close?.cells ?? null, page.close?.heights ?? null, page.times, picture].entries()) {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    }
  }

  /// The textures of the page's cells, for a picture that needs them.
  closeOf(page: Page): Close {
    page.close ??= this.newClose(page);
    page.close.used = this.picture;
    return page.close;
  }

  /// Frees the cells' textures of the pages that were not needed for the longest time.
  forget(): void {
    const kept = [...this.all.values()].filter(page => page.close);
    if (kept.length <= kMaxClose) return;
    kept.sort((a, b) => a.close!.used - b.close!.used);
    for (const page of kept.slice(0, kept.length - kMaxClose)) {
      if (page.close!.used === this.picture) return;
      for (const texture of [page.close!.cells, page.close!.heights, page.close!.picture]) this.gl.deleteTexture(texture);
      page.close = null;
    }
  }

  private uploadTile(tile: Tile, isThere: boolean): void {
    const [px, py] = [Math.floor(tile.x / kTilesAside), Math.floor(tile.y / kTilesAside)];
    const key = `${px},${py}`;
    let page = this.all.get(key);
    if (!page) this.all.set(key, page = this.newPage(px, py));
    if (this.epoch === 0) this.epoch = tile.utime;
    const [column, row] = [tile.x - px * kTilesAside, tile.y - py * kTilesAside], place = row * kTilesAside + column;
    page.tiles[place] = isThere ? tile : undefined;
    touch(page, column, row);
    this.touchPagesBeside(px, py, column, row);
    page.distant?.stale?.add(place);
    page.seconds[place] = (tile.utime - this.epoch) * 1e-6;
    page.aged = true;
    if (page.close) this.uploadCells(page.close, tile, isThere, column, row);
  }

  private uploadCells(close: Close, tile: Tile, isThere: boolean, column: number, row: number): void {
    const { gl } = this;
    for (let i = 0; i < kTileCells; ++i) {
      kBytes[4 * i] = tile.classes[i];
      kBytes[4 * i + 1] = tile.costs[i];
      kBytes[4 * i + 2] = tile.confidences[i];
      kBytes[4 * i + 3] = isThere ? 255 : 0;
      kHeights[i] = !isThere || tile.heights[i] === kNoHeight ? kNone : tile.zOrigin + tile.heights[i] * 0.002 || kZero;
    }
    const put = (texture: WebGLTexture, format: number, type: number, values: ArrayBufferView) => {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, column * kCells, row * kCells, kCells, kCells, format, type, values);
    };
    close.unpainted = around(close.unpainted, column * kCells, row * kCells);
    gl.activeTexture(gl.TEXTURE0);
    put(close.cells, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE, kBytes);
    put(close.heights, gl.RED, gl.FLOAT, kHeights);
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
    return { x, y, times: this.texture(this.gl.R32F, kTilesAside), seconds: new Float32Array(kTilesAside * kTilesAside), aged: false,
      close: null, distant: null, tiles: [], squares: new Map() };
  }

  private newClose(page: Page): Close {
    const { gl } = this, picture = this.texture(gl.RGBA8, kCellsAside, kSizes);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, this.smooth);
    const close: Close = { cells: this.texture(gl.RGBA8UI, kCellsAside), heights: this.texture(gl.R32F, kCellsAside), picture,
      unpainted: null, paintedAs: "", hasSmaller: false, used: 0 };
    page.tiles.forEach((tile, place) => { if (tile) this.uploadCells(close, tile, true, place % kTilesAside, Math.floor(place / kTilesAside)); });
    return close;
  }

  private texture(format: number, side: number, sizes = 1): WebGLTexture {
    const { gl } = this, made = gl.createTexture()!;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texStorage2D(gl.TEXTURE_2D, sizes, format, side, side);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return made;
  }
}

function texturesOf({ times, close, distant }: Page): WebGLTexture[] {
  return [times, ...close ? [close.cells, close.heights, close.picture] : [], ...distant ? [distant.picture] : []];
}

/// Extends the area by a tile and the cells around it, because the tile changes their relief.
function around(area: Area | null, column: number, row: number): Area {
  const { left, low, right, high } = area ?? { left: kCellsAside, low: kCellsAside, right: 0, high: 0 };
  return { left: Math.max(0, Math.min(left, column - 1)), low: Math.max(0, Math.min(low, row - 1)),
    right: Math.min(kCellsAside, Math.max(right, column + kCells + 1)), high: Math.min(kCellsAside, Math.max(high, row + kCells + 1)) };
}

const kBytes = new Uint8Array(4 * kTileCells);
const kHeights = new Float32Array(kTileCells);
