// WebGL2 programs, and their uniforms by name.
import { Rgb } from "./palette";

/// Compiled at the first use: that takes a second without a graphics card, and a view uses few of them.
export class Program {
  private begun: { program: WebGLProgram; shaders: WebGLShader[] } | null = null;
  private made: WebGLProgram | null = null;
  private places = new Map<string, WebGLUniformLocation | null>();

  /// `attributes`: by location, from 0.
  constructor(private gl: WebGL2RenderingContext, private vertex: string, private fragment: string, private attributes: string[] = []) {}

  /// Starts compiling in parallel to the page's script, for a program that is needed soon.
  prepare(): this {
    this.begun ??= this.begin();
    return this;
  }

  /// Throws if a shader does not compile.
  use(): void { this.gl.useProgram(this.made ??= this.make()); }

  at(name: string): WebGLUniformLocation | null {
    let place = this.places.get(name);
    if (place === undefined) this.places.set(name, place = this.made && this.gl.getUniformLocation(this.made, name));
    return place;
  }

  private begin(): { program: WebGLProgram; shaders: WebGLShader[] } {
    const { gl } = this, program = gl.createProgram()!;
    const shaders = ([[gl.VERTEX_SHADER, this.vertex], [gl.FRAGMENT_SHADER, this.fragment]] as const).map(([kind, source]) => {
      const shader = gl.createShader(kind)!;
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      return shader;
    });
    this.attributes.forEach((name, place) => gl.bindAttribLocation(program, place, name));
    gl.linkProgram(program);
    return { program, shaders };
  }

  private make(): WebGLProgram {
    const { gl } = this, { program, shaders } = this.begun ?? this.begin();
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
      throw new Error(shaders.map(shader => gl.getShaderInfoLog(shader)).join("") || "a shader does not compile");
    return program;
  }
}

/// Scales a colour to 0 .. 1.
export function unit(colour: Rgb): Rgb {
  return colour.map(v => v / 255) as Rgb;
}
