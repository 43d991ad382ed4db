// What came in the last minutes, so that it can be seen again: the frames as they came, and now and then the world
// before a frame, from which they can be applied. Bounded in time and in bytes.
import { readFrame } from "../decode";
import { Snapshot, World } from "../world";
import { thinScan } from "./thin_scan";

const kSpan = 600_000;        // ms
const kSegment = 20_000;      // ms from one snapshot to the next: to look anywhere takes at most so much of decoding
const kTileBytes = 3_300;     // that a tile takes which a snapshot alone still holds
const kEntryBytes = 64;       // of a tile's or a line's name in a snapshot

interface Frame { at: number; bytes: ArrayBuffer }
interface Segment { at: number; before: Snapshot; frames: Frame[]; bytes: number }

export class History {
  private segments: Segment[] = [];
  private copied = 0;  // tiles that the world had copied, when it was last asked

  constructor(private mostBytes = 150e6) {}

  get bytes(): number { return this.segments.reduce((sum, { bytes }) => sum + bytes, 0); }
  /// ms, when the first frame that is kept came; null: there is none.
  get oldest(): number | null { return this.segments[0]?.frames[0]?.at ?? null; }
  get newest(): number { return lastOf(lastOf(this.segments)?.frames ?? [])?.at ?? 0; }

  clear(): void { this.segments = []; }

  /// A frame comes; `world` does not have it yet.
  expect(world: World, at: number): void {
    const last = lastOf(this.segments);
    const isFull = !last || at - last.at >= kSegment || last.bytes > this.mostBytes / 8;
    if (!isFull) return;
    const before = world.snapshot();
    this.copied = world.copied;
    this.segments.push({ at, before, frames: [], bytes: kEntryBytes * (before.tiles.size + before.curbs.size) });
  }

  /// It has it now.
  add(world: World, bytes: ArrayBuffer, at: number): void {
    const last = lastOf(this.segments)!;
    const kept = thinScan(bytes);
    last.frames.push({ at, bytes: kept });
    // A tile that was copied lives on in the snapshots up to this segment's, and goes with it.
    last.bytes += kept.byteLength + kTileBytes * (world.copied - this.copied);
    this.copied = world.copied;
    while (this.segments.length > 1 && (this.bytes > this.mostBytes || this.segments[1].at < at - kSpan)) this.segments.shift();
  }

  /// Takes `world`, which has what came up to `from` (null: it is of another time), to what had come at `to`. Returns
  /// when its newest frame came.
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
