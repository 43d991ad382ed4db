// The card of the selected cell or curb.
import { classColours, css, kClassNames, Mode, Theme } from "../drawing/palette";
import { byId, closeButton, fixed, list, make, metres, seconds, setText } from "../format";
import { newestTime } from "../survey";
import { cellAt, heightOf, kCellSize, kTileSize, kUnknownCost, Tile, World } from "../world";
import { CurbPlace, curbAt, CutCell, cutOf, drawCut, lengthOf } from "./cross_section";

export class Inspector {
  picked: [number, number] | null = null;  // m in map
  covered = false;  // the card is hidden, as the ruler's is in its place
  private card = byId("cell");
  // Frames arrive ten times a second: an element that is clicked, focused or read aloud must not be replaced.
  private key = make("i");
  private name = make("span");
  private body = make("div");

  constructor(private world: World, private changed: () => void) {
    this.name.setAttribute("role", "status");
    this.card.append(make("h3", "", "", this.key, this.name, closeButton(() => this.pick(null))), this.body);
  }

  pick(place: [number, number] | null): void {
    this.picked = place && cellAt(this.world, ...place) ? place : null;
    this.changed();
  }

  /// Around which place, m in map, the card needs the dense cloud: for the cell's points or a curb's section; null: none.
  get cut(): [number, number] | null { return this.picked; }

  show(theme: Theme, mode: Mode): void {
    const hit = this.picked && cellAt(this.world, ...this.picked);
    this.card.hidden = !hit || this.covered;
    if (!hit || !this.picked || this.covered) return;
    const { tile, index } = hit, kind = tile.classes[index], height = heightOf(tile, index);
    const colours = classColours(theme, mode), colour = colours[kind];
    this.key.style.setProperty("--key", colour ? css(colour) : "transparent");
    const facts = make("dl", "", "values");
    const cost = tile.costs[index];
    list(facts, [
      ["Height", height === null ? "none" : `${fixed(height, 3)} m`],
      ["Cost", cost === kUnknownCost ? "unknown" : cost === 254 ? "254, lethal" : `${cost}`],
      ["Confidence", `${Math.round(tile.confidences[index] / 2.55)} %`],
      ...this.evidence(this.picked),
      ...this.ages(tile),
      ["Place", `${fixed(this.picked[0], 2)}, ${fixed(this.picked[1], 2)} m`],
      ...this.distance(),
    ]);
    const curb = curbAt(this.world, ...this.picked);
    setText(this.name, kClassNames[kind]);
    // The curb comes first: a phone shows no more without scrolling.
    const above = curb ? [...this.curb(curb, colours.map(c => c ? css(c) : "transparent")), make("h4", "Cell")] : [];
    this.body.replaceChildren(...above, facts);
  }

  /// What the dense cloud has in the cell, if it was sent: one point per voxel of 0.1 m.
  private evidence([x, y]: [number, number]): [string, string][] {
    const { cloud } = this.world, cellOf = (m: number) => Math.floor(m / kCellSize), heights: number[] = [];
    if (!cloud.tiles.has(`${Math.floor(x / kTileSize)},${Math.floor(y / kTileSize)}`)) return [];
    cloud.near(x, y, 0, (px, py, pz) => {
      if (cellOf(px) === cellOf(x) && cellOf(py) === cellOf(y)) heights.push(pz);
    });
    const [low, high] = [Math.min(...heights), Math.max(...heights)].map(m => fixed(m, 2));
    return [["Points in it", heights.length === 0 ? "none" : heights.length === 1 ? `1, at ${low} m` : `${heights.length}, ${low} to ${high} m`]];
  }

  /// A saved map has no time of its curbs and one revision of each tile.
  private ages(tile: Tile): [string, string][] {
    const { state } = this.world, name = `${tile.x}, ${tile.y}`;
    if (state?.source === "map") {
      const before = newestTime(this.world) - tile.utime;
      return [["Last points", !tile.utime ? "unknown" : before < 500_000 ? "at the end" : `${seconds(before * 1e-6)} before the end`], ["Tile", name]];
    }
    const newest = state?.pose?.utime ?? tile.utime;
    return [
      ["Last points", tile.utime ? ago(newest - tile.utime) : "unknown"],
      ["Curbs known to", tile.curbsUtime ? ago(newest - tile.curbsUtime) : "not yet"],
      ["Tile", `${name}, revision ${tile.revision}`],
    ];
  }

  private curb(curb: CurbPlace, colours: string[]): HTMLElement[] {
    const { line } = curb, facts = make("dl"), cut = cutOf(this.world, curb), { sides } = cut;
    list(facts, [
      [line.inferred ? "Step, inferred" : "Step", `${metres(curb.height)}${line.rise > 0 ? ", up from the path" : line.rise < 0 ? ", down from the path" : ""}`],
      ...sides ? [["Step fitted here", metres(sides.step)], ["Slope below, above", `${percent(sides.low.slope)}, ${percent(sides.high.slope)}`]] as [string, string][] : [],
      ["Foot", `${fixed(curb.foot, 3)} m`],
      ["Confidence", `${Math.round(100 * line.confidence)} %`],
      ["Line", metres(lengthOf(line))],
    ]);
    const [title, sentence] = meaningOf(curb, cut.cells);
    return [make("h4", title), ...sentence ? [make("p", sentence)] : [], drawCut(cut, curb, kind => colours[kind]), facts];
  }

  private distance(): [string, string][] {
    const pose = this.world.state?.pose;
    if (!pose || !this.picked) return [];
    return [["From the vehicle", metres(Math.hypot(this.picked[0] - pose.x, this.picked[1] - pose.y))]];
  }
}

/// The kind of curb, in words.
function meaningOf({ line }: CurbPlace, cells: CutCell[]): [string, string] {
  if (line.inferred) {
    const hides = cells.some(({ kind }) => kind > 2) ? " What stands there hides it." : "";
    return ["Inferred curb", `Nobody saw it: a bridge between two curbs that were seen.${hides}`];
  }
  return line.dropped ? ["Lowered curb", "As at a driveway or a crossing: its step is low."] : ["Curb", ""];
}

/// Of a side: rising towards the higher one.
function percent(slope: number): string {
  return `${fixed(Math.round(1000 * slope) / 10 + 0, 1)} %`;  // no −0.0
}

function ago(us: number): string {
  return us < 500_000 ? "now" : `${seconds(us * 1e-6)} ago`;
}
