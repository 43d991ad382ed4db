// A point near the view, to which shapes are relative while 32 bits draw them: 100 km from the map's origin they would
// be off by 8 mm, which is six pixels close up.
const kApart = 2000;  // m

export type Anchor = [number, number];  // m in map

/// The middle of the view, rounded.
export function anchorAt({ x, y }: { x: number; y: number }): Anchor {
  return [Math.round(x / kApart) * kApart, Math.round(y / kApart) * kApart];
}

/// False: the view has moved away from it.
export function isNear([x, y]: Anchor, view: { x: number; y: number }): boolean {
  return Math.abs(x - view.x) < kApart && Math.abs(y - view.y) < kApart;
}
