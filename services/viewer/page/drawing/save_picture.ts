// Saves the map as a picture file.

/// The visible map without the cards, as a file.
export function saveCanvases(canvases: HTMLCanvasElement[], paper: string): void {
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [canvases[0].width, canvases[0].height];
  const context = picture.getContext("2d")!;
  context.fillStyle = paper;
  context.fillRect(0, 0, picture.width, picture.height);
  for (const canvas of canvases) context.drawImage(canvas, 0, 0);
  picture.toBlob(blob => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob!);
    link.download = `curbstone-${new Date().toISOString().slice(0, 19).replace(/:/g, "")}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  });
}
