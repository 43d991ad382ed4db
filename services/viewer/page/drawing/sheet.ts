// The canvas of paths and marks, drawn in Canvas 2D and shown when the picture is complete. Without a graphics card the
// processor draws it. A visible canvas would then pass through the emulated card three times: into its memory, into the
// page's tiles, and onto the screen. A finished bitmap goes to the screen directly.
import { drawsInSoftware } from "./software";

/// Debian's TypeScript does not declare it yet.
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
    if (isSlow && typeof OffscreenCanvas === "function") {  // in Safari since 16.4
      this.hidden = new OffscreenCanvas(canvas.width, canvas.height);
      this.screen = canvas.getContext("bitmaprenderer");
    }
    const context = this.screen && this.hidden ? this.hidden.getContext("2d", { willReadFrequently: true })
      : canvas.getContext("2d", { willReadFrequently: isSlow });
    this.context = context!;
  }

  get width(): number { return this.canvas.width; }

  /// Starts an empty picture, in pixels of the screen.
  begin(): void {
    const { canvas, context, hidden } = this, { width, height } = canvas;
    if (hidden && (hidden.width !== width || hidden.height !== height)) [hidden.width, hidden.height] = [width, height];
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
  }

  /// Shows the complete picture.
  show(): void {
    if (this.screen && this.hidden) this.screen.transferFromImageBitmap(this.hidden.transferToImageBitmap());
  }
}
