// Mouse, touch and keys on the map: drag, wheel, pinch, click, long press.
import { Camera } from "./drawing/camera";

export interface GestureEvents {
  moved(dragged: boolean): void;          // the view is another; dragged: it left where it was
  picked(sx: number, sy: number): void;   // click, or tap
  hovered(sx: number, sy: number): void;
}

export function listen(element: HTMLElement, camera: Camera, events: GestureEvents): void {
  const fingers = new Map<number, [number, number]>();
  let travelled = 0;

  element.addEventListener("pointerdown", event => {
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 1) travelled = 0;
  });

  element.addEventListener("pointermove", event => {
    const before = fingers.get(event.pointerId);
    if (!before) return events.hovered(event.clientX, event.clientY);
    const now: [number, number] = [event.clientX, event.clientY];
    travelled += Math.hypot(now[0] - before[0], now[1] - before[1]);
    if (fingers.size === 1) {
      if (travelled < 4) return;
      const [x, y] = camera.toMap(...before);
      camera.hold(x, y, ...now);
      element.classList.add("dragged");
      events.moved(true);
    } else {
      const other = [...fingers].find(([id]) => id !== event.pointerId)![1];
      pinch(camera, before, now, other);
      events.moved(false);
    }
    fingers.set(event.pointerId, now);
  });

  const up = (event: PointerEvent) => {
    if (!fingers.delete(event.pointerId)) return;
    element.classList.remove("dragged");
    if (event.type === "pointerup" && fingers.size === 0 && travelled < 4) events.picked(event.clientX, event.clientY);
    if (fingers.size > 0) travelled = 100;  // the end of a pinch is no tap
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

/// One finger went from `before` to `now` while the other one rests.
function pinch(camera: Camera, before: [number, number], now: [number, number], other: [number, number]): void {
  const from = Math.hypot(before[0] - other[0], before[1] - other[1]);
  const to = Math.hypot(now[0] - other[0], now[1] - other[1]);
  const [x, y] = camera.toMap((before[0] + other[0]) / 2, (before[1] + other[1]) / 2);
  camera.zoom(to / Math.max(1, from), ...other);
  camera.hold(x, y, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
}
