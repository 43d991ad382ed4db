// The two sides of a curb in its cross-section: a straight line fitted to each, and the step between them at the foot.

/// Across: m from the foot towards the higher side; up: m above the foot.
export type Spot = [across: number, up: number];

/// up = foot + slope * across, where it was fitted: `from` .. `to`, m across.
export interface Side { foot: number; slope: number; from: number; to: number }
export interface Sides { low: Side; high: Side; step: number }

const kFace = [-0.06, 0.14];  // m across: what lies between may be the curb's face
const kLeast = 6;             // places on a side
const kSpan = 0.3;            // m that they must cover
const kNear = 0.12;           // m about the median: at first, so that a wall or a car does not pull the line
const kNoise = 0.015;         // m: what is nearer to the line is never an outlier
const kRounds = 3;

/// null: a side has too few places.
export function fitSides(spots: Spot[]): Sides | null {
  const low = fit(spots.filter(([across]) => across < kFace[0])), high = fit(spots.filter(([across]) => across > kFace[1]));
  return low && high && { low, high, step: high.foot - low.foot };
}

export function upAt({ foot, slope }: Side, across: number): number {
  return foot + slope * across;
}

/// Least squares, without what lies off the line of most.
function fit(spots: Spot[]): Side | null {
  const ups = spots.map(([, up]) => up).sort((a, b) => a - b), median = ups[ups.length >> 1];
  let used = spots.filter(([, up]) => Math.abs(up - median) < kNear), side: Side | null = null;
  for (let round = 0; round < kRounds; ++round) {
    side = lineThrough(used);
    if (!side) return null;
    const line = side, offs = used.map(([across, up]) => up - upAt(line, across));
    const most = Math.max(kNoise, 2.5 * Math.sqrt(offs.reduce((sum, off) => sum + off * off, 0) / offs.length));
    used = spots.filter(([across, up]) => Math.abs(up - upAt(line, across)) <= most);
  }
  return side;
}

function lineThrough(spots: Spot[]): Side | null {
  const n = spots.length, places = spots.map(([across]) => across), [from, to] = [Math.min(...places), Math.max(...places)];
  if (n < kLeast || to - from < kSpan) return null;
  const mean = (of: (spot: Spot) => number) => spots.reduce((sum, spot) => sum + of(spot), 0) / n;
  const [x, y] = [mean(([across]) => across), mean(([, up]) => up)];
  const slope = mean(([across, up]) => (across - x) * (up - y)) / mean(([across]) => (across - x) ** 2);
  return { foot: y - slope * x, slope, from, to };
}
