// The marks above the ground in the view from above: curbs, path, vehicles, the selected cell; Canvas 2D.
import { Layers } from "../settings";
import { Anchor, anchorAt, Camera, isNear } from "./camera";
import { ellipseOf, fillOf, Ink, kGrey, kInk } from "./ink";
import { kPaintWidth } from "./paint_strips";
import { Theme } from "./palette";
import { Sheet } from "./sheet";
import { CurbLine, kCellSize, MarkingLine, Place, Pose, World } from "../world";

interface Shape { line: CurbLine; path: Path2D; ticks: Path2D }

export class Marks {
  private context: CanvasRenderingContext2D;
  private curbs: Shape[] = [];
  private paint: [MarkingLine, Path2D][] = [];
  private driven = new Path2D();
  private anchor: Anchor = [0, 0];

  constructor(private sheet: Sheet, private world: World) {
    this.context = sheet.context;
  }

  draw(camera: Camera, theme: Theme, layers: Layers, poses: [Pose, string][], picked: [number, number] | null, measured: Place[], grey: number, lives: boolean): void {
    const { context } = this;
    const ink = kInk[theme];
    this.sheet.begin();
    context.filter = grey > 0 ? kGrey : "none";
    this.toMap(camera);
    const pixel = 1 / camera.scale;
    context.lineJoin = context.lineCap = "round";
    if (layers.markings) this.drawPaint(ink, pixel);
    if (layers.path) this.drawPath(ink, pixel);
    if (layers.curbs) this.drawCurbs(ink, pixel, camera.scale);
    if (picked) this.drawPicked(picked, ink, pixel);
    if (measured.length > 0) this.drawMeasured(measured, ink, pixel);
    if (lives) context.filter = "none";
    for (const [pose, colour] of poses) this.drawEllipse(pose, colour, pixel);
    for (const [pose, colour] of poses) this.drawVehicle(pose, colour, ink, pixel);
    this.sheet.show();
  }

  /// Sets the canvas's coordinates to m relative to the anchor.
  private toMap(camera: Camera): void {
    const dots = this.sheet.width / camera.width;
    const k = camera.scale * dots;
    const [c, s] = [Math.cos(camera.turn) * k, Math.sin(camera.turn) * k];
    const [x, y] = camera.toScreen(...this.anchor);
    this.context.setTransform(c, -s, -s, -c, x * dots, y * dots);
  }

  /// Takes the changes of the world; call it before each drawing.
  refresh(camera: Camera): void {
    const { world } = this;
    if (!isNear(this.anchor, camera)) {
      this.anchor = anchorAt(camera);
      world.curbsChanged = world.markingsChanged = world.pathChanged = true;
    }
    const { anchor } = this, [ax, ay] = anchor;
    if (world.curbsChanged) {
      this.curbs = [...world.curbs.values()].map(line => shapeOf(line, anchor));
      world.curbsChanged = false;
    }
    if (world.markingsChanged) {
      this.paint = [...world.markings.values()].map(line => [line, pathOf(line, anchor)]);
      world.markingsChanged = false;
    }
    if (world.pathChanged) {
      this.driven = new Path2D();
      for (let i = 0; i < world.path.length; i += 3) this.driven.lineTo(world.path[i] - ax, world.path[i + 1] - ay);
      world.pathChanged = false;
    }
  }

  /// To scale; thin lines from far away. A dark edge separates it from a light road.
  private drawPaint(ink: Ink, pixel: number): void {
    const { context } = this;
    context.lineCap = "butt";
    for (const [colour, more] of [["#00000070", 1.5 * pixel], [ink.paint, 0]] as const) {
      context.strokeStyle = colour;
      for (const [line, path] of this.paint) {
        context.lineWidth = Math.max(line.width || kPaintWidth, 1.5 * pixel) + more;
        context.stroke(path);
      }
    }
    context.lineCap = "round";
  }

  private drawPath(ink: Ink, pixel: number): void {
    const { context } = this;
    context.globalAlpha = 0.75;
    context.strokeStyle = ink.halo;
    context.lineWidth = 4.5 * pixel;
    context.stroke(this.driven);
    context.strokeStyle = ink.path;
    context.lineWidth = 1.8 * pixel;
    context.stroke(this.driven);
    context.globalAlpha = 1;
  }

  /// A line along the foot: lowered ones dashed, inferred ones dotted and thin. Close up, ticks point towards the
  /// higher side.
  private drawCurbs(ink: Ink, pixel: number, scale: number): void {
    const { context } = this;
    context.strokeStyle = ink.halo;
    context.lineWidth = 4 * pixel;
    if (scale > 6) for (const curb of this.curbs) context.stroke(curb.path);
    context.strokeStyle = ink.curb;
    for (const curb of this.curbs) {
      context.globalAlpha = 0.45 + 0.55 * Math.min(1, curb.line.confidence);
      context.lineWidth = 2 * pixel;
      if (curb.line.dropped) context.setLineDash([5 * pixel, 5 * pixel]);
      if (curb.line.inferred) {
        context.setLineDash([0.5 * pixel, 4.5 * pixel]);
        context.globalAlpha *= 0.75;
      }
      context.stroke(curb.path);
      context.setLineDash([]);
      context.lineWidth = 1.2 * pixel;
      if (scale > 24 && !curb.line.inferred) context.stroke(curb.ticks);
    }
    context.globalAlpha = 1;
  }

  private drawPicked([x, y]: [number, number], ink: Ink, pixel: number): void {
    const { context, anchor: [ax, ay] } = this;
    const side = Math.max(kCellSize, 6 * pixel);
    const cornerX = (Math.floor(x / kCellSize) + 0.5) * kCellSize - ax - side / 2;
    const cornerY = (Math.floor(y / kCellSize) + 0.5) * kCellSize - ay - side / 2;
    for (const [colour, width] of [[ink.halo, 5], [ink.vehicle, 2.5]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width * pixel;
      context.strokeRect(cornerX, cornerY, side, side);
    }
  }

  /// A line from place to place, with a ring around each.
  private drawMeasured(places: Place[], ink: Ink, pixel: number): void {
    const { context, anchor: [ax, ay] } = this;
    for (const [colour, width] of [[ink.halo, 5], [ink.vehicle, 2]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width * pixel;
      context.beginPath();
      for (const { x, y } of places) context.lineTo(x - ax, y - ay);
      context.stroke();
      for (const { x, y } of places) {
        context.beginPath();
        context.arc(x - ax, y - ay, 5 * pixel, 0, 2 * Math.PI);
        context.stroke();
      }
    }
  }

  private drawEllipse(pose: Pose, colour: string, pixel: number): void {
    const { long, short, turn } = ellipseOf(pose);
    if (!(long > 3 * pixel)) return;
    const { context } = this;
    context.beginPath();
    context.ellipse(pose.x - this.anchor[0], pose.y - this.anchor[1], long, Math.max(short, pixel), turn, 0, 2 * Math.PI);
    context.fillStyle = context.strokeStyle = colour;
    context.globalAlpha = fillOf(short / pixel);
    context.fill();
    context.globalAlpha = 0.8;
    context.lineWidth = 1.2 * pixel;
    context.stroke();
    context.globalAlpha = 1;
  }

  /// To scale; from far away an arrow of 22 pixels.
  private drawVehicle(pose: Pose, colour: string, ink: Ink, pixel: number): void {
    const { context } = this;
    const [length, width, middle] = this.world.state?.vehicle ?? [1.8, 1.2, 0];
    context.save();
    context.translate(pose.x - this.anchor[0], pose.y - this.anchor[1]);
    context.rotate(pose.yaw);
    context.fillStyle = pose.lost ? "#888" : colour;
    context.strokeStyle = ink.body;
    context.lineWidth = 2 * pixel;
    if (length > 26 * pixel) {
      roundedBox(context, middle - length / 2, -width / 2, length, width, width * 0.22);
      context.fill();
      context.stroke();
      context.translate(middle, 0);
      context.scale(width * 0.3, width * 0.3);
      context.fillStyle = ink.body;
    } else {
      context.scale(12 * pixel, 12 * pixel);
    }
    context.beginPath();
    context.moveTo(1, 0);
    context.lineTo(-0.8, 0.72);
    context.lineTo(-0.45, 0);
    context.lineTo(-0.8, -0.72);
    context.closePath();
    context.fill();
    if (length <= 26 * pixel) {
      context.lineWidth = 0.16;
      context.stroke();
    }
    context.restore();
  }
}

/// Replaces roundRect(), which browsers before 2023 lack.
function roundedBox(context: CanvasRenderingContext2D, x: number, y: number, wide: number, high: number, radius: number): void {
  const corners = [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]];
  context.beginPath();
  context.moveTo(x, y + radius);
  corners.forEach(([cornerX, cornerY], i) => {
    const [nextX, nextY] = corners[(i + 1) % 4];
    context.arcTo(cornerX, cornerY, nextX, nextY, radius);
  });
  context.closePath();
}

function pathOf({ n, values, painted }: MarkingLine, [ax, ay]: Anchor): Path2D {
  const path = new Path2D();
  for (let i = 0; i + 1 < n; ++i) {
    if (!painted[i]) continue;
    if (i === 0 || !painted[i - 1]) path.moveTo(values[i] - ax, values[n + i] - ay);
    path.lineTo(values[i + 1] - ax, values[n + i + 1] - ay);
  }
  return path;
}

function shapeOf(line: CurbLine, [ax, ay]: Anchor): Shape {
  const path = new Path2D(), ticks = new Path2D();
  const { n, values } = line;
  for (let i = 0; i < n; ++i) {
    const [x, y, height] = [values[i] - ax, values[n + i] - ay, values[3 * n + i]];
    path.lineTo(x, y);
    const reach = Math.min(0.3, 0.06 + height);
    ticks.moveTo(x, y);
    ticks.lineTo(x + values[4 * n + i] * reach, y + values[5 * n + i] * reach);
  }
  return { line, path, ticks };
}
