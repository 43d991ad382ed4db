// The controls: colours with their legend, layers, theme, facts of the vehicle.
import { byId, list, make, metres, seconds } from "../format";
import { classColours, css, kClassNames, kModes, Mode, ramp, Theme } from "../drawing/palette";
import { kInk } from "../drawing/ink";
import { Layers, Settings } from "../settings";
import { Pose, State } from "../world";

const kSvg = "http://www.w3.org/2000/svg";
const kLayers: [keyof Layers, string][] =
  [["grid", "Cells"], ["relief", "Relief"], ["curbs", "Curbs"], ["markings", "Paint"], ["path", "Path"], ["points", "LiDAR"], ["localized", "Localizer"]];
const kPointColours: [Settings["points"], string][] = [["height", "Points by height"], ["intensity", "By intensity"]];
/// What is drawn as lines: layer, words, dashes.
const kLineKeys: [keyof Layers, string, string][] =
  [["curbs", "Curb", "none"], ["curbs", "Lowered", "4 3"], ["curbs", "Inferred", "0.5 3.5"], ["path", "Driven", "none"], ["markings", "Road paint", "none"]];
const kKeys: [string, string][] = [
  ["F", "follow the vehicle"], ["N", "north or heading up"], ["T", "tilt"], ["M", "measure"], ["P", "save a picture"], ["L", "back to what is live"],
  ["Space", "pause, go on"], ["0", "the whole map"], ["+ −", "zoom"], ["Arrows", "move; with Shift tilt and turn"], ["Enter", "what is in the middle"], ["Esc", "close"],
  ["Drag", "move; right button: tilt"], ["Two fingers", "zoom; side by side upwards: tilt"], ["Long press", "what is there"]];
const kThemes: ["auto" | Theme, string][] = [["auto", "Auto"], ["light", "Light"], ["dark", "Dark"]];

export class Panel {
  constructor(private settings: Settings, private changed: () => void) {
    segments("colours", kModes, () => settings.mode === "paper" ? "class" : settings.mode, mode => { settings.mode = mode; changed(); });
    segments("themes", kThemes, () => settings.theme, theme => { settings.theme = theme; changed(); });
    for (const [name, title] of kLayers) byId("layers").append(this.toggle(title, () => settings.layers[name], on => { settings.layers[name] = on; }));
    byId("layers").append(this.toggle("As in paper", () => settings.mode === "paper", on => { settings.mode = on ? "paper" : "class"; }));
    segments("point-colours", kPointColours, () => settings.points, colour => { settings.points = colour; changed(); });
    list(byId("keys"), kKeys);
    const panel = byId("panel"), handle = byId("handle");
    handle.onclick = () => handle.setAttribute("aria-expanded", String(panel.classList.toggle("open")));
  }

  private toggle(title: string, get: () => boolean, set: (on: boolean) => void): HTMLElement {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = get();
    box.onchange = () => { set(box.checked); this.changed(); };
    refreshers.push(() => { box.checked = get(); });
    return make("label", "", "", box, document.createTextNode(title));
  }

  /// After the settings changed.
  refresh(range: [number, number]): void {
    for (const refresh of refreshers) refresh();
    const { mode, look, layers } = this.settings;
    byId("point-colours").hidden = !layers.points;
    byId("line-keys").replaceChildren(...kLineKeys.filter(([layer]) => layers[layer]).map(([layer, title, dashes]) => lineKey(look, layer, title, dashes)));
    byId("legend").replaceChildren(mode === "class" || mode === "paper" ? keys(look, mode) : scale(mode, range));
  }

  showState(state: State, speed: number | null): void {
    const { pose } = state;
    byId("vehicle").hidden = !pose;
    if (!pose) return;
    list(byId("facts"), [
      ["Speed", speed === null ? "–" : `${speed.toFixed(1)} m/s`],
      ["Position", `${pose.x.toFixed(2)}, ${pose.y.toFixed(2)}, ${pose.z.toFixed(2)} m`],
      ["Heading", `${degrees(pose.yaw)} °`],
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

/// 1 sigma of the worst direction, and of the heading.
function uncertainty({ covariance: [xx, xy, yy, turn] }: Pose): string {
  const worst = Math.sqrt(Math.max(0, (xx + yy) / 2 + Math.hypot((xx - yy) / 2, xy)));
  return `${metres(worst)}, ${(Math.sqrt(Math.max(0, turn)) * 180 / Math.PI).toFixed(2)} °`;
}

/// What the localizer says, if there is one.
function localization({ localized, pose }: State): [string, string, boolean?][] {
  if (!localized) return [];
  if (localized.age > 1.5) return [["Localizer", `silent for ${seconds(localized.age)}`, true]];
  const where = `${localized.x.toFixed(2)}, ${localized.y.toFixed(2)} m`;
  const apart = localized.here && pose ? metres(Math.hypot(localized.x - pose.x, localized.y - pose.y)) : "in another map";
  return [
    ["Localizer", localized.lost ? "LOST: its pose is a guess" : where, localized.lost],
    ["Its uncertainty", uncertainty(localized)],
    ["From the mapper", apart],
  ];
}

function degrees(rad: number): string {
  return (((rad * 180 / Math.PI) % 360 + 360) % 360).toFixed(1);
}

function segments<T extends string>(id: string, choices: [T, string][], get: () => T, set: (choice: T) => void): void {
  const buttons = choices.map(([choice, title]) => {
    const button = make("button", title);
    button.setAttribute("role", "radio");
    button.onclick = () => set(choice);
    return button;
  });
  byId(id).append(...buttons);
  refreshers.push(() => buttons.forEach((button, i) => button.setAttribute("aria-checked", String(choices[i][0] === get()))));
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

/// A piece of the line as it is on the map, and what it is.
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
  const bar = make("div", "", "ramp");
  bar.style.setProperty("--ramp", ramp(mode).map(css).join(","));
  const [from, to] = mode === "height" ? [`${low.toFixed(1)} m`, `${high.toFixed(1)} m`] :
    mode === "cost" ? ["free", "lethal"] : mode === "age" ? ["now", "10 min ago"] : ["no trust", "full trust"];
  return make("div", "", "", bar, make("div", "", "ends", make("span", from), make("span", to)));
}

/// The line of the folded panel on a phone.
export function showSummary(speed: number | null, latency: number | null, faults: number, silent: number): void {
  const left = make("span", speed === null ? "Map and health" : `${speed.toFixed(1)} m/s`);
  left.style.color = "var(--ink)";
  const right = faults ? make("span", `${faults} with faults`, "bad") : silent ? make("span", `${silent} silent`, "bad") :
    make("span", latency === null ? "" : seconds(latency));
  byId("summary").replaceChildren(left, right);
}
