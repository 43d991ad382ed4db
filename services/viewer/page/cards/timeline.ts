// The time line of a log that is played, or of the last minutes: pause, speed, position.
import { byId, make } from "../format";
import { Playback } from "../world";

const kSpeeds = [1, 2, 5, 10, 0.5];

export interface PlaybackCommand { pause?: boolean; speed?: number; position?: number }

export function clock(s: number): string {
  return `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;
}

/// State of the live data: whether they are the ones shown, and whether they are healthy.
export interface Live { isSeen: boolean; isWell: boolean }

export class Timeline {
  private bar = byId("timeline");
  private slider = byId<HTMLInputElement>("position");
  private playback: Playback | null = null;
  private live: Live | null = null;
  private length = 0;      // s, estimated from the share of bytes read
  private sliding = false;

  constructor(order: (order: PlaybackCommand) => void, goLive: () => void) {
    byId("pause").onclick = () => this.playback && order(this.playback.ended ? { position: 0 } : { pause: !this.playback.paused });
    byId("speed").onclick = () => {
      const next = kSpeeds[(kSpeeds.indexOf(this.playback?.speed ?? 1) + 1) % kSpeeds.length];
      order({ speed: next });
    };
    this.slider.oninput = () => {
      this.sliding = true;
      this.showPlace(this.wanted());
      if (this.live) order({ position: this.wanted() });  // only on release: a log must be read up to there
    };
    this.slider.onchange = () => {
      this.sliding = false;
      const isEnd = this.slider.value === this.slider.max;
      if (this.live && isEnd) goLive();
      else order({ position: this.wanted() });
    };
    byId("live").onclick = goLive;
  }

  /// `live`: the bar is for the last minutes.
  show(playback: Playback | null, live: Live | null = null): void {
    this.playback = playback;
    this.live = live;
    byId("live").hidden = !live;
    if (live) byId("live").className = `${live.isSeen ? "on" : ""} ${live.isWell ? "good" : "bad"}`;
    this.bar.hidden = !playback;
    if (!playback) return;
    if (playback.progress > 0.001) this.length = playback.position / playback.progress;
    byId("pause").textContent = playback.ended ? "↺" : playback.paused ? "▶" : "❚❚";
    byId("pause").title = playback.ended ? "From the beginning" : playback.paused ? "Go on (space)" : "Pause (space)";
    byId("speed").textContent = `${playback.speed}×`;
    this.mark(playback.newMaps ?? []);
    if (this.sliding) return;
    this.slider.value = String(playback.progress * 1000);
    this.showPlace(playback.position);
  }

  /// Places, 0 .. 1, at which another map began.
  private mark(places: number[]): void {
    const marks = byId("new-maps");
    while (marks.children.length > places.length) marks.lastChild!.remove();
    places.forEach((place, i) => {
      let mark = marks.children[i] as HTMLElement | undefined;
      if (!mark) marks.append(mark = make("i"));
      mark.title = "A new map began";
      mark.style.setProperty("--place", String(Math.min(1, place)));
    });
    this.slider.setAttribute("aria-description", places.length ? `${places.length === 1 ? "A new map began" : `${places.length} new maps began`} in this time` : "");
  }

  private wanted(): number { return Number(this.slider.value) / 1000 * this.length; }
  private showPlace(s: number): void {
    const { length } = this, behind = length - s;
    byId("elapsed").textContent = !this.live ? clock(s) + (length ? ` / ${clock(Math.max(s, length))}` : "") : behind < 0.5 ? "" : `−${clock(behind)}`;
  }
}
