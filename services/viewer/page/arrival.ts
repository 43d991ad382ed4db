// The first picture: the map comes in several frames, and to draw each of them takes longer than they do.
import { World } from "./world";

const kPatience = 3000;  // ms: a map that grows while it comes may never be whole

/// Whether each frame is drawn as it comes: the map is whole, or has been `shown` before. `now`: ms since the page was
/// asked for.
export function drawsEachFrame(world: World, shown: boolean, now: number): boolean {
  const { state, tiles } = world;
  if (shown || !state || tiles.size >= state.tiles) return true;
  return state.source !== "map" && now > kPatience;  // of a saved one the whole is shown
}
