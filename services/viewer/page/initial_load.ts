// The first picture. The map arrives in several frames, and drawing each of them takes longer than receiving them.
import { World } from "./world";

const kPatience = 3000;  // ms; a map that still grows may never be complete

export class InitialLoad {
  shown = false;  // whether the view was ever moved to the map
  // For tests/services/viewer/page, until the whole map is drawn or kPatience ends: how often a part of the map was
  // drawn, and how often it was requested.
  parts = 0;
  asked = 0;
  private counts = true;

  constructor(private world: World) {}

  /// Whether each frame is drawn on arrival: once the map is complete or was shown before. `now`: ms since the page was
  /// requested.
  drawsEachFrame(now: number): boolean {
    const { state, tiles } = this.world;
    if (this.shown || !state || tiles.size >= state.tiles) return true;
    return state.source !== "map" && now > kPatience;  // a saved map is drawn when it is complete
  }

  /// Called periodically: whether there is a partial map to draw meanwhile.
  asksForPart(): boolean {
    const isPart = !this.shown && this.world.tiles.size > 0;
    if (isPart) ++this.asked;
    return isPart;
  }

  /// Called after the world was drawn, at `now`.
  drew(now: number): void {
    const { state, tiles } = this.world;
    if (!this.counts || tiles.size === 0) return;
    this.counts = now < kPatience && !(state && tiles.size >= state.tiles);
    if (this.counts) ++this.parts;
  }
}
