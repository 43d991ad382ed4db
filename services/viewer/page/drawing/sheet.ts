// The picture of paths and marks, drawn in Canvas 2D. Without a graphics card the processor draws it. As a layer of its
// own it would then pass through the emulated card three times: into its memory, into a picture of the page, and onto
// the screen. Laid over the ground it passes once.
import { drawsInSoftware } from "./software";

export class Sheet {
  readonly context: CanvasRenderingContext2D;

  /// `lay`: draws a canvas over the ground.
  constructor(private canvas: HTMLCanvasElement, private lay: (canvas: HTMLCanvasElement) => void) {
    canvas.hidden = drawsInSoftware();
    this.context = canvas.getContext("2d", { willReadFrequently: canvas.hidden })!;
  }

  get width(): number { return this.canvas.width; }

  /// Starts an empty picture, in pixels of the screen.
  begin(): void {
    const { canvas, context } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
  }

  /// Shows the complete picture.
  show(): void {
    if (this.canvas.hidden) this.lay(this.canvas);
  }
}
