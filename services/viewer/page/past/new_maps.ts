// Where on a time line another map began, in a frame of its own. A viewer that started again and an epoch that corrects
// the map as a whole are no such places.
import { World } from "../world";

const kMost = 100;

export class NewMaps {
  places: number[] = [];           // in the time line's units
  private begun: number[] = [];    // s, of each: the time of the map's first pose
  private run = 0;
  private epoch = 0;
  private entered: number | null = null;  // where the present epoch began, if it was seen to

  /// Call it after each frame; `place`: on the time line.
  note({ run, epoch, state }: World, place: number): void {
    if (run !== this.run) this.entered = null;
    else if (epoch !== this.epoch) this.entered = place;
    [this.run, this.epoch] = [run, epoch];
    if (this.entered === null || !state?.pose || state.new_map_age === null) return;
    const began = state.pose.utime / 1e6 - state.new_map_age;
    if (this.begun.some(other => Math.abs(other - began) < 1)) return;
    this.begun = [...this.begun, began].slice(-kMost);
    this.places = [...this.places, this.entered].slice(-kMost);
  }

  clear(): void {
    this.places = [];
    this.begun = [];
  }
}
