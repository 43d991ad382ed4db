// Measures between two places: distance, height, slope.
import { byId, closeButton, list, make, metres } from "../format";
import { cellAt, heightOf, Place, World } from "../world";

export class Ruler {
  isOn = false;
  places: Place[] = [];  // none, one, or two
  private card = byId("ruler");

  constructor(private world: World, private changed: () => void) {}

  toggle(): void {
    this.isOn = !this.isOn;
    this.places = [];
    this.changed();
  }

  /// The places are of a map that is no longer shown.
  forget(): void {
    if (this.places.length === 0) return;
    this.places = [];
    this.changed();
  }

  /// Sets the first place, then the second; a third call starts again.
  put([x, y]: [number, number]): void {
    const hit = cellAt(this.world, x, y);
    if (this.places.length === 2) this.places = [];
    this.places.push({ x, y, height: hit && heightOf(hit.tile, hit.index) });
    this.changed();
  }

  show(): void {
    byId("measure").setAttribute("aria-pressed", String(this.isOn));
    this.card.hidden = !this.isOn;
    if (!this.isOn) return;
    this.card.replaceChildren(make("h3", "Measure", "", closeButton(() => this.toggle())), this.facts());
  }

  private facts(): HTMLElement {
    const [from, to] = this.places;
    if (!to) return make("p", from ? "Click the other place" : "Click a place, then another one");
    const [dx, dy] = [to.x - from.x, to.y - from.y], flat = Math.hypot(dx, dy);
    const up = from.height === null || to.height === null ? null : to.height - from.height;
    const facts = make("dl");
    list(facts, [
      ["Distance", metres(flat)],
      ["Height", up === null ? "not known" : signed(up)],
      ["Slope", up === null || flat < 0.1 ? "–" : `${up < 0 ? "−" : "+"}${Math.abs(100 * up / flat).toFixed(1)} %`],
      ["x, y", `${signed(dx)}, ${signed(dy)}`],
    ]);
    return facts;
  }
}

function signed(m: number): string {
  return (m < 0 ? "−" : "+") + metres(Math.abs(m));
}
