// Whether there is a graphics card. Without one, anti-aliasing is too slow, and the processor draws a Canvas 2D faster
// than the emulated card does.
let known: boolean | null = null;

export function drawsInSoftware(): boolean {
  return known ??= look();
}

function look(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl?.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
