// The ground of a page as a tree of nets: a square of 2^k tiles aside has 25 squares aside, whatever its size. What is
// near is drawn by small squares and what is far by large ones, so that a picture has as many triangles as the screen
// is worth and not as many as the map has cells. A net's edge hangs down a little, which closes the gap to a coarser one.
import { Blocks } from "./blocks";
import { Camera } from "./camera";
import { kTilesAside, Page, Square } from "./page";
import { kCells, kNoHeight, kTileSize, Tile } from "../world";

export const kLevels = 6;           // of squares: 1, 2 .. 32 tiles aside
const kAside = kCells + 1;          // points of a net
const kHill = 5;                    // m, that ground may be higher or lower than where the camera looks
const kFloats = 3;                  // of a point: column and row in the page, m

/// As it is seen: pixels that it is wide.
export interface Seen { square: Square; width: number; w: number }

export function squareKey(level: number, column: number, row: number): number {
  return (level * kTilesAside + (row >> level)) * kTilesAside + (column >> level);
}

/// The squares of all sizes over a tile of a page that became other.
export function touch(page: Page, column: number, row: number): void {
  for (let level = 0; level < kLevels; ++level) {
    const key = squareKey(level, column, row), known = page.squares.get(key);
    if (known) known.stale = true;
    else page.squares.set(key, { page, level, column: column >> level << level, row: row >> level << level, stale: true,
      net: null, boxes: [null, null], used: 0 });
  }
}

/// Those of the page that end at a tile beyond its edge, which they take heights from.
export function touchBeside(page: Page, column: number, row: number): void {
  for (let level = 0; level < kLevels; ++level) {
    const inside = (place: number) => Math.min(kTilesAside - 1, Math.max(0, place));
    const known = page.squares.get(squareKey(level, inside(column), inside(row)));
    if (known) known.stale = true;
  }
}

/// The squares of the pages that cover what is in view, the nearest first; none is wider than `widest` pixels, but for
/// single tiles. `reach`: of the eye's distance.
export function squaresInView(pages: Iterable<Page>, camera: Camera, widest: number, reach: number): Seen[] {
  const [c, s] = [Math.cos(camera.turn), Math.sin(camera.turn)];
  const [rise, far] = [Math.sin(camera.tilt), camera.distance], seen: Seen[] = [];
  const visit = (page: Page, level: number, column: number, row: number): void => {
    const square = page.squares.get(squareKey(level, column, row));
    if (!square) return;
    const side = (1 << level) * kTileSize, radius = 0.71 * side;
    const x = (page.x * kTilesAside + column) * kTileSize + side / 2 - camera.x;
    const y = (page.y * kTilesAside + row) * kTileSize + side / 2 - camera.y;
    const middle = 1 + (s * x + c * y) * rise / far, depth = radius * rise / far;
    if (middle + depth < 0.1 || middle - depth > reach) return;
    const w = Math.max(0.12, middle - depth), right = Math.abs(c * x - s * y + camera.offsetX * middle / camera.scale);
    if ((right - radius) * camera.scale > camera.width / 2 * (middle + depth)) return;
    const hill = kHill * camera.scale / w;
    if (screenRow(s * x + c * y + radius, camera) > camera.height + hill || screenRow(s * x + c * y - radius, camera) < -hill) return;
    const width = side * camera.scale / w;
    if (level === 0 || width <= widest) return void seen.push({ square, width, w });
    const half = 1 << level - 1;
    for (let i = 0; i < 4; ++i) visit(page, level - 1, column + half * (i & 1), row + half * (i >> 1));
  };
  for (const page of pages) visit(page, kLevels - 1, 0, 0);
  return seen.sort((a, b) => a.w - b.w);
}

/// Where on the screen lies what is so far ahead of the camera's point, m.
function screenRow(ahead: number, camera: Camera): number {
  const w = Math.max(0.02, 1 + ahead * Math.sin(camera.tilt) / camera.distance);
  return camera.height / 2 + camera.offsetY - ahead * Math.cos(camera.tilt) * camera.scale / w;
}

/// Points of a net: its own, and those of its edge again, lower.
export function netPoints({ page, level, column, row }: Square, blocks: Blocks): Float32Array {
  const step = 1 << level, [left, low] = [column * kCells, row * kCells], heights = new Float32Array(kAside * kAside);
  for (let i = 0; i < heights.length; ++i) heights[i] = groundAt(page, left + i % kAside * step, low + Math.floor(i / kAside) * step, blocks);
  fillGaps(heights);
  const hangs = Math.min(0.8, 0.15 + 0.03 * step), edge = edgeOf(kAside);
  const points = new Float32Array(kFloats * (heights.length + edge.length));
  const put = (at: number, i: number, down: number) => points.set([left + i % kAside * step, low + Math.floor(i / kAside) * step, heights[i] - down], kFloats * at);
  for (let i = 0; i < heights.length; ++i) put(i, i, 0);
  edge.forEach((i, n) => put(heights.length + n, i, hangs));
  return points;
}

/// Triangles of every net, of each `step`th of its points, which divides kCells.
export function netIndices(step: number): Uint16Array {
  const indices: number[] = [], edge = edgeOf(kAside), row = step * kAside, low = kAside * kAside;
  for (let y = 0; y < kCells; y += step) for (let x = 0; x < kCells; x += step) {
    const at = y * kAside + x;
    indices.push(at, at + step, at + row, at + step, at + row + step, at + row);
  }
  for (let n = 0; n < edge.length; n += step) {
    const next = (n + step) % edge.length;
    indices.push(edge[n], edge[next], low + n, edge[next], low + next, low + n);
  }
  return new Uint16Array(indices);
}

/// The points of a square's edge, around.
function edgeOf(n: number): number[] {
  const last = n - 1, edge: number[] = [];
  for (let i = 0; i < last; ++i) edge.push(i);
  for (let i = 0; i < last; ++i) edge.push(i * n + last);
  for (let i = last; i > 0; --i) edge.push(last * n + i);
  for (let i = last; i > 0; --i) edge.push(i * n);
  return edge;
}

/// The mean of the four cells that meet at a corner, of those that show ground: under what blocks nobody saw it. Where
/// none does, that of a tile there; NaN where there is no tile.
function groundAt(page: Page, column: number, row: number, blocks: Blocks): number {
  let sum = 0, n = 0, beside: Tile | undefined;
  for (let i = 0; i < 4; ++i) {
    const [x, y] = [column - (i & 1), row - (i >> 1)];
    const [tx, ty] = [Math.floor(x / kCells), Math.floor(y / kCells)];
    const isBeyond = tx < 0 || ty < 0 || tx >= kTilesAside || ty >= kTilesAside;  // the next page's: both have this corner as high
    const tile = isBeyond ? blocks.tileAt(page.x * kTilesAside + tx, page.y * kTilesAside + ty) : page.tiles[ty * kTilesAside + tx];
    if (!tile) continue;
    beside ??= tile;
    const at = (y - ty * kCells) * kCells + x - tx * kCells, kind = tile.classes[at], height = tile.heights[at];
    if (height === kNoHeight || kind === 0 || kind > 2) continue;
    sum += tile.zOrigin + height * 0.002;
    ++n;
  }
  return n > 0 ? sum / n : beside ? blocks.groundOf(beside) : NaN;
}

/// Where there is no tile, as high as what is beside it.
function fillGaps(heights: Float32Array): void {
  const pass = (from: number, to: number) => { if (Number.isNaN(heights[to])) heights[to] = heights[from]; };
  for (let y = 0; y < kAside; ++y) {
    for (let x = 1; x < kAside; ++x) pass(y * kAside + x - 1, y * kAside + x);
    for (let x = kAside - 1; x > 0; --x) pass(y * kAside + x, y * kAside + x - 1);
  }
  for (let i = kAside; i < heights.length; ++i) pass(i - kAside, i);
  for (let i = heights.length - 1; i >= kAside; --i) pass(i, i - kAside);
}
