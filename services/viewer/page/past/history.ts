// The history of the last minutes: the received frames, and every 20 s a snapshot of the world before a frame, from
// which they can be applied. Bounded in time and in bytes.
import { readFrame } from "../decode";
import { Snapshot, World } from "../world";
import { NewMaps } from "./new_maps";
import { thinScan } from "./thin_scan";

const kSpan = 600_000;        // ms
const kSegment = 20_000;      // ms between two snapshots: bounds the decoding for a jump
const kTileBytes = 3_300;     // of a tile that only a snapshot still holds
const kEntryBytes = 64;       // of a tile's or a line's entry in a snapshot

interface Frame { at: number; bytes: ArrayBuffer }
interface Segment { at: number; before: Snapshot; frames: Frame[]; bytes: number }

export class History {
  newMaps = new NewMaps();  // ms
  private segments: Segment[] = [];
  private copied = 0;  // tiles the world had copied at the last call

  constructor(private mostBytes = 150e6) {}

  get bytes(): number { return this.segments.reduce((sum, { bytes }) => sum + bytes, 0); }
  /// ms, when the oldest kept frame was received; null: there is none.
  get oldest(): number | null { return this.segments[0]?.frames[0]?.at ?? null; }
  get newest(): number { return lastOf(lastOf(this.segments)?.frames ?? [])?.at ?? 0; }

  clear(): void {
    this.segments = [];
    this.newMaps.clear();
  }

  /// Call it before a frame is applied to `world`.
  expect(world: World, at: number): void {
    const last = lastOf(this.segments);
    const isFull = !last || at - last.at >= kSegment || last.bytes > this.mostBytes / 8;
    if (!isFull) return;
    const before = world.snapshot();
    this.copied = world.copied;
    this.segments.push({ at, before, frames: [], bytes: kEntryBytes * (before.tiles.size + before.curbs.size) });
  }

  /// Call it after the frame was applied.
  add(world: World, bytes: ArrayBuffer, at: number): void {
    const last = lastOf(this.segments)!;
    this.newMaps.note(world, at);
    const kept = thinScan(bytes);
    last.frames.push({ at, bytes: kept });
    // A copied tile is held by the snapshots up to this segment's, and is freed with it.
    last.bytes += kept.byteLength + kTileBytes * (world.copied - this.copied);
    this.copied = world.copied;
    while (this.segments.length > 1 && (this.bytes > this.mostBytes || this.segments[1].at < at - kSpan)) this.segments.shift();
  }

  /// Takes `world`, which holds what was received up to `from` (null: it holds another time), to the state at `to`.
  /// Returns when its newest frame was received.
  lead(world: World, from: number | null, to: number): number {
    const starts = this.segments.filter(segment => segment.at <= to);
    const segment = lastOf(starts) ?? this.segments[0];
    const goesOn = from !== null && from <= to && from >= segment.at;
    if (!goesOn) world.show(segment.before);
    let newest = goesOn ? from : segment.at;
    for (const frame of segment.frames) {
      if (frame.at > to) break;
      if (goesOn && frame.at <= from) continue;
      readFrame(frame.bytes, world);
      newest = frame.at;
    }
    return newest;
  }
}

function lastOf<T>(list: T[]): T | undefined {
  return list[list.length - 1];
}
