// The keyboard: a letter does what its button does, arrows walk over the map, Enter asks what is in its middle.
const kArrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/// `walk`: a step to the right and down on the screen; with Shift it leans instead.
export function listenToKeys(map: HTMLElement, keys: Record<string, () => void>,
  walk: (right: number, down: number, leans: boolean) => void, ask: () => void): void {
  addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    keys[event.key]?.();
    if (document.activeElement !== map && document.activeElement !== document.body) return;  // arrows are the slider's, Enter the button's
    const arrow = kArrows[event.key];
    if (arrow) walk(...arrow, event.shiftKey);
    if (event.key === "Enter") ask();
  });
}
