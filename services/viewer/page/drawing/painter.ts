// The cells' colours as one picture per page. A cell is painted when it or the look changes; after that, drawing a page
// costs one texture read per pixel, which is fast enough without a graphics card.
import { kCellsAside, Page } from "./page";
import { Pages } from "./pages";
import { Program } from "./program";
import { kPaintFragment, kPaintVertex } from "./shaders";

export class Painter {
  private program: Program;
  private canvas: WebGLFramebuffer;

  constructor(private gl: WebGL2RenderingContext, private pages: Pages) {
    this.program = new Program(gl, kPaintVertex, kPaintFragment).prepare();
    this.canvas = gl.createFramebuffer()!;
  }

  /// Brings the page's picture up to date and returns it. `look` names everything but the cells that the colours depend on; `style`
  /// sets the uniforms of kPaintFragment; `isSmall`: the picture is drawn smaller than it is.
  paint(page: Page, look: string, style: (program: Program) => void, isSmall: boolean): WebGLTexture {
    const { gl } = this, close = this.pages.closeOf(page);
    if (close.paintedAs !== look) close.unpainted = { left: 0, low: 0, right: kCellsAside, high: kCellsAside };
    if (close.unpainted) {
      const { left, low, right, high } = close.unpainted;
      this.program.use();
      style(this.program);
      this.pages.bind(page, close.picture);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.canvas);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, close.picture, 0);
      gl.viewport(0, 0, kCellsAside, kCellsAside);
      gl.disable(gl.BLEND);
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(left, low, right - left, high - low);
      gl.disableVertexAttribArray(0);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
      gl.disable(gl.SCISSOR_TEST);
      gl.enable(gl.BLEND);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
      close.unpainted = null;
      close.paintedAs = look;
      close.hasSmaller = false;
    }
    if (!isSmall || close.hasSmaller) return close.picture;
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, close.picture);
    gl.generateMipmap(gl.TEXTURE_2D);
    close.hasSmaller = true;
    return close.picture;
  }
}
