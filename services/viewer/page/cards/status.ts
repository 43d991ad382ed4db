// What the page says of its data: a word in the bar, a sentence over the map, the title of the tab.
import { byId, setText } from "../format";
import { Judgement } from "../staleness";

/// `shown`: of the data that are seen; `now`: of the live ones.
export function showStatus(shown: Judgement, now: Judgement): void {
  const status = byId("status"), curtain = byId("curtain");
  setText(status, shown.word);
  status.className = `chip ${shown.mood}`;
  setText(curtain, shown.sentence);
  curtain.hidden = !shown.sentence;
  curtain.className = shown.mood;
  document.title = now.mood === "bad" ? `${now.word} – Curbstone` : "Curbstone";
}

/// The page cannot work at all: only the reason is left of it.
export function showFailure(why: string): void {
  document.documentElement.classList.add("broken");
  showStatus({ word: "Cannot draw", sentence: why, mood: "bad", grey: 0 }, { word: "Cannot draw", sentence: "", mood: "bad", grey: 0 });
}
