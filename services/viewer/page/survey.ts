// Figures of the whole map: its bounds, the heights in view.
import { Camera } from "./drawing/camera";
import { heightAt, heightOf, kTileCells, kTileSize, World } from "./world";

/// min x, min y, max x, max y, m.
export function mapBounds(world: World): [number, number, number, number] {
  let [minX, minY, maxX, maxY] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const tile of world.tiles.values()) {
    if (!tile.classes.some(c => c > 0)) continue;
    [minX, minY] = [Math.min(minX, tile.x), Math.min(minY, tile.y)];
    [maxX, maxY] = [Math.max(maxX, tile.x + 1), Math.max(maxY, tile.y + 1)];
  }
  if (!(minX < maxX)) return [-10, -10, 10, 10];
  return [minX * kTileSize, minY * kTileSize, maxX * kTileSize, maxY * kTileSize];
}

/// Whether a part of any tile is on the screen. Tilted, more is visible than this knows.
export function isAnyInView(world: World, camera: Camera): boolean {
  const reach = kTileSize * camera.scale;
  for (const tile of world.tiles.values()) {
    const [x, y] = camera.toScreen((tile.x + 0.5) * kTileSize, (tile.y + 0.5) * kTileSize);
    if (x > -reach && y > -reach && x < camera.width + reach && y < camera.height + reach) return true;
  }
  return false;
}

/// The range of nearly all heights in view, m.
export function heightRange(world: World, camera: Camera): [number, number] {
  const heights: number[] = [];
  const every = 7 * (1 + Math.floor(world.tiles.size / 2000));
  for (const tile of world.tiles.values()) {
    const [x, y] = camera.toScreen((tile.x + 0.5) * kTileSize, (tile.y + 0.5) * kTileSize);
    if (x < 0 || y < 0 || x > camera.width || y > camera.height) continue;
    for (let i = 3; i < kTileCells; i += every) {
      const height = heightOf(tile, i);
      if (height !== null) heights.push(height);
    }
  }
  if (heights.length < 20) return [-1, 3];
  const sorted = Float32Array.from(heights).sort();
  const at = (share: number) => sorted[Math.floor(share * (sorted.length - 1))];
  return [at(0.01), Math.max(at(0.01) + 0.5, at(0.97))];
}

/// The place of the map at a pixel, with the relief of the ground.
export function placeUnder(world: World, camera: Camera, sx: number, sy: number): [number, number] {
  let place = camera.toMap(sx, sy);
  for (let i = 0; camera.isTilted && i < 4; ++i) place = camera.toMap(sx, sy, heightAt(world, ...place) ?? camera.z);
  return place;
}

/// us, reference time of the cells' ages.
export function newestTime(world: World): number {
  let newest = world.state?.pose?.utime ?? 0;
  if (newest === 0) for (const tile of world.tiles.values()) newest = Math.max(newest, tile.utime);
  return newest;
}
