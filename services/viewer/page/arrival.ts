// The first picture: the map comes in several frames, and to draw each of them takes longer than they do.
import { World } from "./world";

const kPatience = 3000;  // ms: a map that grows while it comes may never be whole

export class Arrival {
  shown = false;  // whether the view was ever put where the map is
  // For tests/services/viewer/page, until the whole is drawn or patience ends: drawings of a part of the map, and how
  // often a part was asked for.
  parts = 0;
  asked = 0;
  private counts = true;

  constructor(private world: World) {}

  /// Whether each frame is drawn as it comes: the map is whole, or has been shown before. `now`: ms since the page was
  /// asked for.
  drawsEachFrame(now: number): boolean {
    const { state, tiles } = this.world;
    if (this.shown || !state || tiles.size >= state.tiles) return true;
    return state.source !== "map" && now > kPatience;  // of a saved one the whole is shown
  }

  /// Now and then: whether there is a part to be seen meanwhile.
  asksForPart(): boolean {
    const isPart = !this.shown && this.world.tiles.size > 0;
    if (isPart) ++this.asked;
    return isPart;
  }

  /// The world as it is now, at `now`.
  drew(now: number): void {
    const { state, tiles } = this.world;
    if (!this.counts || tiles.size === 0) return;
    this.counts = now < kPatience && !(state && tiles.size >= state.tiles);
    if (this.counts) ++this.parts;
  }
}
