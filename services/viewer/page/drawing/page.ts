// A page: a square of the map's tiles with its textures and meshes.
import { Distant } from "./distant";
import { kCells, kTileSize, Tile } from "../world";

export const kTilesAside = 32;               // of a page: 96 m
export const kCellsAside = kTilesAside * kCells;
export const kPageSize = kTilesAside * kTileSize;  // m

/// A range of cells; `right` and `high` are exclusive.
export interface Area { left: number; low: number; right: number; high: number }

/// The textures of every cell; only of a page that is, or recently was, seen close up. `cells`: class, cost, confidence,
/// and 255 where a tile is. `heights`: m, kNone. `picture`: the cells' colours (Painter), out of date within `unpainted`.
/// `used`: number of the picture of the map that it was needed for last.
export interface Close {
  cells: WebGLTexture; heights: WebGLTexture; picture: WebGLTexture; unpainted: Area | null; paintedAs: string;
  hasSmaller: boolean; used: number;
}

/// `times`: of each tile's newest points, s. `seconds`: the content for `times`; `aged`: it is not uploaded yet.
/// `tiles`: by row and column. `squares`: the quadtree nodes of the tilted view, by squareKey().
export interface Page {
  x: number; y: number; times: WebGLTexture; seconds: Float32Array; aged: boolean;
  close: Close | null; distant: Distant | null;
  tiles: (Tile | undefined)[]; squares: Map<number, Square>;
}

/// A square of tiles. `net`: the points of its mesh; `stale`: a tile changed since they were made.
export interface Square {
  page: Page; level: number; column: number; row: number;  // tiles in the page
  stale: boolean;
  net: WebGLBuffer | null;
  boxes: (Boxes | null)[];  // fine, coarse
  used: number;             // number of the picture that drew it last
}

/// The boxes of some tiles. `buffer` holds `faces` faces.
export interface Boxes { buffer: WebGLBuffer; faces: number }
