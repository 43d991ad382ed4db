// The canvas of paths and marks, drawn by Canvas 2D and shown when a picture is done. Where there is no graphics card
// the processor draws them. A canvas of the document would then go through the emulation of a card three times: into
// its memory, into the page's tiles, and onto the screen. A finished bitmap goes straight to the screen.
import { drawsInSoftware } from "./software";

/// As Debian's TypeScript does not know it yet.
declare class OffscreenCanvas {
  constructor(width: number, height: number);
  width: number;
  height: number;
  getContext(kind: "2d", options: CanvasRenderingContext2DSettings): CanvasRenderingContext2D | null;
  transferToImageBitmap(): ImageBitmap;
}

export class Sheet {
  readonly context: CanvasRenderingContext2D;
  private hidden: OffscreenCanvas | null = null;
  private screen: ImageBitmapRenderingContext | null = null;

  constructor(private canvas: HTMLCanvasElement) {
    const isSlow = drawsInSoftware();
    if (isSlow && typeof OffscreenCanvas === "function") {  // Safari has it since 16.4
      this.hidden = new OffscreenCanvas(canvas.width, canvas.height);
      this.screen = canvas.getContext("bitmaprenderer");
    }
    const context = this.screen && this.hidden ? this.hidden.getContext("2d", { willReadFrequently: true })
      : canvas.getContext("2d", { willReadFrequently: isSlow });
    this.context = context!;
  }

  get width(): number { return this.canvas.width; }

  /// An empty picture, in pixels of the screen.
  begin(): void {
    const { canvas, context, hidden } = this, { width, height } = canvas;
    if (hidden && (hidden.width !== width || hidden.height !== height)) [hidden.width, hidden.height] = [width, height];
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
  }

  /// It is done.
  show(): void {
    if (this.screen && this.hidden) this.screen.transferFromImageBitmap(this.hidden.transferToImageBitmap());
  }
}
