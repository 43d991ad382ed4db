// A piece of the history: a snapshot of the world, and the frames that were received after it. Closed, its frames are
// compressed; to be shown they are unpacked again.
import { Snapshot } from "../world";
import { kCanPack, pack, unpack } from "./packing";

const kTileBytes = 3_300;     // of a tile that only a snapshot still holds
const kEntryBytes = 64;       // of a tile's or a line's entry in a snapshot

export class Segment {
  readonly times: number[] = [];                // ms, when each frame was received
  private raw: ArrayBuffer[] | null = [];       // the frames
  private packed: ArrayBuffer | null = null;    // the same
  private sizes: number[] = [];
  private rawBytes = 0;
  private held: number;                         // bytes of the snapshot, and of tiles that it alone holds
  private isUnpacking = false;

  /// `at`: ms, when it begins.
  constructor(readonly at: number, readonly before: Snapshot) {
    this.held = kEntryBytes * (before.tiles.size + before.curbs.size);
  }

  get bytes(): number { return this.held + (this.raw ? this.rawBytes : 0) + (this.packed?.byteLength ?? 0); }
  /// null: they have to be unpacked.
  get frames(): ArrayBuffer[] | null { return this.raw; }

  add(frame: ArrayBuffer, at: number, copiedTiles: number): void {
    this.raw!.push(frame);
    this.times.push(at);
    this.sizes.push(frame.byteLength);
    this.rawBytes += frame.byteLength;
    this.held += kTileBytes * copiedTiles;
  }

  /// No frame comes after this. Where the browser cannot compress, it stays as it is.
  async close(): Promise<void> {
    if (!kCanPack) return;
    try {
      this.packed = await pack(this.raw!);
      this.raw = null;
    } catch { /* out of memory: the history's bound still holds */ }
  }

  /// Unpacks the frames and then calls `then`; not if they are there already.
  open(then: () => void): void {
    if (this.raw || !this.packed || this.isUnpacking) return;
    this.isUnpacking = true;
    void unpack(this.packed, this.sizes).then(frames => {
      this.raw = frames;
      then();
    }).catch(() => undefined).then(() => { this.isUnpacking = false; });
  }

  /// Nobody looks at it: frees the unpacked frames.
  shut(): void {
    if (this.packed) this.raw = null;
  }
}
