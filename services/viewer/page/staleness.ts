// Whether the shown data are current. A dead bus must look dead.
import { seconds } from "./format";
import { State } from "./world";

const kOld = 1.5;       // s
const kPatience = 4;    // s, before the page states what it waits for

export interface Judgement {
  word: string;      // for the chip
  sentence: string;  // over the map: the fault, or what the page waits for; empty: all is well
  mood: "good" | "bad" | "past" | "";
  grey: number;      // 0 .. 1
}

/// `age`: s since the last frame.
export function judge(state: State | null, isOpen: boolean, age: number): Judgement {
  if (!isOpen || age > kOld) {
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
  if (state.pose_age === null) return { word: "Waiting", sentence: state.tiles > 0 ? "" : "The bus is alive. No pose has come from the mapper yet", mood: "", grey: 0 };
  if (state.pose_age > kOld)
    return { word: "Stale", mood: "bad", grey: 1, sentence: `No pose for ${seconds(state.pose_age)}: this is how it was` };
  if (state.pose?.lost) return { word: "Lost", mood: "bad", grey: 0, sentence: "The mapper has lost the vehicle: its pose is a guess" };
  const sentence = state.tiles > 0 ? "" : "Poses come. No map has come from semantic_map yet";
  return { word: state.source === "replay" ? "Replay" : "Live", sentence, mood: "good", grey: 0 };
}

/// For a world of the past: the judgement of then, with the past stated first.
export function judgePast(then: Judgement, ago: string): Judgement {
  return { ...then, word: `${ago} ago`, mood: "past" };
}
