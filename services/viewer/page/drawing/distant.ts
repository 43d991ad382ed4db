// The picture of a page seen from afar, where a pixel of the screen covers several cells: the mean colour of five by
// five cells, computed without the graphics card. It takes 0.14 MB instead of the 8 MB of a page seen close up, so that a
// map of many kilometres can be seen as a whole.
import type { Look } from "./ground";
import { kCellsAside, kTilesAside, Page } from "./page";
import { classColours, ramp, Rgb } from "./palette";
import { kCells, kNoHeight, kUnknownCost, Tile } from "../world";

const kBlock = 5;                     // cells along a side of a pixel
const kAside = kCellsAside / kBlock;  // pixels along a side of a page
const kPart = kCells / kBlock;        // of a tile
const kSteps = 255;                   // of a ramp

/// Below this width of a cell, pixels of the screen, a page is drawn by this picture.
export const kDistant = 1.6 / kBlock;

/// `pixels`: the content of the texture. `stale`: places in Page.tiles that changed since; null: all.
export interface Distant { picture: WebGLTexture; pixels: Uint8Array; stale: Set<number> | null; paintedAs: string }

/// Brings the picture up to date. `name` stands for everything but the cells that the colours depend on; `smooth`: the
/// filter.
export function paintDistant(gl: WebGL2RenderingContext, page: Page, name: string, look: Look, smooth: number): WebGLTexture {
  const distant = page.distant ??= { picture: newPicture(gl, smooth), pixels: new Uint8Array(4 * kAside * kAside), stale: null, paintedAs: name };
  if (distant.paintedAs !== name) distant.stale = null;
  if (distant.stale?.size === 0) return distant.picture;
  const colours = coloursFor(look);
  for (const place of distant.stale ?? page.tiles.keys()) paintTile(distant.pixels, place, page.tiles[place], colours, look);
  distant.stale = new Set();
  distant.paintedAs = name;
  gl.activeTexture(gl.TEXTURE3);
  gl.bindTexture(gl.TEXTURE_2D, distant.picture);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kAside, kAside, gl.RGBA, gl.UNSIGNED_BYTE, distant.pixels);
  gl.generateMipmap(gl.TEXTURE_2D);
  return distant.picture;
}

function newPicture(gl: WebGL2RenderingContext, smooth: number): WebGLTexture {
  const made = gl.createTexture()!;
  gl.activeTexture(gl.TEXTURE3);
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1 + Math.floor(Math.log2(kAside)), gl.RGBA8, kAside, kAside);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, smooth);
  return made;
}

/// The colours by class, or along the ramp; null: not drawn.
function coloursFor({ mode, theme }: Look): (Rgb | null)[] {
  if (mode === "class" || mode === "paper") return classColours(theme, mode);
  if (mode === "age") return [[255, 255, 255]];  // its colours change all the time: kPicture's shader makes them
  const ends = ramp(mode);
  return Array.from({ length: kSteps + 1 }, (_, i) => {
    const place = i / kSteps * 7, low = Math.min(6, Math.floor(place));
    return [0, 1, 2].map(c => ends[low][c] + (place - low) * (ends[low + 1][c] - ends[low][c])) as Rgb;
  });
}

/// As kPaintFragment, without the relief.
function indexOf(tile: Tile, i: number, { mode, range: [low, high] }: Look): number {
  const kind = tile.classes[i];
  if (mode === "class" || mode === "paper") return kind;
  if (mode === "age") return kind > 0 ? 0 : -1;
  if (mode === "confidence") return kind > 0 ? tile.confidences[i] : -1;
  if (mode === "cost") return tile.costs[i] === kUnknownCost ? -1 : Math.round(tile.costs[i] * kSteps / 254);
  if (tile.heights[i] === kNoHeight) return -1;
  const share = (tile.zOrigin + tile.heights[i] * 0.002 - low) / (high - low);
  return Math.round(kSteps * Math.min(1, Math.max(0, share)));
}

function paintTile(pixels: Uint8Array, place: number, tile: Tile | undefined, colours: (Rgb | null)[], look: Look): void {
  const sums = kSums.fill(0), [left, low] = [place % kTilesAside * kPart, Math.floor(place / kTilesAside) * kPart];
  for (let i = 0; tile && i < kCells * kCells; ++i) {
    const colour = colours[indexOf(tile, i, look)];
    if (!colour) continue;
    const to = 4 * (Math.floor(i / kCells / kBlock) * kPart + Math.floor(i % kCells / kBlock));
    for (let c = 0; c < 3; ++c) sums[to + c] += colour[c];
    sums[to + 3] += 255;
  }
  for (let i = 0; i < kPart * kPart; ++i) {
    const to = 4 * ((low + Math.floor(i / kPart)) * kAside + left + i % kPart);
    for (let c = 0; c < 4; ++c) pixels[to + c] = Math.round(sums[4 * i + c] / (kBlock * kBlock));
  }
}

const kSums = new Float32Array(4 * kPart * kPart);
