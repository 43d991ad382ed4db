// The tilted view in WebGL2: the ground as meshes, obstacles and walls as boxes, curbs as walls of their height.
// Distant parts are coarser; nothing is drawn beyond kReach.
import { Blocks, kFaceFloats } from "./blocks";
import { anchorAt, Camera, isNear } from "../camera";
import { wallsOf } from "./curb_walls";
import type { Paint } from "../ground";
import { Boxes, kPageSize, kTilesAside, Page, Square } from "../page";
import { Pages } from "../pages";
import { stripsOf } from "../paint_strips";
import { Program } from "../program";
import { kBlockFragment, kBlockVertex, kNetFragment, kNetVertex, kPlainNetFragment, kSolidFragment, kSolidVertex } from "./relief_shaders";
import { netIndices, netPoints, Seen, squaresInView } from "./terrain";
import { World } from "../../world";

const kReach = 6;             // times the eye's distance
const kMaxNets = 600;         // bound of the kept ones
const kMaxFaces = 16_383;     // per square, for 16 bit indices
const kCoarseNet = 5;         // in draft mode, every fifth point of a mesh
const kFineCell = 1, kCoarseCell = 0.5;  // pixels per cell from which boxes are drawn

/// What a machine can draw in time.
interface Budget { widest: number; faces: number }  // pixels of a square; boxes' faces
const kWithCard: Budget = { widest: 260, faces: 60_000 };
const kInSoftware: Budget = { widest: 700, faces: 6_000 };

interface Indices { buffer: WebGLBuffer; n: number }

/// Curbs or paint. `points`: number in the buffer; kOther: the lines changed. They are relative to `anchor`, m in map.
interface Solid { buffer: WebGLBuffer; points: number; anchor: [number, number] }
const kOther = -1;

export class Relief {
  private net: { any: Program; plain: Program };  // for every look, and the faster one
  private block: Program;
  private solid: Program;
  private nets: { fine: Indices; coarse: Indices };
  private faceIndices: WebGLBuffer;
  private walls: Solid;
  private strips: Solid;
  private blocks: Blocks;
  private budget: Budget;
  private kept = new Set<Square>();
  private picture = 0;

  constructor(private gl: WebGL2RenderingContext, private world: World, private pages: Pages, isSlow: boolean) {
    this.blocks = new Blocks(world);
    this.budget = isSlow ? kInSoftware : kWithCard;
    const net = (fragment: string) => new Program(gl, kNetVertex, fragment, ["point"]);
    this.net = { any: net(kNetFragment), plain: net(kPlainNetFragment) };
    this.block = new Program(gl, kBlockVertex, kBlockFragment, ["point", "place"]);
    this.solid = new Program(gl, kSolidVertex, kSolidFragment, ["point"]);
    const indices = (step: number) => ({ buffer: this.buffer(gl.ELEMENT_ARRAY_BUFFER, netIndices(step)), n: netIndices(step).length });
    this.nets = { fine: indices(1), coarse: indices(kCoarseNet) };
    this.faceIndices = this.buffer(gl.ELEMENT_ARRAY_BUFFER, faceIndices());
    this.walls = { buffer: gl.createBuffer()!, points: kOther, anchor: [0, 0] };
    this.strips = { buffer: gl.createBuffer()!, points: kOther, anchor: [0, 0] };
  }

  curbsChanged(): void { this.walls.points = kOther; }
  markingsChanged(): void { this.strips.points = kOther; }

  /// `style` sets the uniforms of kPicture; `paint` brings a page's picture up to date; `isPlain`: not coloured by age
  /// and not grey; `curbs`, `markings`: their colours, or null; `isDraft`: coarser.
  draw(camera: Camera, style: (program: Program) => void, paint: Paint, cells: boolean, isPlain: boolean, curbs: number[] | null, markings: number[] | null, grey: number, isDraft: boolean): void {
    const { gl } = this, toClip = camera.matrix();
    ++this.picture;
    gl.enable(gl.DEPTH_TEST);
    if (cells) {
      const nearestFirst = squaresInView(this.pages.all.values(), camera, this.budget.widest, kReach), seen = byPage(nearestFirst);
      const pictures = new Map([...seen].map(([page, squares]) => [page, paint(page, Math.max(...squares.map(widthOfCell)))]));
      const use = (program: Program) => {
        program.use();
        style(program);
        gl.uniformMatrix4fv(program.at("toClip"), false, toClip);
        gl.uniform1f(program.at("reach"), kReach);
      };
      const net = isPlain ? this.net.plain : this.net.any;
      use(net);
      this.eachPage(net, camera, seen, pictures, ({ square }) => this.drawNet(square, isDraft ? this.nets.coarse : this.nets.fine));
      use(this.block);
      gl.enable(gl.CULL_FACE);
      const boxes = this.boxesWithin(this.budget.faces, nearestFirst);
      this.eachPage(this.block, camera, seen, pictures, ({ square }) => this.drawBoxes(boxes.get(square)));
      gl.disable(gl.CULL_FACE);
      gl.disableVertexAttribArray(1);
      this.forget();
    }
    this.solid.use();
    gl.uniformMatrix4fv(this.solid.at("toClip"), false, toClip);
    gl.uniform1f(this.solid.at("reach"), kReach);
    gl.uniform1f(this.solid.at("grey"), grey);
    if (markings) this.drawSolid(this.strips, camera, markings, anchor => stripsOf(this.world.markings.values(), anchor));
    if (curbs) this.drawSolid(this.walls, camera, curbs, anchor => wallsOf(this.world.curbs.values(), anchor));
    gl.disable(gl.DEPTH_TEST);
  }

  private eachPage(program: Program, camera: Camera, seen: Map<Page, Seen[]>, pictures: Map<Page, WebGLTexture>, draw: (one: Seen) => void): void {
    const { gl } = this;
    gl.enableVertexAttribArray(0);
    for (const [page, squares] of seen) {
      this.pages.bind(page, pictures.get(page)!);
      gl.uniform2f(program.at("corner"), page.x * kPageSize - camera.x, page.y * kPageSize - camera.y);
      squares.forEach(draw);
    }
  }

  private drawNet(square: Square, indices: Indices): void {
    const { gl } = this;
    this.renew(square);
    gl.bindBuffer(gl.ARRAY_BUFFER, square.net ??= this.buffer(gl.ARRAY_BUFFER, netPoints(square, this.blocks)));
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices.buffer);
    gl.drawElements(gl.TRIANGLES, indices.n, gl.UNSIGNED_SHORT, 0);
  }

  /// The boxes of the nearest squares, fine ones if there is room for them. Beyond the first without room there are none.
  private boxesWithin(room: number, nearestFirst: Seen[]): Map<Square, Boxes> {
    const chosen = new Map<Square, Boxes>();
    for (const one of nearestFirst) {
      const { square } = one, cell = widthOfCell(one);
      let boxes: Boxes | null = null;
      if (cell >= kFineCell) boxes = square.boxes[0] ??= this.boxesOf(square, 0);
      if ((!boxes || boxes.faces > room) && cell >= kCoarseCell) boxes = square.boxes[1] ??= this.boxesOf(square, 1);
      if (!boxes) continue;
      if (boxes.faces > room) break;
      if (boxes.faces > 0) chosen.set(square, boxes);
      room -= boxes.faces;
    }
    return chosen;
  }

  private drawBoxes(boxes?: Boxes): void {
    if (!boxes) return;
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, boxes.buffer);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 24, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 2, gl.FLOAT, false, 24, 16);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faceIndices);
    gl.drawElements(gl.TRIANGLES, 6 * boxes.faces, gl.UNSIGNED_SHORT, 0);
  }

  private boxesOf({ page, level, column, row }: Square, coarse: number): Boxes {
    const parts: Float32Array[] = [], aside = 1 << level;
    let size = 0;
    for (let i = 0; i < aside * aside; ++i) {
      const tile = page.tiles[(row + (i >> level)) * kTilesAside + column + i % aside];
      const part = tile && this.blocks.facesOf(tile, coarse);
      if (!part || part.length === 0 || size + part.length > kMaxFaces * kFaceFloats) continue;
      parts.push(part);
      size += part.length;
    }
    const all = new Float32Array(size);
    let at = 0;
    for (const part of parts) { all.set(part, at); at += part.length; }
    return { buffer: this.buffer(this.gl.ARRAY_BUFFER, all), faces: size / kFaceFloats };
  }

  /// Discards what was made from tiles that changed.
  private renew(square: Square): void {
    if (square.stale) this.drop(square);
    square.stale = false;
    square.used = this.picture;
    this.kept.add(square);
  }

  private drop(square: Square): void {
    for (const buffer of [square.net, ...square.boxes.map(boxes => boxes && boxes.buffer)]) if (buffer) this.gl.deleteBuffer(buffer);
    square.net = null;
    square.boxes = [null, null];
    this.kept.delete(square);
  }

  /// When too much is kept, discards what was not drawn for the longest time.
  private forget(): void {
    if (this.kept.size <= kMaxNets) return;
    const oldest = [...this.kept].sort((a, b) => a.used - b.used).slice(0, kMaxNets / 4);
    for (const square of oldest) if (square.used < this.picture) this.drop(square);
  }

  private buffer(target: number, values: ArrayBufferView): WebGLBuffer {
    const { gl } = this, made = gl.createBuffer()!;
    gl.bindBuffer(target, made);
    gl.bufferData(target, values, gl.STATIC_DRAW);
    return made;
  }

  private drawSolid(solid: Solid, camera: Camera, ink: number[], make: (anchor: [number, number]) => Float32Array): void {
    const { gl } = this;
    gl.uniform4fv(this.solid.at("ink"), ink);
    gl.bindBuffer(gl.ARRAY_BUFFER, solid.buffer);
    if (solid.points === kOther || !isNear(solid.anchor, camera)) {
      const points = make(solid.anchor = anchorAt(camera));
      gl.bufferData(gl.ARRAY_BUFFER, points, gl.DYNAMIC_DRAW);
      solid.points = points.length / 4;
    }
    gl.uniform2f(this.solid.at("anchor"), solid.anchor[0] - camera.x, solid.anchor[1] - camera.y);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.TRIANGLES, 0, solid.points);
  }
}

/// Pixels.
function widthOfCell({ square, width }: Seen): number {
  return width / (25 << square.level);
}

function byPage(seen: Seen[]): Map<Page, Seen[]> {
  const found = new Map<Page, Seen[]>();
  for (const one of seen) {
    const list = found.get(one.square.page);
    if (list) list.push(one);
    else found.set(one.square.page, [one]);
  }
  return found;
}

function faceIndices(): Uint16Array {
  const indices = new Uint16Array(6 * kMaxFaces);
  for (let i = 0; i < kMaxFaces; ++i) [0, 1, 2, 1, 3, 2].forEach((corner, n) => { indices[6 * i + n] = 4 * i + corner; });
  return indices;
}
