// Curbs for the tilted view: a wall from the foot to the step's top, and a narrow kerbstone on it.
import { Anchor } from "../camera";
import { CurbLine } from "../../world";

const kStone = 0.1;  // m, wide
const kSide = 0.78, kTop = 1.06;  // brightness

/// Triangles of x and y relative to the anchor, z and brightness. Negative brightness: a lowered or inferred curb.
export function wallsOf(curbs: Iterable<CurbLine>, [ax, ay]: Anchor): Float32Array {
  const points: number[] = [];
  for (const { n, values: v, dropped, inferred } of curbs) {
    const sign = dropped || inferred ? -1 : 1;
    const foot = (i: number) => [v[i] - ax, v[n + i] - ay, v[2 * n + i]];
    const top = (i: number) => [v[i] - ax, v[n + i] - ay, v[2 * n + i] + v[3 * n + i]];
    const back = (i: number) => [v[i] - ax + kStone * v[4 * n + i], v[n + i] - ay + kStone * v[5 * n + i], v[2 * n + i] + v[3 * n + i]];
    const quad = (a: number[], b: number[], c: number[], d: number[], light: number) => {
      for (const p of [a, b, c, b, d, c]) points.push(...p, sign * light);
    };
    for (let i = 0; i + 1 < n; ++i) {
      quad(foot(i), foot(i + 1), top(i), top(i + 1), kSide);
      quad(top(i), top(i + 1), back(i), back(i + 1), kTop);
    }
  }
  return new Float32Array(points);
}
