// Interpolates the vehicle's pose: frames arrive ten times a second, the screen is drawn more often.
import { Pose } from "../world";

const kLongest = 400;  // ms between two poses that are interpolated

export class Motion {
  speed: number | null = null;  // m/s
  private from: Pose | null = null;
  private to: Pose | null = null;
  private began = 0;   // ms, when `to` was received
  private lasts = 0;   // ms, duration

  add(pose: Pose, now: number): void {
    if (this.to && pose.utime === this.to.utime) return;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const isNext = this.to && now - this.began < kLongest && pose.utime > this.to.utime && !still;
    this.measure(pose);
    this.from = isNext ? this.poseAt(now) : pose;
    this.lasts = isNext ? now - this.began : 0;
    this.to = pose;
    this.began = now;
  }

  clear(): void {
    this.from = this.to = this.speed = null;
  }

  poseAt(now: number): Pose | null {
    const { from, to } = this;
    if (!from || !to || !this.isMoving(now)) return to;
    const share = (now - this.began) / this.lasts;
    const turn = Math.atan2(Math.sin(to.yaw - from.yaw), Math.cos(to.yaw - from.yaw));
    const between = (a: number, b: number) => a + (b - a) * Math.max(0, share);
    return { ...to, x: between(from.x, to.x), y: between(from.y, to.y), yaw: from.yaw + turn * Math.max(0, share) };
  }

  isMoving(now: number): boolean {
    return this.lasts > 0 && now - this.began < this.lasts;
  }

  private measure(pose: Pose): void {
    const before = this.to, s = before ? (pose.utime - before.utime) * 1e-6 : 0;
    if (!before || s <= 0 || s > 1) return;
    const speed = Math.hypot(pose.x - before.x, pose.y - before.y) / s;
    this.speed = this.speed === null ? speed : this.speed + 0.3 * (speed - this.speed);
  }
}
