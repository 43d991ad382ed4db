// The user's choices. They are kept in the address (after #), so that a link restores them.
import { Camera } from "./drawing/camera";
import { CloudColour, kCloudColours, Mode, Theme } from "./drawing/palette";

export interface Layers { grid: boolean; relief: boolean; curbs: boolean; markings: boolean; path: boolean; points: boolean; cloud: boolean; localized: boolean }

export class Settings {
  mode: Mode = "class";
  theme: "auto" | Theme = "auto";
  follow = true;
  headingUp = false;
  points: "height" | "intensity" = "height";  // what colours the LiDAR's points
  cloud: CloudColour = "height";              // what colours the dense cloud
  layers: Layers = { grid: true, relief: true, curbs: true, markings: true, path: true, points: true, cloud: false, localized: true };
  panel = true;     // beside the map; on a small screen it is always a sheet over the map
  hasView = false;  // the address has a view
  private written = "";

  /// The theme in use.
  get look(): Theme {
    if (this.theme !== "auto") return this.theme;
    return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  }

  /// North or heading up. If the map was turned by hand or by following, the first call turns it upright.
  toggleNorth(camera: Camera): void {
    const isTurned = !this.headingUp && camera.turn !== 0 && !this.follow;
    this.headingUp = !this.headingUp && !isTurned;
    if (this.headingUp) this.follow = true;
    else camera.turn = 0;
  }

  /// What the address does not hold gets its default.
  read(camera: Camera): void {
    const words = new URLSearchParams(location.hash.slice(1));
    this.hasView = false;
    camera.tilt = 0;
    const at = (words.get("at") ?? "").split(",").map(Number);
    if (at.length === 4 && at.every(Number.isFinite) && at[2] > 0) {
      [camera.x, camera.y, camera.scale, camera.turn] = at;
      camera.scale = camera.bounded(camera.scale);
      this.hasView = true;
    }
    const mode = words.get("colour");
    this.mode = mode && ["class", "paper", "height", "cost", "confidence", "age"].includes(mode) ? mode as Mode : "class";
    const theme = words.get("theme");
    this.theme = theme === "light" || theme === "dark" ? theme : "auto";
    this.follow = !words.has("follow") || words.get("follow") === "1";
    const tilt = Number(words.get("tilt"));
    if (tilt > 0) camera.lean(tilt * Math.PI / 180, 0);
    this.points = words.get("points") === "intensity" ? "intensity" : "height";
    this.panel = words.get("panel") !== "0";
    this.headingUp = words.get("up") === "heading";
    const off = (words.get("off") ?? "").split(".");
    for (const name of Object.keys(this.layers) as (keyof Layers)[]) this.layers[name] = !off.includes(name);
    const cloud = kCloudColours.find(([colour]) => colour === words.get("cloud"));  // it costs bandwidth: off unless asked for
    this.layers.cloud = !!cloud;
    if (cloud) this.cloud = cloud[0];
  }

  write(camera: Camera): void {
    const off = Object.entries(this.layers).filter(([name, on]) => !on && name !== "cloud").map(([name]) => name);
    const words = [`at=${camera.x.toFixed(2)},${camera.y.toFixed(2)},${camera.scale.toPrecision(4)},${camera.turn.toFixed(3)}`,
      `follow=${this.follow ? 1 : 0}`];
    if (this.mode !== "class") words.push(`colour=${this.mode}`);
    if (this.theme !== "auto") words.push(`theme=${this.theme}`);
    if (this.headingUp) words.push("up=heading");
    if (camera.isTilted) words.push(`tilt=${(camera.tilt * 180 / Math.PI).toFixed(0)}`);
    if (this.points !== "height") words.push(`points=${this.points}`);
    if (this.layers.cloud) words.push(`cloud=${this.cloud}`);
    if (off.length) words.push(`off=${off.join(".")}`);
    if (!this.panel) words.push("panel=0");
    const address = "#" + words.join("&");
    if (address === this.written) return;  // browsers limit the changes per minute
    this.written = address;
    history.replaceState(null, "", address);
  }
}
