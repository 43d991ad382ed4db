// Thins a frame for the history: keeps every fourth LiDAR point and nothing of the dense cloud, because these are more
// bytes than everything else together.

const kPointsKind = 5, kCloudKind = 9;
const kPointBytes = 7;
const kHead = 5;   // bytes of a section's head
const kStride = 4;

export function thinScan(frame: ArrayBuffer): ArrayBuffer {
  const view = new DataView(frame), bytes = new Uint8Array(frame);
  const out = new Uint8Array(frame.byteLength);
  let to = 0;
  const copy = (from: number, n: number) => { out.set(bytes.subarray(from, from + n), to); to += n; };
  copy(0, 4);  // the frame's number
  for (let at = 4; at < frame.byteLength;) {
    const length = view.getUint32(at + 1, true), start = at + kHead, kind = view.getUint8(at);
    if (kind !== kCloudKind) copy(at, kHead);
    if (kind !== kPointsKind && kind !== kCloudKind) {
      copy(start, length);
    } else if (kind === kPointsKind) {
      const head = to;
      for (let point = 0; point + kPointBytes <= length; point += kStride * kPointBytes)
        for (let i = 0; i < kPointBytes; ++i) out[to++] = bytes[start + point + i];
      new DataView(out.buffer).setUint32(head - 4, to - head, true);
    }
    at = start + length;
  }
  return out.slice(0, to).buffer;
}
