// Mouse, touch and keys on the map: drag, wheel, pinch, tilt, click, long press.
import { Camera } from "./drawing/camera";

type Spot = [number, number];

export interface GestureEvents {
  moved(dragged: boolean): void;          // the view changed; dragged: it was moved away from where it was
  picked(sx: number, sy: number): void;   // click, or tap
  hovered(sx: number, sy: number): void;
}

const kLean = 0.006, kTurn = 0.005;  // rad a pixel
const kDecide = 10;                  // pixels that two fingers move before the gesture is decided
const kStill = 4, kStillFinger = 10; // pixels of motion that do not count as a drag
const kLong = 500;                   // ms of a long press

export function listen(element: HTMLElement, camera: Camera, events: GestureEvents): void {
  const fingers = new Map<number, Spot>();
  let began: Spot[] = [];     // where each of two fingers touched down
  let isLeaning = false;      // the right button, or two fingers up or down side by side
  let isPinching = false;
  let start: Spot = [0, 0];
  let isDragged = false;      // since the first finger touched down
  let press = 0;              // the timer of a long press

  element.addEventListener("pointerdown", event => {
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    clearTimeout(press);
    if (fingers.size === 1) {
      start = [event.clientX, event.clientY];
      isDragged = false;
      if (event.pointerType === "touch") press = setTimeout(() => {
        isDragged = true;  // what follows is neither a tap nor a drag
        fingers.clear();
        events.picked(...start);
      }, kLong);
    }
    isLeaning = fingers.size === 1 && (event.button === 2 || event.ctrlKey);
    isPinching = false;
    began = [...fingers.values()];
  });

  element.addEventListener("pointermove", event => {
    const before = fingers.get(event.pointerId);
    if (!before) return events.hovered(event.clientX, event.clientY);
    const now: Spot = [event.clientX, event.clientY];
    fingers.set(event.pointerId, now);
    if (fingers.size === 1) {
      const still = event.pointerType === "touch" ? kStillFinger : kStill;
      if (!isDragged && Math.hypot(now[0] - start[0], now[1] - start[1]) < still) return void fingers.set(event.pointerId, before);
      isDragged = true;
      clearTimeout(press);
      element.classList.add("dragged");
      if (isLeaning) {
        camera.lean((before[1] - now[1]) * kLean, (now[0] - before[0]) * kTurn);
        return events.moved(false);
      }
      camera.hold(...camera.toMap(...before), ...now);
      return events.moved(true);
    }
    if (!isLeaning && !isPinching) {
      const what = meaning(began, [...fingers.values()]);
      isLeaning = what === "lean";
      isPinching = what === "pinch";
      return;
    }
    const other = [...fingers].find(([id]) => id !== event.pointerId)![1];
    if (isLeaning) camera.lean((before[1] - now[1]) / 2 * kLean, 0);
    else pinch(camera, before, now, other);
    events.moved(false);
  });

  const up = (event: PointerEvent) => {
    if (!fingers.delete(event.pointerId)) return;
    element.classList.remove("dragged");
    clearTimeout(press);
    if (event.type === "pointerup" && fingers.size === 0 && !isDragged && !isLeaning) events.picked(event.clientX, event.clientY);
    if (fingers.size > 0) isDragged = true;  // the end of a pinch is not a tap
    isLeaning = isPinching = false;
  };
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", up);

  element.addEventListener("wheel", event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    camera.zoom(Math.exp(-event.deltaY * lines * 0.0016), event.clientX, event.clientY);
    events.moved(false);
  }, { passive: false });
  element.addEventListener("contextmenu", event => event.preventDefault());
}

/// Decides the gesture of two fingers, once both have moved far enough or one has moved far.
function meaning([a, b]: Spot[], [c, d]: Spot[]): "lean" | "pinch" | "" {
  const first: Spot = [c[0] - a[0], c[1] - a[1]], second: Spot = [d[0] - b[0], d[1] - b[1]];
  const [p, q] = [Math.hypot(...first), Math.hypot(...second)];
  if (Math.max(p, q) < kDecide || Math.min(p, q) < kDecide / 2 && Math.max(p, q) < 3 * kDecide) return "";
  const isUpright = ([x, y]: Spot) => Math.abs(y) > 1.7 * Math.abs(x);
  return isUpright(first) && isUpright(second) && first[1] * second[1] > 0 ? "lean" : "pinch";
}

/// Pinch: one finger moved from `before` to `now` while the other one rests.
function pinch(camera: Camera, before: Spot, now: Spot, other: Spot): void {
  const from = Math.hypot(before[0] - other[0], before[1] - other[1]);
  const to = Math.hypot(now[0] - other[0], now[1] - other[1]);
  const [x, y] = camera.toMap((before[0] + other[0]) / 2, (before[1] + other[1]) / 2);
  camera.zoom(to / Math.max(1, from), ...other);
  camera.hold(x, y, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
}
