// The colours of the marks above the ground, and the ellipse of a pose.
import { css, kPaint, Theme } from "./palette";
import { Pose } from "../world";

/// A filter for marks of what is stale.
export const kGrey = "grayscale(1) opacity(0.55)";

export interface Ink { curb: string; halo: string; paint: string; path: string; vehicle: string; body: string; localized: string }

export const kInk: Record<Theme, Ink> = {
  light: { curb: "#6b3200", halo: "#ffffffc0", paint: css(kPaint.light), path: "#14181d", vehicle: "#d6247f", body: "#ffffff", localized: "#00857a" },
  dark: { curb: "#ffe2ae", halo: "#000000a0", paint: css(kPaint.dark), path: "#eef1f4", vehicle: "#ff5fae", body: "#14181d", localized: "#4fe0cf" },
};

/// The 95 % ellipse of the vehicle's position: half axes, m, and the direction of the long one, rad.
export function ellipseOf({ covariance: [xx, xy, yy] }: Pose): { long: number; short: number; turn: number } {
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  return { long: Math.sqrt(Math.max(0, mean + spread) * 5.99), short: Math.sqrt(Math.max(0, mean - spread) * 5.99),
    turn: Math.atan2(2 * xy, xx - yy) / 2 };
}

/// How strongly an ellipse is filled; one as large as the view would only tint the map. `pixels`: its shorter half axis.
export function fillOf(pixels: number): number {
  return 0.16 * Math.min(1, Math.max(0, (240 - pixels) / 160));
}
