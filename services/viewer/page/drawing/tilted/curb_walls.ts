// Curbs for the tilted view: a wall from the foot to the step's top, and a narrow kerbstone on it. A lowered curb is half
// transparent. An inferred one is a row of such posts: nobody saw it.
import { Anchor } from "../camera";
import { CurbLine } from "../../world";

const kStone = 0.1;  // m, wide
const kSide = 0.78, kTop = 1.06;  // brightness
const kPost = 0.12, kGap = 0.18;  // m, along an inferred curb

/// Triangles of x and y relative to the anchor, z and brightness. Negative brightness: a lowered or inferred curb.
export function wallsOf(curbs: Iterable<CurbLine>, [ax, ay]: Anchor): Float32Array {
  const points: number[] = [];
  for (const { n, values: v, dropped, inferred } of curbs) {
    const sign = dropped || inferred ? -1 : 1;
    /// Foot, top and the stone's back at a share of the way from vertex i to the next.
    const post = (i: number, share: number) => {
      const [x, y, z, height, sx, sy] = [0, 1, 2, 3, 4, 5].map(k => v[k * n + i] + share * (v[k * n + i + 1] - v[k * n + i]));
      const foot = [x - ax, y - ay, z], top = [foot[0], foot[1], z + height];
      return [foot, top, [foot[0] + kStone * sx, foot[1] + kStone * sy, top[2]]];
    };
    const quad = (a: number[], b: number[], c: number[], d: number[], light: number) => {
      for (const p of [a, b, c, b, d, c]) points.push(...p, sign * light);
    };
    let along = 0;  // m, of the line so far
    for (let i = 0; i + 1 < n; ++i) {
      const length = Math.hypot(v[i + 1] - v[i], v[n + i + 1] - v[n + i]);
      for (const [from, to] of inferred ? posts(along, length) : [[0, 1]]) {
        const [a, b] = [post(i, from), post(i, to)];
        quad(a[0], b[0], a[1], b[1], kSide);
        quad(a[1], b[1], a[2], b[2], kTop);
      }
      along += length;
    }
  }
  return new Float32Array(points);
}

/// Where posts stand on a piece of `length` m that begins `along` m into the line: shares of it, from and to.
function posts(along: number, length: number): [number, number][] {
  const found: [number, number][] = [], step = kPost + kGap;
  for (let k = Math.floor(along / step); k * step < along + length; ++k) {
    const from = Math.max(0, k * step - along), to = Math.min(length, k * step + kPost - along);
    if (to > from) found.push([from / length, to / length]);
  }
  return found;
}
