// Whether there is a graphics card. Without one smooth edges cost more than they are worth, and a Canvas 2D is drawn
// sooner by the processor than by the emulation of a card.
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
