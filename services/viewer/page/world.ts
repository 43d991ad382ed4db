// The page's state of the map, and how frames change it (frames/README.md has their layout).
import { Cloud } from "./cloud";

export const kCells = 25;       // along a side of a tile
export const kTileCells = 625;
export const kCellSize = 0.12;  // m
export const kTileSize = 3;     // m
export const kNoHeight = -32768;
export const kUnknownCost = 255;

export interface Tile {
  x: number; y: number;
  revision: number;
  utime: number;       // us, of the newest points
  curbsUtime: number;  // us
  zOrigin: number;     // m
  classes: Uint8Array;
  heights: Int16Array; // 2 mm steps from zOrigin
  costs: Uint8Array;
  confidences: Uint8Array;
  kept: boolean;       // held by a snapshot: to be copied before a change
}

export interface CurbLine {
  confidence: number;
  dropped: boolean;
  inferred: boolean;       // not observed
  rise: number;        // 1 up, -1 down, 0 unknown, seen from the driven path
  n: number;
  values: Float32Array;  // n each of x, y, z, height, high side x, high side y
}

/// As marking_line_t: a crossing's line runs across its bars; its width is their length.
export interface MarkingLine {
  type: number;            // kMarkingNames
  confidence: number;
  width: number;           // m; 0: unknown
  n: number;
  values: Float32Array;    // n each of x, y, z, m
  painted: Uint8Array;     // whether there is paint up to the next point
}
export const kMarkingNames = ["Marking", "Solid line", "Dashed line", "Stop line", "Crossing", "Other marking"];

export interface Pose {
  utime: number; x: number; y: number; z: number; roll: number; pitch: number; yaw: number;
  covariance: [number, number, number, number];  // xx, xy, yy m^2, yaw rad^2
  residual: number; inliers: number; degenerate: number;
  registered: boolean; without_odometry: boolean; stationary: boolean; lost: boolean;
}

/// The localizer's pose in its saved map. `here`: that map is the one shown.
export interface Localized extends Pose { age: number; here: boolean }

export interface Place { x: number; y: number; height: number | null }  // m in map

/// How far a log has been played.
/// `newMaps`: where in it another map began, 0 .. 1.
export interface Playback { position: number; progress: number; speed: number; paused: boolean; ended: boolean; newMaps?: number[] }

export interface State {
  source: "live" | "map" | "replay"; title: string; epoch: number; tiles: number; behind: number;
  bus_age: number | null; tile_age: number | null; index_age: number | null; pose_age: number | null;
  new_map_age: number | null;  // s of the drive since a map began that does not continue the one before
  latency: [number | null, number | null];
  vehicle: [number, number, number];  // m: length, width, x of the middle
  pose: Pose | null;
  localized: Localized | null;
  playback: Playback | null;
}

export interface Service {
  name: string; host: string; version: string; pid: number; age: number; uptime: number; cpu: number; memory: number;
  latency: [number | null, number | null]; faults: string[]; losses: [string, number, number][];
}

/// The state of a world at one moment. It shares everything that does not change afterwards.
export interface Snapshot {
  run: number; epoch: number; number: number;
  tiles: Map<string, Tile>; curbs: Map<number, CurbLine>; markings: Map<number, MarkingLine>;
  path: number[]; pathLength: number;  // the array may have grown since
  scan: Float32Array; scanPose: Pose | null; state: State | null; services: Service[];
}

export class World {
  run = 0;
  epoch = 0;
  number = 0;  // up to which it has all tiles
  tiles = new Map<string, Tile>();
  changed = new Set<Tile>();  // since Pages.upload() cleared it
  gone = new Set<Tile>();     // the same
  cleared = true;
  copied = 0;                 // number of tiles that only a snapshot holds: copied, or of an earlier map
  curbs = new Map<number, CurbLine>();
  curbsChanged = true;
  markings = new Map<number, MarkingLine>();
  markingsChanged = true;
  path: number[] = [];  // x, y, z in turn
  pathChanged = true;
  scan: Float32Array = new Float32Array();  // x, y, z in base_link, m, and intensity 0..1, in turn
  scanPose: Pose | null = null;  // the vehicle's, when the scan was received
  scanChanged = false;
  cloud = new Cloud();  // in no snapshot: the history has none
  state: State | null = null;
  services: Service[] = [];

  tileAt(x: number, y: number): Tile | undefined {
    return this.tiles.get(`${x},${y}`);
  }

  begin(run: number, epoch: number): void {
    for (const tile of this.tiles.values()) if (tile.kept) ++this.copied;  // only a snapshot holds it from here on
    this.run = run;
    this.epoch = epoch;
    this.number = 0;
    this.tiles.clear();
    this.changed.clear();
    this.gone.clear();
    this.curbs.clear();
    this.markings.clear();
    this.path = [];
    this.scan = new Float32Array();
    this.scanPose = null;
    this.cloud.clear();
    this.cleared = this.curbsChanged = this.markingsChanged = this.pathChanged = this.scanChanged = true;
  }

  /// The tile for writing: a copy if a snapshot holds it.
  own(tile: Tile): Tile {
    if (!tile.kept) return tile;
    const { classes, heights, costs, confidences } = tile;
    const copy = { ...tile, kept: false, classes: classes.slice(), heights: heights.slice(), costs: costs.slice(), confidences: confidences.slice() };
    this.tiles.set(`${tile.x},${tile.y}`, copy);
    ++this.copied;
    return copy;
  }

  snapshot(): Snapshot {
    for (const tile of this.tiles.values()) tile.kept = true;
    const { run, epoch, number, path, scan, scanPose, state, services } = this;
    return { run, epoch, number, tiles: new Map(this.tiles), curbs: new Map(this.curbs), markings: new Map(this.markings), path, pathLength: path.length, scan, scanPose, state, services };
  }

  /// Takes the content of the snapshot; only differences count as changed.
  show(other: Snapshot): void {
    for (const [key, tile] of this.tiles) {
      if (other.tiles.has(key)) continue;
      this.gone.add(tile);
      this.changed.delete(tile);
    }
    for (const [key, tile] of other.tiles) if (this.tiles.get(key) !== tile) this.changed.add(tile);
    this.tiles = new Map(other.tiles);
    this.curbs = new Map(other.curbs);
    this.markings = new Map(other.markings);
    this.path = other.path.slice(0, other.pathLength);
    const { run, epoch, number, scan, scanPose, state, services } = other;
    Object.assign(this, { run, epoch, number, scan, scanPose, state, services });
    this.curbsChanged = this.markingsChanged = this.pathChanged = this.scanChanged = true;
  }
}

/// The cell at a place in the map, m.
export function cellAt(world: World, x: number, y: number): { tile: Tile; index: number } | null {
  const tile = world.tileAt(Math.floor(x / kTileSize), Math.floor(y / kTileSize));
  if (!tile) return null;
  const column = Math.min(kCells - 1, Math.floor((x - tile.x * kTileSize) / kCellSize));
  const row = Math.min(kCells - 1, Math.floor((y - tile.y * kTileSize) / kCellSize));
  return { tile, index: row * kCells + column };
}

/// m in map; null if unknown.
export function heightOf(tile: Tile, index: number): number | null {
  const steps = tile.heights[index];
  return steps === kNoHeight ? null : tile.zOrigin + steps * 0.002;
}

/// The same at a place, m.
export function heightAt(world: World, x: number, y: number): number | null {
  const hit = cellAt(world, x, y);
  return hit && heightOf(hit.tile, hit.index);
}
