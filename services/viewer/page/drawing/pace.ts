// Whether the machine is fast enough to draw between frames. A slow one would fall behind by drawing alone.

const kSlow = 90;       // ms per picture
const kForget = 0.985;  // decay, so that it is tried again

export class Pace {
  private ms = 16;       // per picture, while pictures follow each other
  private last = 0;      // ms
  private goesOn = false;

  /// Call it at each picture. `wants`: something moves.
  allows(now: number, wants: boolean): boolean {
    if (this.goesOn) this.ms += 0.3 * (now - this.last - this.ms);
    else this.ms *= kForget;
    this.last = now;
    this.goesOn = wants && this.ms < kSlow;
    return this.goesOn;
  }
}
