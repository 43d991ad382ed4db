// What blocks, as boxes. The map knows the class of a cell and not its height: an obstacle is lower than the vehicle, a
// wall is not; so the boxes are symbols of the class, of one height each.
import { kTilesAside } from "./pages";
import { heightOf, kCells, kNoHeight, kTileCells, Tile, World } from "../world";

const kObstacle = 3, kWall = 4;
const kHighs = [0, 0, 0, 7, 20];  // dm, by class
const kSides: [number, number, number][] = [[1, 1, 0], [2, -1, 0], [3, 0, 1], [4, 0, -1]];

export interface Shape {
  ground: number;       // m, where the tile shows ground; else the lowest that it knows
  faces: Float32Array;  // of four values each: kBlockVertex
}

export class Blocks {
  private shapes = new WeakMap<Tile, { revision: number; shape: Shape }>();

  constructor(private world: World) {}

  of(tile: Tile): Shape {
    const known = this.shapes.get(tile);
    if (known && known.revision === tile.revision) return known.shape;
    const shape = this.make(tile);
    this.shapes.set(tile, { revision: tile.revision, shape });
    return shape;
  }

  private make(tile: Tile): Shape {
    const ground = this.groundOf(tile), faces: number[] = [];
    const column = (tile.x - Math.floor(tile.x / kTilesAside) * kTilesAside) * kCells;
    const row = (tile.y - Math.floor(tile.y / kTilesAside) * kTilesAside) * kCells;
    const high = (x: number, y: number) => x < 0 || y < 0 || x >= kCells || y >= kCells ? 0 : kHighs[tile.classes[y * kCells + x]] ?? 0;
    for (let i = 0; i < kTileCells; ++i) {
      if (tile.classes[i] !== kObstacle && tile.classes[i] !== kWall) continue;
      const [x, y] = [i % kCells, Math.floor(i / kCells)], own = high(x, y);
      faces.push(column + x, row + y, ground, 8 * own);
      for (const [side, dx, dy] of kSides) if (high(x + dx, y + dy) < own) faces.push(column + x, row + y, ground, 8 * own + side);
    }
    return { ground, faces: new Float32Array(faces) };
  }

  /// The mean of the cells that show ground; of a tile without any, its neighbours'; else its lowest cell.
  private groundOf(tile: Tile): number {
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

function meanGround(tile: Tile): number | null {
  let sum = 0, n = 0;
  for (let i = 0; i < kTileCells; ++i) {
    if (tile.classes[i] === 0 || tile.classes[i] >= kObstacle || tile.heights[i] === kNoHeight) continue;
    sum += tile.heights[i];
    ++n;
  }
  return n === 0 ? null : tile.zOrigin + sum / n * 0.002;
}
