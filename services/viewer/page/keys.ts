// The keyboard: a letter acts as its button, arrows move over the map, Enter selects the map's centre.
const kArrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/// `walk`: moves a step right and down on the screen; with Shift it turns and tilts instead.
export function listenToKeys(map: HTMLElement, keys: Record<string, () => void>,
  walk: (right: number, down: number, leans: boolean) => void, ask: () => void): void {
  // After a click the keyboard is the map's: otherwise Space and the arrows would go to what was clicked. Keys click with detail 0.
  addEventListener("click", ({ detail, target }) => {
    if (detail && (target as Element).id !== "position") setTimeout(() => map.focus({ preventScroll: true }));
  });
  addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const name = event.key.length > 1 ? event.key : event.key.toLowerCase();  // Caps Lock
    if (!event.repeat || "+=-".includes(name)) keys[name]?.();                // a held key switches once
    // The arrow keys belong to a focused slider, Enter to a focused button.
    if (document.activeElement !== map && document.activeElement !== document.body) return;
    const arrow = kArrows[event.key];
    if (arrow) walk(...arrow, event.shiftKey);
    if (event.key === "Enter") ask();
  });
}
