// What the user chose. It lives in the address (after #), so that a link shows the same.
import { Camera } from "./drawing/camera";
import { Mode, Theme } from "./drawing/palette";

export interface Layers { grid: boolean; relief: boolean; curbs: boolean; markings: boolean; path: boolean; points: boolean; localized: boolean }

export class Settings {
  mode: Mode = "class";
  theme: "auto" | Theme = "auto";
  follow = true;
  headingUp = false;
  points: "height" | "intensity" = "height";  // what colours the LiDAR's points
  layers: Layers = { grid: true, relief: true, curbs: true, markings: true, path: true, points: true, localized: true };
  hasView = false;  // the address said where to look

  /// The theme that is in force.
  get look(): Theme {
    if (this.theme !== "auto") return this.theme;
    return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  }

  read(camera: Camera): void {
    const words = new URLSearchParams(location.hash.slice(1));
    const at = (words.get("at") ?? "").split(",").map(Number);
    if (at.length === 4 && at.every(Number.isFinite) && at[2] > 0) {
      [camera.x, camera.y, camera.scale, camera.turn] = at;
      this.hasView = true;
    }
    const mode = words.get("colour");
    if (mode && ["class", "paper", "height", "cost", "confidence", "age"].includes(mode)) this.mode = mode as Mode;
    const theme = words.get("theme");
    if (theme === "light" || theme === "dark") this.theme = theme;
    if (words.has("follow")) this.follow = words.get("follow") === "1";
    const tilt = Number(words.get("tilt"));
    if (tilt > 0) camera.lean(tilt * Math.PI / 180, 0);
    if (words.get("points") === "intensity") this.points = "intensity";
    this.headingUp = words.get("up") === "heading";
    for (const name of (words.get("off") ?? "").split(".")) if (name in this.layers) this.layers[name as keyof Layers] = false;
  }

  write(camera: Camera): void {
    const off = Object.entries(this.layers).filter(([, on]) => !on).map(([name]) => name);
    const words = [`at=${camera.x.toFixed(2)},${camera.y.toFixed(2)},${camera.scale.toPrecision(4)},${camera.turn.toFixed(3)}`,
      `follow=${this.follow ? 1 : 0}`];
    if (this.mode !== "class") words.push(`colour=${this.mode}`);
    if (this.theme !== "auto") words.push(`theme=${this.theme}`);
    if (this.headingUp) words.push("up=heading");
    if (camera.isTilted) words.push(`tilt=${(camera.tilt * 180 / Math.PI).toFixed(0)}`);
    if (this.points !== "height") words.push(`points=${this.points}`);
    if (off.length) words.push(`off=${off.join(".")}`);
    history.replaceState(null, "", "#" + words.join("&"));
  }
}
