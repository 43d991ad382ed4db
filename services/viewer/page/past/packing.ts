// Compresses what the history keeps: several frames together take a third of their bytes.

/// Debian's TypeScript does not declare these yet.
interface Coder { readable: ReadableStream<Uint8Array>; writable: WritableStream<Uint8Array> }
declare const CompressionStream: { new(format: string): Coder };
declare const DecompressionStream: { new(format: string): Coder };

/// Safari before 16.4 and Firefox before 113 cannot.
export const kCanPack = typeof CompressionStream === "function";

export function pack(parts: ArrayBuffer[]): Promise<ArrayBuffer> {
  return through(new Blob(parts), new CompressionStream("deflate"));
}

/// `sizes`: of the parts, bytes.
export async function unpack(packed: ArrayBuffer, sizes: number[]): Promise<ArrayBuffer[]> {
  const all = await through(new Blob([packed]), new DecompressionStream("deflate"));
  let at = 0;
  return sizes.map(size => all.slice(at, at += size));
}

function through(blob: Blob, coder: Coder): Promise<ArrayBuffer> {
  return new Response(blob.stream().pipeThrough(coder)).arrayBuffer();
}
