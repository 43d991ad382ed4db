// Whether the shown data are current. A dead bus must look dead.
import { seconds } from "./format";
import { Service, State } from "./world";

export const kOld = 1.3;  // s: with a frame's period, that of the looks, and the drawing, less than two seconds
const kMapOld = 2.5;    // s: semantic_map announces its tiles and its state each second
const kPatience = 4;    // s, before the page states what it waits for
const kNews = 30;       // s for which a new map is announced

export interface Judgement {
  word: string;      // for the chip
  sentence: string;  // over the map: the fault, or what the page waits for; empty: all is well
  mood: "good" | "bad" | "past" | "";
  grey: number;      // 0 .. 1
  lives?: boolean;   // the vehicle and its LiDAR are current although the map is grey
}

/// In the order in which data go through them: the fault of the first is the cause of the later ones.
const kWay = ["lidar", "imu", "encoder", "ekf", "mapper", "tensor_voting", "semantic_map"];

/// In words; empty: there is none.
export function firstFault(services: Service[]): string {
  const rank = ({ name }: Service) => (kWay.findIndex(part => name.startsWith(part)) + kWay.length + 1) % (kWay.length + 1);
  const first = services.filter(s => s.faults.length > 0).sort((a, b) => rank(a) - rank(b))[0];
  return first ? `${first.name}: ${first.faults[0]}` : "";
}

export function isViewer({ name }: Service): boolean { return name.startsWith("viewer"); }

/// What the page knows of its connection. `age`: s since the last frame; `refusal`: why the viewer refuses the page.
export interface Link { isOpen: boolean; age: number; refusal: string }

/// For a world of the past, which needs no connection.
export const kNoLink: Link = { isOpen: true, age: 0, refusal: "" };
export const kElsewhere = "No part of the map is in view. The button with the four corners (0) shows the whole map";
export const kNoCloud = "The dense cloud is not shown: the past that the page keeps has none";

export function judge(state: State | null, services: Service[], { isOpen, age, refusal }: Link): Judgement {
  if (!isOpen || age > kOld) {
    if (refusal) return { word: "Refused", mood: "bad", grey: state ? 1 : 0, sentence: refusal };
    if (!state) return { word: "Connecting", sentence: age > kPatience ? "No answer yet: is curbstone-viewer running?" : "", mood: "", grey: 0 };
    return { word: "No connection", mood: "bad", grey: 1, sentence: `No connection to the viewer for ${seconds(age)}` };
  }
  if (!state) return { word: "Connecting", sentence: "", mood: "", grey: 0 };
  if (state.source === "map") return { word: "Saved map", sentence: "", mood: "", grey: 0 };
  if (state.playback?.ended) return { word: "End of the log", sentence: "", mood: "", grey: 0 };
  if (state.playback?.paused) return { word: "Paused", sentence: "", mood: "", grey: 0 };
  if (state.bus_age === null) return { word: "Waiting", sentence: "Nothing has been heard on the bus yet: are the services running?", mood: "", grey: 0 };
  if (state.bus_age > kOld)
    return { word: "Silent", mood: "bad", grey: 1, sentence: `The bus has been silent for ${seconds(state.bus_age)}: this is how it was` };
  const fault = firstFault(services.filter(s => s.age <= kMapOld)), cause = fault && `.\n${fault}`;
  if (state.pose_age === null) return { word: "Waiting", sentence: state.tiles > 0 ? "" : `The bus is alive. No pose has come from the mapper yet${cause}`, mood: "", grey: 0 };
  if (state.pose_age > kOld)
    return { word: "Stale", mood: "bad", grey: 1, sentence: `No pose for ${seconds(state.pose_age)}: this is how it was${cause}` };
  const silence = mapSilence(state, services);
  if (silence > kMapOld)
    return { word: "Map stale", mood: "bad", grey: 1, lives: !state.pose?.lost, sentence: `semantic_map has been silent for ${seconds(silence)}: the map is old` };
  if (state.pose?.lost) return { word: "Lost", mood: "bad", grey: 0, sentence: "The mapper has lost the vehicle: its pose is a guess" };
  const sentence = newMap(state, services) || (state.tiles > 0 ? "" : `Poses come. No map has come from semantic_map yet${cause}`);
  return { word: state.source === "replay" ? "Replay" : "Live", sentence, mood: "good", grey: 0 };
}

/// s since semantic_map was last heard, be it by its state or by what it announces: at a standstill it sends no tiles. 0:
/// nothing of it was ever heard. A log is counted in its own time, which only the announcements are.
function mapSilence({ index_age: index, tile_age: tile, playback }: State, services: Service[]): number {
  if (playback) return index ?? 0;
  const ages = services.filter(({ name }) => name === "semantic_map").map(({ age }) => age);
  if (index !== null) ages.push(index);
  return ages.length === 0 ? 0 : Math.min(...ages, tile ?? Infinity);
}

/// Whether the localizer speaks. While a log stands, nobody does.
export function isLocalized({ localized, playback }: State): boolean {
  return !!localized?.here && (localized.age <= kOld || !!playback?.paused || !!playback?.ended);
}

/// Why another map began is in the mapper's own words.
function newMap({ new_map_age: age }: State, services: Service[]): string {
  if (age === null || age > kNews) return "";
  const head = "a new map begins: ", fault = services.flatMap(({ faults }) => faults).find(words => words.startsWith(head));
  return `A new map began ${Math.ceil(age)} s ago${fault ? `: ${fault.slice(head.length)}` : ". The earlier one is no longer shown"}`;
}

/// For a world of the past: the judgement of then, with the past stated first.
export function judgePast(then: Judgement, ago: string): Judgement {
  return { ...then, word: `${ago} ago`, mood: "past" };
}
