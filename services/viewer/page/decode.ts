// Decodes the server's frames into the World. frames/README.md has the layout.
import { kPointBytes } from "./cloud";
import { CurbLine, kTileCells, MarkingLine, Tile, World } from "./world";

class Reader {
  private at: number;
  constructor(private view: DataView, start: number, readonly end: number) { this.at = start; }
  get left(): number { return this.end - this.at; }
  private step(n: number): number {
    if (n > this.left) throw new Error("a frame that ends too soon");
    this.at += n;
    return this.at - n;
  }
  u8(): number { return this.view.getUint8(this.step(1)); }
  i8(): number { return this.view.getInt8(this.step(1)); }
  u16(): number { return this.view.getUint16(this.step(2), true); }
  i16(): number { return this.view.getInt16(this.step(2), true); }
  u32(): number { return this.view.getUint32(this.step(4), true); }
  i32(): number { return this.view.getInt32(this.step(4), true); }
  f32(): number { return this.view.getFloat32(this.step(4), true); }
  f64(): number { return this.view.getFloat64(this.step(8), true); }
  bytes(n: number): Uint8Array { return new Uint8Array(this.view.buffer, this.view.byteOffset + this.step(n), n); }
  part(n: number): Reader { const start = this.step(n); return new Reader(this.view, start, start + n); }
  text(): string { return new TextDecoder().decode(this.bytes(this.left)); }
}

const kMaskBytes = Math.ceil(kTileCells / 8);

function newTile(x: number, y: number): Tile {
  return { x, y, revision: 0, utime: 0, curbsUtime: 0, zOrigin: 0, classes: new Uint8Array(kTileCells),
    heights: new Int16Array(kTileCells), costs: new Uint8Array(kTileCells), confidences: new Uint8Array(kTileCells), kept: false };
}

/// A tile record: all cells, or those in the mask.
function readTile(reader: Reader, world: World): void {
  const x = reader.i32(), y = reader.i32(), key = `${x},${y}`;
  let tile = world.tiles.get(key);
  if (!tile) world.tiles.set(key, tile = newTile(x, y));
  tile = world.own(tile);
  const isWhole = reader.u8() === 0;
  tile.revision = reader.i32();
  tile.utime = reader.f64();
  tile.curbsUtime = reader.f64();
  tile.zOrigin = reader.f32();
  if (isWhole) readWhole(reader, tile);
  else readChanges(reader, tile);
  world.changed.add(tile);
}

function readWhole(reader: Reader, tile: Tile): void {
  tile.classes.set(reader.bytes(kTileCells));
  const heights = reader.bytes(2 * kTileCells);
  for (let i = 0; i < kTileCells; ++i) tile.heights[i] = heights[2 * i] | heights[2 * i + 1] << 8;
  tile.costs.set(reader.bytes(kTileCells));
  tile.confidences.set(reader.bytes(kTileCells));
}

function readChanges(reader: Reader, tile: Tile): void {
  const cells: number[] = [], mask = reader.bytes(kMaskBytes);
  for (let i = 0; i < kTileCells; ++i) if (mask[i >> 3] & (1 << (i & 7))) cells.push(i);
  for (const i of cells) tile.classes[i] = reader.u8();
  for (const i of cells) tile.heights[i] = reader.i16();
  for (const i of cells) tile.costs[i] = reader.u8();
  for (const i of cells) tile.confidences[i] = reader.u8();
}

/// Reads which lines were removed, by name.
function readGone(reader: Reader, lines: Map<number, unknown>): void {
  reader.u32();  // the number: the server keeps it for the page
  if (reader.u8()) lines.clear();
  for (let gone = reader.u32(); gone > 0; --gone) lines.delete(reader.u32());
}

function readFloats(reader: Reader, n: number): Float32Array {
  const values = new Float32Array(n);
  for (let i = 0; i < n; ++i) values[i] = reader.f32();
  return values;
}

function readCurbs(reader: Reader, world: World): void {
  readGone(reader, world.curbs);
  for (let lines = reader.u32(); lines > 0; --lines) {
    const name = reader.u32();
    const confidence = reader.f32(), kind = reader.u8(), rise = reader.i8(), n = reader.u16();
    const line: CurbLine = { confidence, dropped: (kind & 1) !== 0, inferred: (kind & 2) !== 0, rise, n, values: readFloats(reader, 6 * n) };
    world.curbs.set(name, line);
  }
  world.curbsChanged = true;
}

function readMarkings(reader: Reader, world: World): void {
  readGone(reader, world.markings);
  for (let lines = reader.u32(); lines > 0; --lines) {
    const name = reader.u32(), type = reader.i8(), confidence = reader.f32(), width = reader.f32(), n = reader.u16();
    const line: MarkingLine = { type, confidence, width, n, values: readFloats(reader, 3 * n), painted: reader.bytes(n).slice() };
    world.markings.set(name, line);
  }
  world.markingsChanged = true;
}

function readPath(reader: Reader, world: World): void {
  if (reader.u8()) world.path = [];
  while (reader.left > 0) world.path.push(reader.f32());
  world.pathChanged = true;
}

function readScan(reader: Reader, world: World): void {
  world.scan = new Float32Array(4 * Math.floor(reader.left / 7));
  for (let i = 0; i < world.scan.length; i += 4) {
    for (let axis = 0; axis < 3; ++axis) world.scan[i + axis] = reader.i16() / 100;
    world.scan[i + 3] = reader.u8() / 255;
  }
  world.scanChanged = true;
}

/// Tile records: the number of the tile's points, and those that changed, in runs.
function readCloud(reader: Reader, { cloud }: World): void {
  cloud.received += reader.left;
  while (reader.left > 0) {
    const tile = cloud.resize(reader.i32(), reader.i32(), reader.f32(), reader.u16());
    for (let runs = reader.u16(); runs > 0; --runs) {
      const first = reader.u16(), end = first + reader.u16();
      for (let i = first; i < end; ++i) tile.bytes.set(reader.bytes(kPointBytes - 1), i * kPointBytes);
    }
  }
}

/// Applies a frame and returns its number.
export function readFrame(buffer: ArrayBuffer, world: World): number {
  const reader = new Reader(new DataView(buffer), 0, buffer.byteLength);
  const frame = reader.u32(), { scan } = world;
  while (reader.left > 0) {
    const kind = reader.u8();
    const section = reader.part(reader.u32());
    if (kind === 1) world.begin(section.f64(), section.i32());
    if (kind === 2) {
      const number = section.f64();
      while (section.left > 0) readTile(section, world);
      world.number = number;
    }
    if (kind === 3) readCurbs(section, world);
    if (kind === 4) readPath(section, world);
    if (kind === 5) readScan(section, world);
    if (kind === 6) world.state = JSON.parse(section.text());
    if (kind === 8) readMarkings(section, world);
    if (kind === 9) readCloud(section, world);
    if (kind === 7) world.services = JSON.parse(section.text());
  }
  if (world.scan !== scan) world.scanPose = world.state?.pose ?? null;
  return frame;
}
