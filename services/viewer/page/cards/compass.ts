// The buttons that show the camera's turn and tilt.
import { Camera } from "../drawing/camera";
import { byId } from "../format";

let shownTurn: number | null = null;

export function showTurn({ turn, isTilted }: Camera): void {
  byId("tilt").setAttribute("aria-pressed", String(isTilted));
  if (turn === shownTurn) return;
  shownTurn = turn;
  byId("needle").style.transform = `rotate(${-turn}rad)`;
}
