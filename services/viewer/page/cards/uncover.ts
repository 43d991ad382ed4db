// What was asked about is seen beside its card.
import { Camera } from "../drawing/camera";
import { byId } from "../format";

const kMargin = 24;  // pixels about the place

/// As in page.css: where the card lies across the screen, and the map is seen above it.
const kPhone = "(max-width: 600px) and (min-height: 501px)";

/// Pixels at the bottom of the screen that the card takes from the map.
export function takenBelow(): number {
  const card = byId("cell");
  return card.hidden || !matchMedia(kPhone).matches ? 0 : innerHeight - card.getBoundingClientRect().top;
}

/// Moves the map so that the place, m in map, is not behind the card.
export function uncover(camera: Camera, x: number, y: number): void {
  const element = byId("cell"), card = element.getBoundingClientRect(), [sx, sy] = camera.toScreen(x, y);
  const isBeside = sx < card.left - kMargin || sx > card.right + kMargin || sy < card.top - kMargin || sy > card.bottom + kMargin;
  if (element.hidden || isBeside) return;
  if (takenBelow() > 0) camera.hold(x, y, sx, (byId("bar").getBoundingClientRect().bottom + card.top) / 2);
  else camera.hold(x, y, card.right + 2 * kMargin, sy);
}
