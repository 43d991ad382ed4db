// Road paint in the tilted view: one flat strip per painted piece.
import { Anchor } from "./camera";
import { MarkingLine } from "../world";

export const kPaintWidth = 0.12;  // m, if unknown

/// Triangles of x, y, z and brightness, as in curb_walls.
export function stripsOf(markings: Iterable<MarkingLine>, [ax, ay]: Anchor): Float32Array {
  const points: number[] = [];
  for (const { n, values: v, painted, width } of markings) for (let i = 0; i + 1 < n; ++i) {
    const [x, y, z, nextX, nextY, nextZ] = [v[i] - ax, v[n + i] - ay, v[2 * n + i], v[i + 1] - ax, v[n + i + 1] - ay, v[2 * n + i + 1]];
    const length = Math.hypot(nextX - x, nextY - y);
    if (!painted[i] || !(length > 0)) continue;
    const half = (width || kPaintWidth) / 2 / length, [a, b] = [(y - nextY) * half, (nextX - x) * half];
    const corners = [[x + a, y + b, z], [nextX + a, nextY + b, nextZ], [x - a, y - b, z], [nextX - a, nextY - b, nextZ]];
    for (const corner of [0, 1, 2, 1, 3, 2]) points.push(...corners[corner], 1);
  }
  return new Float32Array(points);
}
