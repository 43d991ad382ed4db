// The marks in the tilted view: path, vehicles as boxes, selected and measured places; Canvas 2D. The ground does not
// hide them.
import { Layers } from "../../settings";
import { Camera } from "../camera";
import { ellipseOf, fillOf, Ink, kGrey, kInk } from "../ink";
import { Theme } from "../palette";
import { Sheet } from "../sheet";
import { heightAt, kCellSize, Place, Pose, World } from "../../world";

type Spot = [number, number];
const kBody = [0.12, 0.75];   // m above the ground: the box's bottom and top
const kArrow: Spot[] = [[1, 0], [-0.8, 0.72], [-0.45, 0], [-0.8, -0.72]];

export class TiltedMarks {
  private context: CanvasRenderingContext2D;

  constructor(private sheet: Sheet, private world: World) {
    this.context = sheet.context;
  }

  draw(camera: Camera, theme: Theme, layers: Layers, poses: [Pose, string][], picked: Spot | null, measured: Place[], grey: number, lives: boolean): void {
    const { context, sheet } = this, ink = kInk[theme], dots = sheet.width / camera.width;
    sheet.begin();
    context.setTransform(dots, 0, 0, dots, 0, 0);
    context.filter = grey > 0 ? kGrey : "none";
    context.lineJoin = context.lineCap = "round";
    if (layers.path) this.drawPath(camera, ink);
    if (picked) this.drawPicked(camera, picked, ink);
    if (measured.length > 0) this.drawMeasured(camera, measured, ink);
    if (lives) context.filter = "none";
    for (const [pose, colour] of poses) this.drawEllipse(camera, pose, colour);
    for (const [pose, colour] of poses) this.drawVehicle(camera, pose, colour, ink);
    sheet.show();
  }

  private drawPath(camera: Camera, ink: Ink): void {
    const { context } = this, { path } = this.world;
    const line = new Path2D();
    let isDown = false;
    for (let i = 0; i < path.length; i += 3) {
      const isShown = isSeen(camera, path[i], path[i + 1]);
      if (isShown) line[isDown ? "lineTo" : "moveTo"](...camera.toScreen(path[i], path[i + 1], path[i + 2] + 0.03));
      isDown = isShown;
    }
    context.globalAlpha = 0.75;
    for (const [colour, width] of [[ink.halo, 4.5], [ink.path, 1.8]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke(line);
    }
    context.globalAlpha = 1;
  }

  private outline(spots: Spot[]): void {
    const { context } = this;
    context.beginPath();
    for (const spot of spots) context.lineTo(...spot);
    context.closePath();
  }

  private drawPicked(camera: Camera, [x, y]: Spot, ink: Ink): void {
    const { context } = this, z = heightAt(this.world, x, y) ?? camera.z;
    const side = Math.max(kCellSize, 7 / camera.scale) / 2;
    const [mx, my] = [(Math.floor(x / kCellSize) + 0.5) * kCellSize, (Math.floor(y / kCellSize) + 0.5) * kCellSize];
    this.outline([[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => camera.toScreen(mx + a * side, my + b * side, z)));
    for (const [colour, width] of [[ink.halo, 5], [ink.vehicle, 2.5]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.stroke();
    }
  }

  private drawMeasured(camera: Camera, places: Place[], ink: Ink): void {
    const { context } = this, spots = places.map(({ x, y, height }) => camera.toScreen(x, y, height ?? camera.z));
    for (const [colour, width] of [[ink.halo, 5], [ink.vehicle, 2]] as const) {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      for (const spot of spots) context.lineTo(...spot);
      context.stroke();
      for (const [x, y] of spots) {
        context.beginPath();
        context.arc(x, y, 5, 0, 2 * Math.PI);
        context.stroke();
      }
    }
  }

  private drawEllipse(camera: Camera, pose: Pose, colour: string): void {
    const { context } = this, { long, short, turn } = ellipseOf(pose);
    if (!(long * camera.scale > 3)) return;
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    this.outline(Array.from({ length: 48 }, (_, i) => {
      const [u, v] = [long * Math.cos(i / 24 * Math.PI), short * Math.sin(i / 24 * Math.PI)];
      return camera.toScreen(pose.x + c * u - s * v, pose.y + s * u + c * v, pose.z + 0.02);
    }));
    context.fillStyle = context.strokeStyle = colour;
    context.globalAlpha = fillOf(short * camera.scale);
    context.fill();
    context.globalAlpha = 0.8;
    context.lineWidth = 1.2;
    context.stroke();
    context.globalAlpha = 1;
  }

  /// A box to scale; from far away an arrow of 22 pixels.
  private drawVehicle(camera: Camera, pose: Pose, colour: string, ink: Ink): void {
    const { context } = this, [length, width, middle] = this.world.state?.vehicle ?? [1.8, 1.2, 0];
    const [c, s] = [Math.cos(pose.yaw), Math.sin(pose.yaw)];
    const at = (u: number, v: number, up: number) => camera.toScreen(pose.x + c * u - s * v, pose.y + s * u + c * v, pose.z + up);
    const isFar = length * camera.scale < 26;
    context.strokeStyle = ink.body;
    context.lineWidth = 2;
    context.fillStyle = pose.lost ? "#888" : colour;
    if (!isFar) {
      const corners: Spot[] = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => [middle + a * length / 2, b * width / 2]);
      this.outline(corners.map(([u, v]) => at(u, v, 0)));
      context.globalAlpha = 0.35;
      context.fillStyle = "#000";
      context.fill();
      context.globalAlpha = 1;
      for (let i = 0; i < 4; ++i) this.drawSide(corners[i], corners[(i + 1) % 4], at, pose.lost ? "#888" : colour, camera, pose.yaw);
      this.outline(corners.map(([u, v]) => at(u, v, kBody[1])));
      context.fillStyle = pose.lost ? "#888" : colour;
      context.fill();
      context.stroke();
      context.fillStyle = ink.body;
    }
    const size = isFar ? 12 / camera.scale : width * 0.3;
    this.outline(kArrow.map(([u, v]) => at(u * size + (isFar ? 0 : middle), v * size, isFar ? 0.05 : kBody[1])));
    context.fill();
    if (isFar) context.stroke();
  }

  /// Draws a side of the box if it faces the eye; darker than the top.
  private drawSide(a: Spot, b: Spot, at: (u: number, v: number, up: number) => Spot, colour: string, camera: Camera, yaw: number): void {
    const spots = [at(...a, kBody[0]), at(...b, kBody[0]), at(...b, kBody[1]), at(...a, kBody[1])];
    const [p, q, r] = spots;
    if ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) > 0) return;  // faces away
    const { context } = this, facing = Math.atan2(a[0] - b[0], b[1] - a[1]) + yaw + camera.turn;
    this.outline(spots);
    context.fillStyle = colour;
    context.fill();
    context.fillStyle = `rgba(0, 0, 0, ${(0.3 + 0.14 * Math.cos(facing)).toFixed(2)})`;
    context.fill();
  }
}

/// False for what is behind the eye or far away.
function isSeen(camera: Camera, x: number, y: number): boolean {
  const ahead = Math.sin(camera.turn) * (x - camera.x) + Math.cos(camera.turn) * (y - camera.y);
  const w = 1 + ahead * Math.sin(camera.tilt) / camera.distance;
  return w > 0.15 && w < 5;
}
