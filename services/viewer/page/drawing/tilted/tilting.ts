// The transition between the view from above and the tilted view, and the height of the tilted view's pivot.
import { heightAt, Pose, World } from "../../world";
import { Camera } from "../camera";

const kTilted = 0.96;  // rad, the tilt of the button
const kLasts = 350;    // ms
const kRise = 0.15;    // share of the remaining height difference, per picture

export class Tilting {
  private from = 0;
  private to = 0;
  private began = -kLasts;  // ms

  constructor(private camera: Camera) {}

  toggle(now: number): void {
    this.from = this.camera.tilt;
    this.to = this.camera.isTilted ? 0 : kTilted;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.began = still ? now - kLasts : now;
    if (still) this.camera.tilt = this.to;
  }

  /// Stops the transition: the user tilts by hand.
  stop(): void { this.began = -kLasts; }

  /// Advances the transition. True: it is under way.
  step(now: number, world: World, followed: Pose | null): boolean {
    const { camera } = this, share = (now - this.began) / kLasts;
    const z = followed ? followed.z : heightAt(world, camera.x, camera.y);
    const isRising = z !== null && camera.isTilted && Math.abs(z - camera.z) > 0.01;
    if (z !== null) camera.z = isRising ? camera.z + kRise * (z - camera.z) : z;
    if (this.began < 0) return isRising;
    camera.tilt = share >= 1 ? this.to : this.from + (this.to - this.from) * share * share * (3 - 2 * share);
    if (share >= 1) this.began = -kLasts;
    return isRising || share < 1;
  }
}
