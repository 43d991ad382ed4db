// Without a graphics card a tilted picture takes 0.1 s. So it is drawn coarser while the user moves the view, and at
// full resolution once the view rests.
import { Camera } from "./camera";
import { drawsInSoftware } from "./software";

const kRests = 200;  // ms after the last motion
const kShare = 0.5;  // share of the screen's pixels, each way

export class DraftMode {
  private left: number[] | null = null;  // the view after the last picture
  private moved = -kRests;               // ms
  private timer = 0;

  constructor(private camera: Camera, private canvases: HTMLCanvasElement[], private redraw: () => void) {}

  /// Called at the start of a picture. Returns whether it is a coarse one, and sizes the canvases for it.
  begin(now: number): boolean {
    const { camera, left } = this;
    if (left && placeOf(camera).some((value, i) => value !== left[i])) this.moved = now;
    const isDraft = camera.isTilted && now - this.moved < kRests && drawsInSoftware();
    clearTimeout(this.timer);
    if (isDraft) this.timer = setTimeout(this.redraw, kRests);
    this.fit((isDraft ? kShare : 1) * Math.min(2, devicePixelRatio || 1));
    return isDraft;
  }

  /// Call it before the page tilts the view by itself, and after the camera followed the vehicle: neither counts as a
  /// motion.
  follow(): void { this.left = placeOf(this.camera); }

  /// Makes the next picture a full one.
  end(): void {
    this.left = null;
    this.moved = -kRests;
  }

  /// Setting a canvas's size, even to the same value, clears the canvas, so it is set only if it differs.
  private fit(dots: number): void {
    const [width, height] = [this.camera.width, this.camera.height].map(pixels => Math.round(pixels * dots));
    for (const canvas of this.canvases) {
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    }
  }
}

function placeOf({ x, y, scale, turn, tilt }: Camera): number[] { return [x, y, scale, turn, tilt]; }
