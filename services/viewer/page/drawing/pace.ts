// Whether the machine is quick enough to draw between what comes. One that is not would fall behind in drawing alone.

const kSlow = 90;       // ms a picture
const kForget = 0.985;  // so that it is tried again

export class Pace {
  private ms = 16;       // a picture, when one followed the other
  private last = 0;      // ms
  private goesOn = false;

  /// At each picture; `wants`: something moves.
  allows(now: number, wants: boolean): boolean {
    if (this.goesOn) this.ms += 0.3 * (now - this.last - this.ms);
    else this.ms *= kForget;
    this.last = now;
    this.goesOn = wants && this.ms < kSlow;
    return this.goesOn;
  }
}
