// The free area between the cards: where its centre is, and how a selected place is kept out from under its card.
import { Camera } from "../drawing/camera";
import { byId } from "../format";

const kMargin = 24;  // pixels around the place

/// As in page.css: where the card spans the screen and the map is visible above it.
const kPhone = "(max-width: 600px) and (min-height: 501px)";

/// Pixels at the bottom of the screen that the card covers.
function takenBelow(): number {
  const card = byId("cell");
  return card.hidden || !matchMedia(kPhone).matches ? 0 : innerHeight - card.getBoundingClientRect().top;
}

/// Gives the camera the size of the map and the area not covered by cards; page.css says how much the permanent ones
/// cover.
export function fit(camera: Camera, map: HTMLElement): void {
  const style = getComputedStyle(document.documentElement);
  const [above, beside, below, air] = ["above", "beside", "below", "air"].map(edge => parseFloat(style.getPropertyValue(`--${edge}`)) || 0);
  const low = Math.max(below, takenBelow());
  [camera.width, camera.height] = [map.clientWidth, map.clientHeight];
  [camera.offsetX, camera.offsetY] = [-beside / 2, (above - low) / 2];
  [camera.roomWidth, camera.roomHeight] = [camera.width - beside - 2 * air, camera.height - above - low - 2 * air];
}

/// Moves the map so that the place, m in map, is not hidden by its card.
export function uncover(camera: Camera, x: number, y: number, id: "cell" | "ruler" = "cell"): void {
  const element = byId(id), card = element.getBoundingClientRect(), [sx, sy] = camera.toScreen(x, y);
  const isBeside = sx < card.left - kMargin || sx > card.right + kMargin || sy < card.top - kMargin || sy > card.bottom + kMargin;
  if (element.hidden || isBeside) return;
  if (!matchMedia(kPhone).matches) camera.hold(x, y, card.right + 2 * kMargin, sy);
  else if (id === "ruler") camera.hold(x, y, sx, card.bottom + 2 * kMargin);
  else camera.hold(x, y, sx, (byId("bar").getBoundingClientRect().bottom + card.top) / 2);
}
