// The cross-section of a curb: the dense cloud's points and the map's cells along its normal, and the sides fitted to
// them.
import { make } from "../format";
import { fitSides, Sides, Spot, upAt } from "./curb_sides";
import { CurbLine, heightOf, kCellSize, kCells, kTileSize, World } from "../world";

const kReach = 1.5;  // m, to either side
const kBand = 0.15;  // m, to either side of the normal
const kNear = 0.25;  // m: a click this close selects the curb

/// A vertex of a curb. `side`: unit vector towards the higher side.
export interface CurbPlace {
  line: CurbLine;
  x: number; y: number; foot: number; height: number;  // m
  side: [number, number];
}

/// A cell near the normal: m from the foot line towards the higher side, m above the foot.
export interface CutCell { across: number; up: number; kind: number }

/// The vertex nearest to a place, if the curb passes within `near`.
export function curbAt(world: World, x: number, y: number, near = kNear): CurbPlace | null {
  let best: CurbPlace | null = null, closest = Infinity;
  for (const line of world.curbs.values()) {
    const { n, values } = line;
    for (let i = 0; i < n; ++i) {
      const distance = Math.hypot(values[i] - x, values[n + i] - y);
      if (distance >= closest || segmentDistance(line, i, x, y) > near) continue;
      closest = distance;
      best = { line, x: values[i], y: values[n + i], foot: values[2 * n + i], height: values[3 * n + i],
        side: [values[4 * n + i], values[5 * n + i]] };
    }
  }
  return best;
}

/// Distance from a place to the line's pieces that begin or end at vertex i, m.
function segmentDistance({ n, values }: CurbLine, i: number, x: number, y: number): number {
  const to = (j: number) => {
    if (j < 0 || j >= n) return Math.hypot(values[i] - x, values[n + i] - y);
    const [dx, dy] = [values[j] - values[i], values[n + j] - values[n + i]];
    const share = Math.min(1, Math.max(0, ((x - values[i]) * dx + (y - values[n + i]) * dy) / (dx * dx + dy * dy || 1)));
    return Math.hypot(values[i] + share * dx - x, values[n + i] + share * dy - y);
  };
  return Math.min(to(i - 1), to(i + 1));
}

/// The cells within the band, from the lower side to the higher one.
function cutAcross(world: World, curb: CurbPlace): CutCell[] {
  const found: CutCell[] = [], [sx, sy] = curb.side;
  const first = (middle: number) => Math.floor((middle - kReach - kBand) / kTileSize);
  const last = (middle: number) => Math.floor((middle + kReach + kBand) / kTileSize);
  for (let ty = first(curb.y); ty <= last(curb.y); ++ty) for (let tx = first(curb.x); tx <= last(curb.x); ++tx) {
    const tile = world.tileAt(tx, ty);
    if (!tile) continue;
    for (let i = 0; i < kCells * kCells; ++i) {
      const dx = tx * kTileSize + (i % kCells + 0.5) * kCellSize - curb.x;
      const dy = ty * kTileSize + (Math.floor(i / kCells) + 0.5) * kCellSize - curb.y;
      const across = dx * sx + dy * sy, height = heightOf(tile, i);
      if (height === null || Math.abs(across) > kReach || Math.abs(dx * sy - dy * sx) > kBand) continue;
      found.push({ across, up: height - curb.foot, kind: tile.classes[i] });
    }
  }
  return found.sort((a, b) => a.across - b.across);
}

/// The points of the dense cloud within the band: m from the foot line, m above the foot. None, if the viewer sent none.
function pointsAcross({ cloud }: World, curb: CurbPlace): Spot[] {
  const found: Spot[] = [], [sx, sy] = curb.side;
  cloud.near(curb.x, curb.y, kReach + kBand, (x, y, z) => {
    const [dx, dy] = [x - curb.x, y - curb.y], across = dx * sx + dy * sy, up = z - curb.foot;
    if (Math.abs(across) > kReach || Math.abs(dx * sy - dy * sx) > kBand || up < kLowest || up > kHighest) return;
    found.push([across, up]);
  });
  return found;
}

/// Length of the line's foot, m.
export function lengthOf({ n, values }: CurbLine): number {
  let length = 0;
  for (let i = 1; i < n; ++i) length += Math.hypot(values[i] - values[i - 1], values[n + i] - values[n + i - 1]);
  return length;
}

function outline({ low, high }: Sides): Spot[] {
  return [[low.from, upAt(low, low.from)], [0, low.foot], [0, high.foot], [high.to, upAt(high, high.to)]];
}

const kSvg = "http://www.w3.org/2000/svg";
const kWide = 232, kHigh = 96, kLowest = -0.15, kHighest = 0.45;  // pixels; m above the foot

/// A cross-section. `sides`: fitted to the points, where there are enough of them, otherwise to the cells.
export interface Cut { cells: CutCell[]; points: Spot[]; sides: Sides | null }

export function cutOf(world: World, curb: CurbPlace): Cut {
  const cells = cutAcross(world, curb), points = pointsAcross(world, curb);
  return { cells, points, sides: fitSides(points) ?? fitSides(cells.map(({ across, up }) => [across, up])) };
}

/// Draws the cells as dots in the colour of their class, the points as small ones, the sides and the step between them as
/// a line, and a 10 cm scale. Without fitted sides the line is the map's step. The line of a lowered curb is dashed and
/// that of an inferred one dotted, as on the map.
export function drawCut({ cells, points, sides }: Cut, curb: CurbPlace, colourOf: (kind: number) => string): HTMLElement {
  const x = (across: number) => (across / kReach + 1) / 2 * kWide;
  const y = (up: number) => kHigh * (kHighest - Math.min(kHighest, Math.max(kLowest, up))) / (kHighest - kLowest);
  const svg = document.createElementNS(kSvg, "svg");
  svg.setAttribute("viewBox", `0 0 ${kWide} ${kHigh}`);
  const add = (tag: string, attributes: Record<string, string | number>) => {
    const element = document.createElementNS(kSvg, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
    svg.append(element);
  };
  add("line", { class: "rule", x1: 5, x2: 5, y1: y(0), y2: y(0.1) });
  const dashes = curb.line.inferred ? "1 4" : curb.line.dropped ? "5 4" : "none";
  add("polyline", { class: "step", "stroke-dasharray": dashes, points: (sides ? outline(sides) : [[-kReach, 0], [0, 0], [0, curb.height], [kReach, curb.height]]).map(([across, up]) => `${x(across)},${y(up)}`).join(" ") });
  for (const cell of cells) add("circle", { cx: x(cell.across), cy: y(cell.up), r: 3, fill: colourOf(cell.kind) });
  for (const [across, up] of points) add("rect", { x: x(across) - 1, y: y(up) - 1, width: 2, height: 2 });
  const what = points.length > 0 ? "Cells and points (small)" : "Cells";
  const figure = make("figure", "", "cut", make("figcaption", cells.length === 0 ? "No cell is known across it" :
    `${what} across it, 1.5 m to each side; line: ${sides ? "fitted to both sides" : "the map's step"}; bar: 10 cm`));
  figure.prepend(svg);
  return figure;
}
