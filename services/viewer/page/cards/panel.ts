// The controls: colours with their legend, layers, theme, data of the vehicle.
import { byId, fixed, list, make, metres, seconds, setText } from "../format";
import { classColours, CloudColour, css, kClassNames, kCloudColours, kModes, cloudRamp, Mode, ramp, Rgb, Theme } from "../drawing/palette";
import { kInk } from "../drawing/ink";
import { Layers, Settings } from "../settings";
import { kOld } from "../staleness";
import { Pose, State } from "../world";

const kSvg = "http://www.w3.org/2000/svg";
const kLayers: [keyof Layers, string][] =
  [["grid", "Cells"], ["relief", "Relief"], ["curbs", "Curbs"], ["markings", "Paint"], ["path", "Path"], ["points", "LiDAR"], ["cloud", "Cloud"], ["localized", "Localizer"]];
const kPointColours: [Settings["points"], string][] = [["height", "Points by height"], ["intensity", "By intensity"]];
/// The legend of the lines: layer, label, dashes.
const kLineKeys: [keyof Layers, string, string][] =
  [["curbs", "Curb", "none"], ["curbs", "Lowered", "4 3"], ["curbs", "Inferred", "0.5 3.5"], ["path", "Driven", "none"], ["markings", "Road paint", "none"]];
const kKeys: [string, string][] = [
  ["F", "follow the vehicle"], ["N", "north or heading up"], ["T", "tilt"], ["M", "measure"], ["C", "the dense cloud"], ["P", "save a picture"], ["L", "back to what is live"],
  ["Space", "pause, go on"], ["0", "the whole map"], ["H", "hide or show the panel"], ["+ −", "zoom"], ["Arrows", "move; with Shift tilt and turn"], ["Enter", "what is in the middle"], ["Esc", "close"],
  ["Drag", "move; right button: tilt"], ["Two fingers", "zoom; side by side upwards: tilt"], ["Long press", "what is there"]];
const kAges = ["newest", "4 s", "24 s", "2 min", "10 min"];  // 601^share - 1 s, as in kPicture's shader
const kDraw = 24;  // pixels a finger moves before it pulls the sheet
const kThemes: ["auto" | Theme, string][] = [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]];

export class Panel {
  constructor(private settings: Settings, private changed: () => void) {
    segments("colours", kModes, () => settings.mode === "paper" ? "class" : settings.mode, mode => { settings.mode = mode; changed(); });
    segments("themes", kThemes, () => settings.theme, theme => { settings.theme = theme; changed(); });
    for (const [name, title] of kLayers) {
      const label = this.toggle(title, () => settings.layers[name], on => { settings.layers[name] = on; });
      label.dataset.layer = name;
      if (name === "cloud") label.title = "The dense cloud within 33 m of the vehicle (C); up to 0.2 MB/s";
      byId("layers").append(label);
    }
    const paper = this.toggle("As in paper", () => settings.mode === "paper", on => { settings.mode = on ? "paper" : "class"; });
    paper.title = "Cells by class, in the colours of the paper's figures";
    byId("layers").append(paper);
    segments("point-colours", kPointColours, () => settings.points, colour => { settings.points = colour; changed(); });
    segments("cloud-colours", kCloudColours, () => settings.cloud, colour => { settings.cloud = colour; changed(); });
    list(byId("keys"), kKeys);
    this.listen(byId("handle"));
  }

  /// On a small screen: a tap on the handle, or a finger that pulls it up or down.
  private listen(handle: HTMLElement): void {
    let from = 0, isDrawn = false;
    handle.onpointerdown = event => { from = event.clientY; isDrawn = false; handle.setPointerCapture(event.pointerId); };
    handle.onpointerup = event => {
      isDrawn = Math.abs(event.clientY - from) > kDraw;
      if (isDrawn) this.open(event.clientY < from);
    };
    handle.onclick = () => {
      if (!isDrawn) this.open(!this.isOpen);
      isDrawn = false;
    };
  }

  get isOpen(): boolean { return byId("panel").classList.contains("open"); }

  open(isOpen: boolean): void {
    byId("panel").classList.toggle("open", isOpen);
    byId("handle").setAttribute("aria-expanded", String(isOpen));
  }

  private toggle(title: string, get: () => boolean, set: (on: boolean) => void): HTMLElement {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = get();
    box.onchange = () => { set(box.checked); this.changed(); };
    refreshers.push(() => { box.checked = get(); });
    return make("label", "", "", box, document.createTextNode(title));
  }

  /// Call it after the settings changed.
  refresh(range: [number, number]): void {
    for (const refresh of refreshers) refresh();
    const { mode, look, layers } = this.settings;
    byId("point-colours").hidden = !layers.points;
    byId("cloud").hidden = !layers.cloud;
    byId("cloud-legend").replaceChildren(bar(cloudRamp(look, this.settings.cloud), cloudEnds(this.settings.cloud, range)));
    byId("line-keys").replaceChildren(...kLineKeys.filter(([layer]) => layers[layer]).map(([layer, title, dashes]) => lineKey(look, layer, title, dashes)));
    byId("legend").replaceChildren(mode === "class" || mode === "paper" ? keys(look, mode) : scale(mode, range));
  }

  showState(state: State, speed: number | null): void {
    const { pose } = state;
    byId("vehicle").hidden = !pose;
    if (!pose) return;
    list(byId("facts"), [
      ["Speed", speed === null ? "–" : `${speed.toFixed(1)} m/s`],
      ["Position", `${[pose.x, pose.y, pose.z].map(m => fixed(m, 2)).join(", ")} m`],
      ["Yaw", `${degrees(pose.yaw)}°`],
      ["Uncertainty", uncertainty(pose)],
      ["Registration", registration(pose), pose.lost || !pose.registered],
      ["Residual, inliers", `${metres(pose.residual)}, ${Math.round(100 * pose.inliers)} %`],
      ...localization(state),
      ["Map", `${state.tiles.toLocaleString("en")} tiles${state.behind ? `, ${state.behind} on their way` : ""}`],
    ]);
  }
}

const refreshers: (() => void)[] = [];

function registration(pose: NonNullable<State["pose"]>): string {
  if (pose.lost) return "lost";
  if (!pose.registered) return "not registered";
  const words = [pose.without_odometry ? "no odometry" : "", pose.degenerate ? "degenerate" : ""].filter(Boolean);
  return words.join(", ") || (pose.stationary ? "good, standing" : "good");
}

/// One sigma in the worst direction, and of the heading.
function uncertainty({ covariance: [xx, xy, yy, turn] }: Pose): string {
  const worst = Math.sqrt(Math.max(0, (xx + yy) / 2 + Math.hypot((xx - yy) / 2, xy)));
  return `${metres(worst)}, ${(Math.sqrt(Math.max(0, turn)) * 180 / Math.PI).toFixed(2)}°`;
}

/// The localizer's state, if there is one.
function localization({ localized, pose }: State): [string, string, boolean?][] {
  if (!localized) return [];
  if (localized.age > kOld) return [["Localizer", `silent for ${seconds(localized.age)}`, true]];
  const where = `${fixed(localized.x, 2)}, ${fixed(localized.y, 2)} m`;
  const apart = localized.here && pose ? metres(Math.hypot(localized.x - pose.x, localized.y - pose.y)) : "in another map";
  return [
    ["Localizer", localized.lost ? "LOST: its pose is a guess" : where, localized.lost],
    ["Its uncertainty", uncertainty(localized)],
    ["From the mapper", apart],
  ];
}

function degrees(rad: number): string {
  const tenths = Math.round(rad * 1800 / Math.PI) % 3600;
  return ((tenths + 3600) % 3600 / 10).toFixed(1);
}

function segments<T extends string>(id: string, choices: [T, string][], get: () => T, set: (choice: T) => void): void {
  const buttons = choices.map(([choice, title]) => {
    const button = make("button", title);
    button.dataset.title = title;
    button.setAttribute("role", "radio");
    button.onclick = () => set(choice);
    return button;
  });
  const group = byId(id);
  group.append(...buttons);
  group.addEventListener("keydown", event => {  // like radio buttons: Tab focuses the chosen one, arrows choose another
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const next = (choices.findIndex(([choice]) => choice === get()) + step + choices.length) % choices.length;
    set(choices[Math.max(0, next)][0]);
    buttons[Math.max(0, next)].focus();
  });
  refreshers.push(() => buttons.forEach((button, i) => {
    const isChosen = choices[i][0] === get();
    button.setAttribute("aria-checked", String(isChosen));
    button.tabIndex = isChosen ? 0 : -1;
  }));
}

function keys(theme: Theme, mode: Mode): HTMLElement {
  const colours = classColours(theme, mode);
  return make("div", "", "keys", ...kClassNames.flatMap((name, i) => {
    const colour = colours[i];
    if (!colour) return [];
    const key = make("i");
    key.style.setProperty("--key", css(colour));
    return [make("span", "", "", key, document.createTextNode(name))];
  }));
}

/// A legend entry: a piece of the line as on the map, and its label.
function lineKey(theme: Theme, layer: keyof Layers, title: string, dashes: string): HTMLElement {
  const svg = document.createElementNS(kSvg, "svg");
  svg.setAttribute("viewBox", "0 0 22 8");
  const ink = kInk[theme], [colour, width] = layer === "curbs" ? [ink.curb, 2] : layer === "path" ? [ink.path, 2] : [ink.paint, 3];
  for (const [stroke, thick, dash] of layer === "markings" ? [["#0008", 5, "none"], [colour, width, dashes]] : [[colour, width, dashes]]) {
    const line = document.createElementNS(kSvg, "line");
    const attributes = { x1: 1, y1: 4, x2: 21, y2: 4, stroke, "stroke-width": thick, "stroke-dasharray": dash, "stroke-linecap": layer === "markings" ? "butt" : "round" };
    for (const [name, value] of Object.entries(attributes)) line.setAttribute(name, String(value));
    svg.append(line);
  }
  return make("span", "", "", svg, document.createTextNode(title));
}

function scale(mode: Mode, [low, high]: [number, number]): HTMLElement {
  return bar(ramp(mode), mode === "height" ? [`${fixed(low, 1)} m`, `${fixed(high, 1)} m`] :
    mode === "cost" ? ["free", "lethal"] : mode === "age" ? kAges : ["none", "full"]);
}

/// `at`: what the ramp stands for, at equal distances along it.
function bar(colours: Rgb[], at: string[]): HTMLElement {
  const made = make("div", "", "ramp");
  made.style.setProperty("--ramp", colours.map(css).join(","));
  return make("div", "", "", made, make("div", "", "ends", ...at.map(text => make("span", text))));
}

function cloudEnds(by: CloudColour, range: [number, number]): [string, string] {
  if (by === "height") return range.map(m => `${fixed(m, 1)} m`) as [string, string];
  return by === "intensity" ? ["faint", "bright"] : by === "surface" ? ["no surface", "a surface"] : ["no edge", "an edge"];
}

/// The summary line of the folded panel on a phone.
export function showSummary(isFile: boolean, speed: number | null, latency: number | null, alarm: string): void {
  const [title, news] = byId("summary").children as unknown as [HTMLElement, HTMLElement];
  setText(title, isFile ? "Layers" : "Layers and health");
  const figures = [speed === null ? "" : `${speed.toFixed(1)} m/s`, latency === null ? "" : `${seconds(latency)} delay`];
  setText(news, alarm || figures.filter(Boolean).join(" · "));
  news.className = alarm ? "bad" : "";
}
