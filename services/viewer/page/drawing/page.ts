// A page: a square of the map's tiles, and what is drawn of it.
import { kCells, kTileSize, Tile } from "../world";

export const kTilesAside = 32;               // of a page: 96 m
export const kCellsAside = kTilesAside * kCells;
export const kPageSize = kTilesAside * kTileSize;  // m

/// From column, row on, up to column, row, which are not in it.
export interface Area { left: number; low: number; right: number; high: number }

/// `cells`: class, cost, confidence, 255 where a tile is. `heights`: m, kNone. `times`: of each tile's newest points, s.
/// `seconds`: what `times` is to hold, which it does not if `aged`. `picture`: the cells' colours (Painter), which lacks
/// what became other in `unpainted`. `tiles`: by row and column, and `squares` of them by squareKey(): what the tilted
/// view draws.
export interface Page {
  x: number; y: number; cells: WebGLTexture; heights: WebGLTexture; times: WebGLTexture; picture: WebGLTexture;
  seconds: Float32Array; aged: boolean; unpainted: Area | null; paintedAs: string; hasSmaller: boolean;
  tiles: (Tile | undefined)[]; squares: Map<number, Square>;
}

/// A square of tiles. `net`: its points; `stale`: a tile became other since they were made.
export interface Square {
  page: Page; level: number; column: number; row: number;  // tiles in the page
  stale: boolean;
  net: WebGLBuffer | null;
  boxes: (Boxes | null)[];  // fine, coarse
  used: number;             // when it was drawn last
}

/// What blocks, of some tiles. `buffer` holds `faces` faces.
export interface Boxes { buffer: WebGLBuffer; faces: number }
