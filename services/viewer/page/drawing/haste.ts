// Without a graphics card a tilted picture takes a tenth of a second. While the user moves the view it is drawn coarser,
// and when the view rests as fine as the screen is.
import { Camera } from "./camera";
import { drawsInSoftware } from "./software";

const kRests = 200;  // ms, after the last motion
const kShare = 0.5;  // of the screen's pixels, each way

export class Haste {
  private left: number[] | null = null;  // where the view was after the last picture
  private moved = -kRests;               // ms
  private timer = 0;

  constructor(private camera: Camera, private canvases: HTMLCanvasElement[], private redraw: () => void) {}

  /// At the beginning of a picture: whether it is a coarse one, for which the canvases then have their size.
  begin(now: number): boolean {
    const { camera, left } = this;
    if (left && placeOf(camera).some((value, i) => value !== left[i])) this.moved = now;
    const isHasty = camera.isTilted && now - this.moved < kRests && drawsInSoftware();
    clearTimeout(this.timer);
    if (isHasty) this.timer = setTimeout(this.redraw, kRests);
    this.fit((isHasty ? kShare : 1) * Math.min(2, devicePixelRatio || 1));
    return isHasty;
  }

  /// Before the page itself tilts the view, and after it has followed the vehicle, which goes on for hours.
  follow(): void { this.left = placeOf(this.camera); }

  /// The next picture is a fine one.
  end(): void {
    this.left = null;
    this.moved = -kRests;
  }

  /// A canvas that is given a size, the same too, is empty until it is drawn.
  private fit(dots: number): void {
    const [width, height] = [this.camera.width, this.camera.height].map(pixels => Math.round(pixels * dots));
    for (const canvas of this.canvases) {
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    }
  }
}

function placeOf({ x, y, scale, turn, tilt }: Camera): number[] { return [x, y, scale, turn, tilt]; }
