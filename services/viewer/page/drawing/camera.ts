// The view of the map: a point of the map, a scale, a turn and a tilt. Tilted, it is a perspective about that point; at
// tilt 0 the ground looks the same as in the view from above.

export interface View { x: number; y: number; scale: number; turn: number }  // m, m, CSS pixels per m, rad

export const kMinScale = 0.02;  // 25 km on a small phone
export const kMaxScale = 800;
const kApart = 2000;          // m, from an anchor at most
export const kMaxTilt = 1.1;  // rad: the horizon stays above the screen
const kFocus = 1.25;          // of the screen's height: distance from the eye to the point looked at

// Depth is kDepth[0] + kDepth[1] / w: -1 at a fifth of the eye's distance, 1 at 30 times that distance.
const kDepth = [1.01342, -0.40268];

export class Camera implements View {
  x = 0;
  y = 0;
  z = 0;  // of the ground at (x, y)
  scale = 14;
  turn = 0;  // of the map, counter-clockwise
  tilt = 0;  // 0: from above
  width = 1;  // CSS pixels
  height = 1;
  // The centre of the area that no card covers, relative to the centre of the screen, CSS pixels.
  offsetX = 0;
  offsetY = 0;
  // The size of that area.
  roomWidth = 1;
  roomHeight = 1;

  /// Of the area that no card covers, pixels.
  get middle(): [number, number] { return [this.width / 2 + this.offsetX, this.height / 2 + this.offsetY]; }
  get isTilted(): boolean { return this.tilt > 0.005; }
  /// m, from the eye to the point looked at.
  get distance(): number { return kFocus * this.height / this.scale; }

  toScreen(x: number, y: number, z = this.z): [number, number] {
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [dx, dy] = [x - this.x, y - this.y];
    let [u, v] = [c * dx - s * dy, s * dx + c * dy];
    if (this.isTilted) {
      const [rise, lie] = [Math.sin(this.tilt), Math.cos(this.tilt)], dz = z - this.z;
      const nearer = 1 / Math.max(0.02, 1 + (v * rise - dz * lie) / this.distance);
      [u, v] = [u * nearer, (v * lie + dz * rise) * nearer];
    }
    return [this.width / 2 + this.offsetX + u * this.scale, this.height / 2 + this.offsetY - v * this.scale];
  }

  /// The place at height `z` that is seen at a pixel.
  toMap(sx: number, sy: number, z = this.z): [number, number] {
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    let u = (sx - this.width / 2 - this.offsetX) / this.scale;
    let v = -(sy - this.height / 2 - this.offsetY) / this.scale;
    if (this.isTilted) {
      const [rise, lie] = [Math.sin(this.tilt), Math.cos(this.tilt)], dz = z - this.z, far = this.distance;
      const slope = Math.max(0.02, lie - v * rise / far);  // slope of the ray
      const along = (v * (1 - dz * lie / far) - dz * rise) / slope;
      u *= 1 + (along * rise - dz * lie) / far;
      v = along;
    }
    return [this.x + c * u + s * v, this.y - s * u + c * v];
  }

  /// To clip space, column-major, from m relative to (x, y): far from the map's origin the graphics card's 32 bits
  /// would not do.
  matrix(): number[] {
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [rise, lie] = [Math.sin(this.tilt), Math.cos(this.tilt)];
    const [kx, ky] = [2 * this.scale / this.width, 2 * this.scale / this.height];
    const [ox, oy] = [2 * this.offsetX / this.width, -2 * this.offsetY / this.height];
    // Rows: how a step in x, y and z moves right, up, and away from the eye.
    const right = [c, -s, 0], high = [s * lie, c * lie, rise], deep = [s * rise, c * rise, -lie];
    const columns = [0, 1, 2].map(i => {
      const w = this.isTilted ? deep[i] / this.distance : 0;
      return [kx * right[i] + ox * w, ky * high[i] + oy * w, kDepth[0] * w, w];
    });
    const shift = columns[2].map(rise => -rise * this.z);
    return [...columns.flat(), shift[0] + ox, shift[1] + oy, shift[2] + kDepth[0] + kDepth[1], shift[3] + 1];
  }

  /// Moves the camera so that the map's point (x, y) appears at this pixel.
  hold(x: number, y: number, sx: number, sy: number): void {
    const [nowX, nowY] = this.toMap(sx, sy);
    this.x += x - nowX;
    this.y += y - nowY;
  }

  /// Moves the view by pixels.
  step(right: number, down: number): void {
    const [x, y] = this.middle;
    this.hold(...this.toMap(x + right, y + down), x, y);
  }

  /// Clamps a scale to the useful range.
  bounded(scale: number): number { return Math.min(kMaxScale, Math.max(kMinScale, scale)); }

  zoom(factor: number, sx: number, sy: number): void {
    const [x, y] = this.toMap(sx, sy);
    this.scale = this.bounded(this.scale * factor);
    this.hold(x, y, sx, sy);
  }

  /// Tilts and turns by rad.
  lean(tilt: number, turn: number): void {
    this.tilt = Math.min(kMaxTilt, Math.max(0, this.tilt + tilt));
    this.turn = Math.atan2(Math.sin(this.turn + turn), Math.cos(this.turn + turn));
  }

  /// Shows the whole of this part of the map in the area that no card covers.
  show(minX: number, minY: number, maxX: number, maxY: number): void {
    this.x = (minX + maxX) / 2;
    this.y = (minY + maxY) / 2;
    const [c, s] = [Math.abs(Math.cos(this.turn)), Math.abs(Math.sin(this.turn))];
    const wide = c * (maxX - minX) + s * (maxY - minY), high = s * (maxX - minX) + c * (maxY - minY);
    // Tilted, the near edge is 1 / (1 - nearer * scale) times as large, and all is as much lower as it lies.
    const nearer = high * Math.sin(this.tilt) / (2 * kFocus * this.height), low = high * Math.cos(this.tilt);
    const room = Math.min(this.roomWidth / (wide + this.roomWidth * nearer), this.roomHeight / (low + this.roomHeight * nearer));
    this.scale = Math.min(60, Math.max(kMinScale, room));
  }
}

/// A point near the view, to which shapes are relative while 32 bits draw them: 100 km from the map's origin they would
/// be off by 8 mm, which is six pixels close up.
export type Anchor = [number, number];  // m in map

/// The middle of the view, rounded.
export function anchorAt({ x, y }: { x: number; y: number }): Anchor {
  return [Math.round(x / kApart) * kApart, Math.round(y / kApart) * kApart];
}

/// False: the view has moved away from it.
export function isNear([x, y]: Anchor, view: { x: number; y: number }): boolean {
  return Math.abs(x - view.x) < kApart && Math.abs(y - view.y) < kApart;
}
