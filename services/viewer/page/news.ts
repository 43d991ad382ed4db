// Whether there is anything to draw: frames also come of a saved map, and while a log stands.
import { isLocalized } from "./staleness";
import { World } from "./world";

export class News {
  private poses = "";

  /// Whether the world looks other than when this was asked last.
  isOther({ state, cloud, cleared, changed, gone, curbsChanged, markingsChanged, pathChanged, scanChanged }: World): boolean {
    const poses = JSON.stringify([state?.pose, state && isLocalized(state) && state.localized?.utime, cloud.received]), isOther = poses !== this.poses;
    this.poses = poses;
    return isOther || cleared || curbsChanged || markingsChanged || pathChanged || scanChanged || changed.size + gone.size > 0;
  }
}
