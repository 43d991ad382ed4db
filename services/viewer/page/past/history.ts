// The history of the last minutes: the received frames, and every 20 s a snapshot of the world before a frame, from
// which they can be applied. Bounded in time and in bytes.
import { readFrame } from "../decode";
import { World } from "../world";
import { NewMaps } from "./new_maps";
import { Segment } from "./segment";
import { thinScan } from "./thin_scan";

const kSpan = 600_000;        // ms
const kSegment = 20_000;      // ms between two snapshots: bounds the decoding for a jump

export class History {
  newMaps = new NewMaps();  // ms
  packing: Promise<void> = Promise.resolve();  // until everything closed is compressed, one segment after the other
  private segments: Segment[] = [];
  private copied = 0;  // tiles the world had copied at the last call

  /// `unpacked`: what lead() could not show yet can be shown now.
  constructor(private mostBytes = 150e6, private unpacked: () => void = () => undefined) {}

  get bytes(): number { return this.segments.reduce((sum, { bytes }) => sum + bytes, 0); }
  /// ms, when the oldest kept frame was received; null: there is none.
  get oldest(): number | null { return this.segments[0]?.times[0] ?? null; }
  get newest(): number { return lastOf(lastOf(this.segments)?.times ?? []) ?? 0; }

  clear(): void {
    this.segments = [];
    this.newMaps.clear();
  }

  /// Call it before a frame is applied to `world`.
  expect(world: World, at: number): void {
    const last = lastOf(this.segments);
    const isFull = !last || at - last.at >= kSegment || last.bytes > this.mostBytes / 8;
    if (!isFull) return;
    if (last) this.packing = this.packing.then(() => this.segments.includes(last) ? last.close() : undefined);
    this.segments.push(new Segment(at, world.snapshot()));
    this.copied = world.copied;
  }

  /// Call it after the frame was applied.
  add(world: World, bytes: ArrayBuffer, at: number): void {
    this.newMaps.note(world, at);
    // A copied tile is held by the snapshots up to this segment's, and is freed with it.
    lastOf(this.segments)!.add(thinScan(bytes), at, world.copied - this.copied);
    this.copied = world.copied;
    while (this.segments.length > 1 && (this.bytes > this.mostBytes || this.segments[1].at < at - kSpan)) this.segments.shift();
  }

  /// Takes `world`, which holds what was received up to `from` (null: it holds another time), to the state at `to`.
  /// Returns when its newest frame was received; null: nothing has changed, the frames are being unpacked.
  lead(world: World, from: number | null, to: number): number | null {
    const starts = this.segments.filter(segment => segment.at <= to);
    const segment = lastOf(starts) ?? this.segments[0], next = this.segments[this.segments.indexOf(segment) + 1];
    for (const other of this.segments) if (other !== segment && other !== next) other.shut();
    segment.open(this.unpacked);
    next?.open(() => undefined);  // for who plays on
    const { frames, times } = segment;
    if (!frames) return null;
    const goesOn = from !== null && from <= to && from >= segment.at;
    if (!goesOn) world.show(segment.before);
    let newest = goesOn ? from : segment.at;
    for (const [i, frame] of frames.entries()) {
      if (times[i] > to) break;
      if (goesOn && times[i] <= from) continue;
      readFrame(frame, world);
      newest = times[i];
    }
    return newest;
  }

  /// Nobody looks at the past any more.
  shut(): void {
    for (const segment of this.segments) segment.shut();
  }
}

function lastOf<T>(list: T[]): T | undefined {
  return list[list.length - 1];
}
