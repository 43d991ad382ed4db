// Where the screen looks: a point of the map, a scale and a turn.

export interface View { x: number; y: number; scale: number; turn: number }  // m, m, CSS pixels a m, rad

export const kMinScale = 0.2;
export const kMaxScale = 800;

export class Camera implements View {
  x = 0;
  y = 0;
  scale = 14;
  turn = 0;  // by which the map is turned, counter-clockwise
  width = 1;  // CSS pixels
  height = 1;
  // The middle of what no card hides, from the middle of the screen, CSS pixels.
  offsetX = 0;
  offsetY = 0;

  toScreen(x: number, y: number): [number, number] {
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [dx, dy] = [x - this.x, y - this.y];
    return [this.width / 2 + this.offsetX + (c * dx - s * dy) * this.scale,
      this.height / 2 + this.offsetY - (s * dx + c * dy) * this.scale];
  }

  toMap(sx: number, sy: number): [number, number] {
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    const u = (sx - this.width / 2 - this.offsetX) / this.scale;
    const v = -(sy - this.height / 2 - this.offsetY) / this.scale;
    return [this.x + c * u + s * v, this.y - s * u + c * v];
  }

  /// Moves so that the map's point (x, y) is at this place of the screen.
  hold(x: number, y: number, sx: number, sy: number): void {
    const [nowX, nowY] = this.toMap(sx, sy);
    this.x += x - nowX;
    this.y += y - nowY;
  }

  zoom(factor: number, sx: number, sy: number): void {
    const [x, y] = this.toMap(sx, sy);
    this.scale = Math.min(kMaxScale, Math.max(kMinScale, this.scale * factor));
    this.hold(x, y, sx, sy);
  }

  /// Shows this part of the map as a whole.
  show(minX: number, minY: number, maxX: number, maxY: number): void {
    this.x = (minX + maxX) / 2;
    this.y = (minY + maxY) / 2;
    const [c, s] = [Math.abs(Math.cos(this.turn)), Math.abs(Math.sin(this.turn))];
    const wide = c * (maxX - minX) + s * (maxY - minY), high = s * (maxX - minX) + c * (maxY - minY);
    const room = Math.min((this.width - 2 * Math.abs(this.offsetX) - 60) / wide,
      (this.height - 2 * Math.abs(this.offsetY) - 120) / high);
    this.scale = Math.min(60, Math.max(kMinScale, room));
  }
}
