// The dense cloud as the page has it: by tile, one point per voxel of 0.1 m (frames/README.md). Bounded.
import { kTileSize } from "./world";

export const kPointBytes = 10;   // x, y, z (i16, 2 mm from the tile's corner and zOrigin), intensity, surface, line, unused (u8)
export const kStep = 0.002;      // m
const kMostPoints = 600_000;     // 6 MB, and as much on the graphics card
const kServed = 40;              // m around the vehicle: what the viewer does not send twice unless it changes

/// `version` grows with each change. `n` points in `bytes`, which may be longer. Saliencies: 0 unknown, 1 .. 255 for 0 .. 1.
export interface CloudTile { x: number; y: number; zOrigin: number; n: number; bytes: Uint8Array; version: number }

export class Cloud {
  tiles = new Map<string, CloudTile>();
  points = 0;
  received = 0;  // bytes of sections since the page was opened

  constructor(private mostPoints = kMostPoints) {}

  clear(): void {
    this.tiles.clear();
    this.points = 0;
  }

  /// The tile with room for `n` points, and with just these.
  resize(x: number, y: number, zOrigin: number, n: number): CloudTile {
    const key = `${x},${y}`;
    let tile = this.tiles.get(key);
    if (!tile) this.tiles.set(key, tile = { x, y, zOrigin, n: 0, bytes: new Uint8Array(0), version: 0 });
    if (tile.bytes.length < n * kPointBytes) {
      const more = new Uint8Array(Math.ceil(n / 128) * 128 * kPointBytes);
      more.set(tile.bytes);
      tile.bytes = more;
    }
    this.points += n - tile.n;
    tile.n = n;
    tile.zOrigin = zOrigin;
    ++tile.version;
    return tile;
  }

  /// Discards what is farthest from the view (x, y), m in map, while there is too much; what is near the vehicle last.
  trim(x: number, y: number, vehicle: { x: number; y: number } | null): void {
    if (this.points <= this.mostPoints) return;
    const away = (tile: CloudTile) => {
      const [mx, my] = [(tile.x + 0.5) * kTileSize, (tile.y + 0.5) * kTileSize];
      const served = vehicle ? Math.max(0, Math.hypot(mx - vehicle.x, my - vehicle.y) - kServed) : Infinity;
      return Math.min(Math.hypot(mx - x, my - y), served);
    };
    const order = [...this.tiles.entries()].map(([key, tile]) => ({ key, tile, away: away(tile) })).sort((a, b) => b.away - a.away);
    for (const { key, tile } of order) {
      if (this.points <= 0.9 * this.mostPoints) return;
      this.tiles.delete(key);
      this.points -= tile.n;
    }
  }

  /// Calls `take` with the points of the tiles within `reach` of a place, m in map.
  near(x: number, y: number, reach: number, take: (px: number, py: number, pz: number) => void): void {
    const at = (place: number) => Math.floor(place / kTileSize);
    for (let ty = at(y - reach); ty <= at(y + reach); ++ty) for (let tx = at(x - reach); tx <= at(x + reach); ++tx) {
      const tile = this.tiles.get(`${tx},${ty}`);
      if (!tile) continue;
      const view = new DataView(tile.bytes.buffer);
      for (let i = 0; i < tile.n; ++i) {
        const [px, py, pz] = [0, 2, 4].map(axis => view.getInt16(i * kPointBytes + axis, true) * kStep);
        take(tx * kTileSize + px, ty * kTileSize + py, tile.zOrigin + pz);
      }
    }
  }
}
