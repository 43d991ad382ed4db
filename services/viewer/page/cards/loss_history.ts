// The loss rates of each process in the last minute, and their plot.
import { Service } from "../world";

const kKept = 60;  // values, one per SERVICE_STATUS, so 60 s
const kSvg = "http://www.w3.org/2000/svg";

interface History { uptime: number; rates: number[] }  // s; messages and other losses per second

export class LossHistory {
  private histories = new Map<string, History>();

  /// Adds each status once, however often it is shown.
  note(services: Service[]): void {
    for (const { name, uptime, losses } of services) {
      const known = this.histories.get(name);
      if (known && known.uptime === uptime) continue;
      const rates = known && uptime > known.uptime ? known.rates : [];
      rates.push(losses.reduce((sum, [, , rate]) => sum + Math.max(0, rate), 0));
      this.histories.set(name, { uptime, rates: rates.slice(-kKept) });
    }
    for (const name of this.histories.keys()) if (!services.some(s => s.name === name)) this.histories.delete(name);
  }

  /// The plot of a process; null if nothing was lost.
  line(name: string): SVGElement | null {
    const rates = this.histories.get(name)?.rates ?? [], most = Math.max(0, ...rates);
    if (most === 0) return null;
    const svg = document.createElementNS(kSvg, "svg");
    svg.setAttribute("class", "spark");
    svg.setAttribute("viewBox", `0 0 ${kKept} 16`);
    const title = document.createElementNS(kSvg, "title");
    title.textContent = `The last minute, at most ${most < 10 ? most.toFixed(1) : Math.round(most)}/s`;
    const line = document.createElementNS(kSvg, "polyline");
    const first = kKept - rates.length;
    line.setAttribute("points", rates.map((rate, i) => `${first + i},${15 - 14 * rate / most}`).join(" "));
    svg.append(title, line);
    return svg;
  }
}
