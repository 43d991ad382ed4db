// Of WebGL2: programs, and their uniforms by name.
import { Rgb } from "./palette";

export class Program {
  readonly made: WebGLProgram;
  private places = new Map<string, WebGLUniformLocation | null>();

  /// `attributes`: by place, from 0. Throws where a shader does not compile.
  constructor(private gl: WebGL2RenderingContext, vertex: string, fragment: string, attributes: string[] = []) {
    this.made = gl.createProgram()!;
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
      const shader = gl.createShader(kind)!;
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.made, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
        throw new Error(gl.getShaderInfoLog(shader) ?? "a shader does not compile");
    }
    attributes.forEach((name, place) => gl.bindAttribLocation(this.made, place, name));
    gl.linkProgram(this.made);
  }

  use(): void { this.gl.useProgram(this.made); }
  at(name: string): WebGLUniformLocation | null {
    let place = this.places.get(name);
    if (place === undefined) this.places.set(name, place = this.gl.getUniformLocation(this.made, name));
    return place;
  }
}

/// 0 .. 1.
export function unit(colour: Rgb): Rgb {
  return colour.map(v => v / 255) as Rgb;
}
