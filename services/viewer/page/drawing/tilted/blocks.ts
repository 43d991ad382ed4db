// Obstacles and walls as boxes. The map has the class of a cell but no object height: an obstacle is lower than the
// vehicle, a wall is not. So boxes have one fixed height per class. Far away, one box stands for five by five cells.
import { kTilesAside } from "../page";
import { heightOf, kCells, kNoHeight, kTileCells, Tile, World } from "../../world";

const kObstacle = 3, kWall = 4;
const kHighs = [0, 0, 0, 0.7, 2];  // m, per class
const kCoarse = 5;                 // cells along a side of a far box
const kEnough = 4;                 // blocking cells out of 25 that make a box: a wall is a cell or two thick
export const kFaceFloats = 4 * 6;  // four points each: column, row in the page; m; brightness; cell's column, row

/// Side faces: x and y of both ends on a unit box, the step to the neighbouring cell, brightness.
const kSides: [number, number, number, number, number, number, number][] =
  [[1, 0, 1, 1, 1, 0, 0.76], [0, 1, 0, 0, -1, 0, 0.94], [1, 1, 0, 1, 0, 1, 0.94], [0, 0, 1, 0, 0, -1, 0.76]];
const kTop = 1.08, kFoot = 0.84;  // brightness; factor at the foot of a side

interface Known { revision: number; ground?: number; faces: (Float32Array | undefined)[] }

export class Blocks {
  private known = new WeakMap<Tile, Known>();

  constructor(private world: World) {}

  /// `level`: 0 one box per cell, 1 coarse boxes.
  facesOf(tile: Tile, level: number): Float32Array {
    const known = this.of(tile);
    return known.faces[level] ??= this.make(tile, level === 0 ? 1 : kCoarse);
  }

  /// m: the mean over the ground cells; for a tile without any, that of its neighbours, else its lowest cell.
  groundOf(tile: Tile): number {
    return this.of(tile).ground ??= this.ground(tile);
  }

  tileAt(x: number, y: number): Tile | undefined { return this.world.tileAt(x, y); }

  private of(tile: Tile): Known {
    let known = this.known.get(tile);
    if (!known || known.revision !== tile.revision) this.known.set(tile, known = { revision: tile.revision, faces: [] });
    return known;
  }

  private make(tile: Tile, size: number): Float32Array {
    const n = kCells / size, kinds = size === 1 ? tile.classes : coarse(tile.classes), floats: number[] = [];
    const ground = this.groundOf(tile);
    const column = (tile.x - Math.floor(tile.x / kTilesAside) * kTilesAside) * kCells;
    const row = (tile.y - Math.floor(tile.y / kTilesAside) * kTilesAside) * kCells;
    const high = (x: number, y: number) => x < 0 || y < 0 || x >= n || y >= n ? 0 : kHighs[kinds[y * n + x]] ?? 0;
    const point = (x: number, y: number, z: number, light: number, cell: number) =>
      floats.push(column + x * size, row + y * size, z, light, column + cell % kCells, row + Math.floor(cell / kCells));
    for (let y = 0; y < n; ++y) for (let x = 0; x < n; ++x) {
      const own = high(x, y);
      if (own === 0) continue;
      const cell = size === 1 ? y * n + x : cellOf(tile.classes, x, y, kinds[y * n + x]);
      for (let i = 0; i < 4; ++i) point(x + (i & 1), y + (i >> 1), ground + own, kTop, cell);
      for (const [ax, ay, bx, by, dx, dy, light] of kSides) {
        const beside = high(x + dx, y + dy);
        if (beside >= own) continue;
        for (const [z, shade] of [[ground + beside, light * kFoot], [ground + own, light]])
          for (const [px, py] of [[ax, ay], [bx, by]]) point(x + px, y + py, z, shade, cell);
      }
    }
    return new Float32Array(floats);
  }

  private ground(tile: Tile): number {
    const own = meanGround(tile);
    if (own !== null) return own;
    const near: number[] = [];
    for (let i = 0; i < 9; ++i) {
      const other = this.world.tileAt(tile.x + i % 3 - 1, tile.y + Math.floor(i / 3) - 1);
      const mean = other ? meanGround(other) : null;
      if (mean !== null) near.push(mean);
    }
    if (near.length > 0) return near.reduce((a, b) => a + b) / near.length;
    let lowest = Infinity;
    for (let i = 0; i < kTileCells; ++i) lowest = Math.min(lowest, heightOf(tile, i) ?? Infinity);
    return lowest === Infinity ? tile.zOrigin : lowest;
  }
}

/// The class of each box of five by five cells: the taller one, if enough cells have it.
function coarse(classes: Uint8Array): Uint8Array {
  const n = kCells / kCoarse, walls = new Uint8Array(n * n), all = new Uint8Array(n * n);
  for (let i = 0; i < kTileCells; ++i) {
    if (classes[i] !== kObstacle && classes[i] !== kWall) continue;
    const box = Math.floor(i / kCells / kCoarse) * n + Math.floor(i % kCells / kCoarse);
    ++all[box];
    if (classes[i] === kWall) ++walls[box];
  }
  return all.map((count, box) => count < kEnough ? 0 : 2 * walls[box] >= count ? kWall : kObstacle);
}

/// A cell of that class in a coarse box; it gives the box its colour.
function cellOf(classes: Uint8Array, x: number, y: number, kind: number): number {
  for (let i = 0; i < kCoarse * kCoarse; ++i) {
    const cell = (y * kCoarse + Math.floor(i / kCoarse)) * kCells + x * kCoarse + i % kCoarse;
    if (classes[cell] === kind) return cell;
  }
  return y * kCoarse * kCells + x * kCoarse;
}

function meanGround(tile: Tile): number | null {
  let sum = 0, n = 0;
  for (let i = 0; i < kTileCells; ++i) {
    if (tile.classes[i] === 0 || tile.classes[i] >= kObstacle || tile.heights[i] === kNoHeight) continue;
    sum += tile.heights[i];
    ++n;
  }
  return n === 0 ? null : tile.zOrigin + sum / n * 0.002;
}
