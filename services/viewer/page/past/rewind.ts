// Switches the page between the live world and the history. Received frames are always processed.
import { PlaybackCommand } from "../cards/timeline";
import { readFrame } from "../decode";
import { Playback, World } from "../world";
import { History } from "./history";
import { NewMaps } from "./new_maps";

const kRound = 50;  // ms between two steps of playing

export class Rewind {
  live: World;  // the live world; it is the shown one, unless the past is shown
  history = new History(undefined, () => { if (this.place !== null) this.seek(this.place); });
  private played = new NewMaps();  // s of a log, as far as it was played
  private place: number | null = null;  // ms of performance.now(), the shown time of the past; null: live
  private newest: number | null = null; // ms, when the newest frame of the shown past was received; null: another time is shown yet
  private isPaused = false;
  private speed = 1;
  private timer = 0;
  private round = 0;  // ms, the last step

  /// `changed`: the shown world changed, by playing or by a jump.
  constructor(private shown: World, private changed: (leapt: boolean) => void) {
    this.live = shown;
  }

  get isPast(): boolean { return this.place !== null; }
  /// Whether what is shown is of the time that is asked for: it may have to be unpacked.
  get isThere(): boolean { return !this.isPast || this.newest !== null; }
  /// ms between the shown time and now.
  get behind(): number { return this.place === null ? 0 : performance.now() - this.place; }

  /// Takes a received frame. Returns its number.
  take(bytes: ArrayBuffer): number {
    const now = performance.now(), { live, history } = this;
    if (live.state && live.state.source !== "live") {
      const frame = readFrame(bytes, live);
      this.played.note(live, live.state?.playback?.position ?? 0);
      return frame;
    }
    history.expect(live, now);
    const frame = readFrame(bytes, live);
    history.add(live, bytes, now);
    if (live.state?.source !== "live") history.clear();  // a saved map has no past, and a log has its own time line
    return frame;
  }

  /// For the time line: of a log, or of the history; null: there is neither yet.
  playback(): Playback | null {
    const log = this.live.state?.playback;
    if (log) return { ...log, newMaps: this.played.places.map(place => place / log.position * log.progress).filter(share => share <= 1) };  // not NaN at its start
    const { oldest, newest } = this.history;
    if (oldest === null || newest - oldest < 2000) return null;
    const place = this.place ?? newest, span = Math.max(newest, place) - oldest;
    return { position: (place - oldest) / 1000, progress: (place - oldest) / span, speed: this.speed,
      paused: this.isPaused, ended: false, newMaps: this.history.newMaps.places.map(at => (at - oldest) / span).filter(share => share > 0) };
  }

  order({ pause, speed, position }: PlaybackCommand): void {
    if (speed !== undefined) this.speed = speed;
    if (position !== undefined) this.seek((this.history.oldest ?? 0) + position * 1000);
    if (pause !== undefined) {
      if (pause && !this.isPast) this.seek(this.history.newest);
      this.isPaused = pause;
    }
    this.changed(false);
  }

  goLive(): void {
    if (!this.isPast) return;
    clearInterval(this.timer);
    this.place = null;
    this.isPaused = false;
    this.history.shut();
    this.shown.show(this.live.snapshot());
    this.shown.copied = this.live.copied;
    this.shown.cloud = this.live.cloud;
    this.live = this.shown;
    this.changed(true);
  }

  private seek(place: number): void {
    const { oldest, newest } = this.history;
    if (oldest === null) return;
    if (!this.isPast) this.leave();
    const from = this.place !== null && place >= this.place ? this.newest : null;
    this.place = Math.min(newest, Math.max(oldest, place));
    this.newest = this.history.lead(this.shown, from, this.place);
    this.changed(true);
  }

  /// Starts showing the past: from now on frames update a world that is not shown.
  private leave(): void {
    this.live = new World();
    this.live.show(this.shown.snapshot());
    this.live.copied = this.shown.copied;
    [this.live.cloud, this.shown.cloud] = [this.shown.cloud, this.live.cloud];
    this.round = performance.now();
    this.timer = setInterval(() => this.play(), kRound);
  }

  private play(): void {
    const now = performance.now(), step = (now - this.round) * this.speed;
    this.round = now;
    if (this.place === null) return;
    if (this.history.oldest !== null && this.place < this.history.oldest) return this.seek(this.history.oldest);
    if (this.isPaused) return;
    this.place += step;
    if (this.place >= this.history.newest && this.speed > 1) return this.goLive();
    const newest = this.history.lead(this.shown, this.newest, this.place);
    if (newest === null) this.place -= step;  // until it is unpacked
    if (newest === null || newest === this.newest) return;
    this.newest = newest;
    this.changed(false);
  }
}
