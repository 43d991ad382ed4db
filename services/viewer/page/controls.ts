// The buttons over the map and their keys.
import { byId } from "./format";
import { listenToKeys } from "./keys";

export interface Controls {
  follow(): void; north(): void; tilt(): void; measure(): void; save(): void; panel(): void; whole(): void; live(): void; cloud(): void; escape(): void;
  zoom(factor: number): void;
}

const kZoom = 1.5;

/// `walk`, `enter`: the arrow keys and Enter, as in keys.ts.
export function wireControls(to: Controls, map: HTMLElement, walk: (right: number, down: number, leans: boolean) => void, enter: () => void): void {
  const nearer = () => to.zoom(kZoom), farther = () => to.zoom(1 / kZoom);
  const buttons: Record<string, () => void> = { follow: to.follow, north: to.north, tilt: to.tilt, measure: to.measure, save: to.save, aside: to.panel, in: nearer, out: farther, whole: to.whole };
  for (const [id, press] of Object.entries(buttons)) byId(id).onclick = press;
  const playOrPause = () => {
    if (!document.activeElement?.matches("button, summary, [type=checkbox]") && !byId("timeline").hidden) byId("pause").click();
  };
  listenToKeys(map, { f: to.follow, n: to.north, t: to.tilt, m: to.measure, p: to.save, l: to.live, h: to.panel, c: to.cloud,
    "+": nearer, "=": nearer, "-": farther, "0": to.whole, " ": playOrPause, Escape: to.escape }, walk, enter);
}
