// The ground of a page as a quadtree of meshes: a node of 2^k tiles a side has 25 x 25 squares, whatever its size. Near
// ground is drawn by small nodes and distant ground by large ones, so the number of triangles depends on the screen and
// not on the map. The edge of a mesh is extended downwards a little, which closes the gap to a coarser one.
import { Blocks } from "./blocks";
import { Camera } from "../camera";
import { kTilesAside, Page, Square } from "../page";
import { kCells, kNoHeight, kTileSize, Tile } from "../../world";

export const kLevels = 6;           // of squares: 1, 2 .. 32 tiles a side
const kAside = kCells + 1;          // points along a side of a mesh
const kHill = 5;                    // m, that ground may be above or below the point looked at
const kFloats = 3;                  // per point: column and row in the page, m

/// A visible square and its width in pixels.
export interface Seen { square: Square; width: number; w: number }

export function squareKey(level: number, column: number, row: number): number {
  return (level * kTilesAside + (row >> level)) * kTilesAside + (column >> level);
}

/// Marks the squares of all sizes over a changed tile of the page.
export function touch(page: Page, column: number, row: number): void {
  for (let level = 0; level < kLevels; ++level) {
    const key = squareKey(level, column, row), known = page.squares.get(key);
    if (known) known.stale = true;
    else page.squares.set(key, { page, level, column: column >> level << level, row: row >> level << level, stale: true,
      net: null, boxes: [null, null], used: 0 });
  }
}

/// Marks the squares at the page's edge that take heights from a changed tile beyond it.
export function touchBeside(page: Page, column: number, row: number): void {
  for (let level = 0; level < kLevels; ++level) {
    const inside = (place: number) => Math.min(kTilesAside - 1, Math.max(0, place));
    const known = page.squares.get(squareKey(level, inside(column), inside(row)));
    if (known) known.stale = true;
  }
}

/// The squares that cover the visible area, the nearest first. None is wider than `widest` pixels, except single tiles.
/// `reach`: times the eye's distance.
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

/// The screen row of ground that is `ahead` of the camera's point, m.
function screenRow(ahead: number, camera: Camera): number {
  const w = Math.max(0.02, 1 + ahead * Math.sin(camera.tilt) / camera.distance);
  return camera.height / 2 + camera.offsetY - ahead * Math.cos(camera.tilt) * camera.scale / w;
}

/// Points of a mesh: the grid, and the edge points again, lower.
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

/// Triangles of a mesh over every `step`th point; `step` divides kCells.
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

/// The points along a square's edge, in order.
function edgeOf(n: number): number[] {
  const last = n - 1, edge: number[] = [];
  for (let i = 0; i < last; ++i) edge.push(i);
  for (let i = 0; i < last; ++i) edge.push(i * n + last);
  for (let i = last; i > 0; --i) edge.push(last * n + i);
  for (let i = last; i > 0; --i) edge.push(i * n);
  return edge;
}

/// The mean over those of the four cells at a corner that show ground; ground under an obstacle was never observed. If
/// none does, the ground of a tile there; NaN if there is no tile.
function groundAt(page: Page, column: number, row: number, blocks: Blocks): number {
  let sum = 0, n = 0, beside: Tile | undefined;
  for (let i = 0; i < 4; ++i) {
    const [x, y] = [column - (i & 1), row - (i >> 1)];
    const [tx, ty] = [Math.floor(x / kCells), Math.floor(y / kCells)];
    // A tile beyond the edge is the next page's; both pages get the same height at this corner.
    const isBeyond = tx < 0 || ty < 0 || tx >= kTilesAside || ty >= kTilesAside;
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

/// Fills in the heights where there is no tile from the neighbouring points.
function fillGaps(heights: Float32Array): void {
  const pass = (from: number, to: number) => { if (Number.isNaN(heights[to])) heights[to] = heights[from]; };
  for (let y = 0; y < kAside; ++y) {
    for (let x = 1; x < kAside; ++x) pass(y * kAside + x - 1, y * kAside + x);
    for (let x = kAside - 1; x > 0; --x) pass(y * kAside + x, y * kAside + x - 1);
  }
  for (let i = kAside; i < heights.length; ++i) pass(i - kAside, i);
  for (let i = heights.length - 1; i >= kAside; --i) pass(i, i - kAside);
}
