// The scale bar of the map.
import { byId } from "../format";

let shown = 0;

/// `scale`: pixels per m.
export function showScale(scale: number): void {
  if (scale === shown) return;  // it would be painted anew with each picture of the map
  shown = scale;
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
  const step = steps.find(s => s * scale > 70) ?? 5000;
  const rule = byId("rule");
  rule.textContent = step < 1 ? `${step * 100} cm` : step < 1000 ? `${step} m` : `${step / 1000} km`;
  rule.style.width = `${step * scale}px`;
}
