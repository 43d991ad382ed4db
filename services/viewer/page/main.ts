// The page: the connection updates the world, and the camera shows it.
import { InitialLoad } from "./initial_load";
import { showTurn } from "./cards/compass";
import { showServices } from "./cards/health";
import { Inspector } from "./cards/inspector";
import { Panel, showSummary } from "./cards/panel";
import { Ruler } from "./cards/ruler";
import { showScale } from "./cards/scale_bar";
import { showSource } from "./cards/source";
import { showFailure, showStatus } from "./cards/status";
import { clock, Timeline } from "./cards/timeline";
import { fit, uncover } from "./cards/free_area";
import { CloudLayer } from "./cloud_layer";
import { Connection } from "./connection";
import { wireControls } from "./controls";
import { Camera } from "./drawing/camera";
import { Ground } from "./drawing/ground";
import { DraftMode } from "./drawing/draft_mode";
import { Marks } from "./drawing/marks";
import { Motion } from "./drawing/motion";
import { Pace } from "./drawing/pace";
import { kInk } from "./drawing/ink";
import { css, kBackground } from "./drawing/palette";
import { saveCanvases } from "./drawing/save_picture";
import { Sheet } from "./drawing/sheet";
import { TiltedMarks } from "./drawing/tilted/tilted_marks";
import { Tilting } from "./drawing/tilted/tilting";
import { byId, fixed, seconds } from "./format";
import { listen } from "./gestures";
import { News } from "./news";
import { Rewind } from "./past/rewind";
import { Settings } from "./settings";
import { isLocalized, judge, judgePast, kElsewhere, kNoCloud, kNoLink } from "./staleness";
import { heightRange, isAnyInView, mapBounds, newestTime, placeUnder } from "./survey";
import { Pose, World } from "./world";

const world = new World(), initialLoad = new InitialLoad(world);
const camera = new Camera();
const settings = new Settings();
const map = byId("map"), groundCanvas = byId<HTMLCanvasElement>("ground"), marksCanvas = byId<HTMLCanvasElement>("marks");
const pace = new Pace(), draftMode = new DraftMode(camera, [groundCanvas, marksCanvas], redraw);
const motion = new Motion(), localized = new Motion(), tilting = new Tilting(camera);
let ground: Ground;
let marks: Marks;
let tiltedMarks: TiltedMarks;
let panel: Panel;
let inspector: Inspector;
let ruler: Ruler;
let connection: Connection, cloudLayer: CloudLayer;
let timeline: Timeline;
let rewind: Rewind;
let isWell = true;  // of the live data, whatever is shown
let epoch = 0;       // of the shown map
let range: [number, number] = [-1, 3];
let grey = 0, lives = false;  // lives: the vehicle, on a grey map
const news = new News();
let wanted = false;

function redraw(): void {
  if (wanted) return;
  wanted = true;
  requestAnimationFrame(draw);
}

function draw(now: number): void {
  wanted = false;
  const draft = draftMode.begin(now);
  const pose = motion.poseAt(now);
  if (settings.follow && pose) {
    [camera.x, camera.y] = [pose.x, pose.y];
    if (settings.headingUp) camera.turn = Math.PI / 2 - pose.yaw;
  }
  draftMode.follow();
  const look = settings.look, { layers } = settings;
  const isTilting = tilting.step(now, world, settings.follow ? pose : null);
  if (world.curbsChanged) ground.curbsChanged();
  if (world.markingsChanged) ground.markingsChanged();
  ground.draw(camera, { ...layers, theme: look, mode: settings.mode, byIntensity: settings.points === "intensity", cloudBy: settings.cloud,
    range, now: newestTime(world), grey, greyPoints: lives ? 0 : grey, draft, paper: kBackground[look] });
  const poses: [Pose, string][] = pose ? [[pose, kInk[look].vehicle]] : [], other = localized.poseAt(now);
  if (other && layers.localized) poses.unshift([other, kInk[look].localized]);
  marks.refresh(camera);
  (camera.isTilted ? tiltedMarks : marks).draw(camera, look, layers, poses, inspector.picked, ruler.places, grey, lives);
  showScale(camera.scale);
  showTurn(camera);
  connection.drawn();
  initialLoad.drew(now);
  if (pace.allows(now, motion.isMoving(now) || isTilting) && !document.hidden) redraw();
}

/// Called when a frame was received.
function onFrame(): void {
  if (!rewind.isPast) return onNews();
  requestAnimationFrame(() => connection.drawn());
  showTimeline();
}

function showTimeline(): void {
  const { state } = world;
  if (state?.playback) return timeline.show(rewind.playback());
  const isAnything = rewind.isPast || world.tiles.size > 0 || !!state?.pose;  // otherwise there is no past to show
  timeline.show(isAnything ? rewind.playback() : null, { isSeen: !rewind.isPast, isWell });
}

/// Called when the shown past changed. `leapt`: by a jump, not to the next moment.
function onPast(leapt: boolean): void {
  if (leapt) {
    motion.clear();
    localized.clear();
  }
  map.classList.toggle("past", rewind.isPast);
  onNews();
  look();
}

/// Called when the shown world changed.
function onNews(): void {
  const { state } = world;
  if (world.epoch !== epoch) leaveMap();
  state?.pose ? motion.add(state.pose, performance.now()) : motion.clear();
  if (state?.localized && isLocalized(state)) localized.add(state.localized, performance.now());
  else localized.clear();
  showTimeline();
  const draws = initialLoad.drawsEachFrame(performance.now());
  if (!initialLoad.shown && draws && world.tiles.size > 0) begin();
  const wasOpen = !byId("cell").hidden;
  inspector.show(settings.look, settings.mode);
  if (wasOpen && byId("cell").hidden) inspector.pick(null);  // the map of the cell is gone
  draws && news.isOther(world) ? redraw() : connection.drawn();
}

/// Called when another map is shown: what was pointed out in the one before is nowhere in it.
function leaveMap(): void {
  epoch = world.epoch;
  motion.clear();
  localized.clear();
  if (inspector.picked) inspector.pick(null);
  ruler.forget();
}

/// Called with the first tiles: looks at them, unless the address has a view.
function begin(): void {
  initialLoad.shown = true;
  if (showSource(world.state)) resize();
  if (settings.hasView && !settings.follow) return;
  if (world.state?.source === "map" && !settings.hasView) showWhole();
}

function showWhole(): void {
  settings.follow = false;
  camera.show(...mapBounds(world));
  settingsChanged();
}

/// Five times a second: states whether what is shown is current.
function watch(): void {
  const { state } = world, { isPast } = rewind;
  const now = judge(rewind.live.state, rewind.live.services, connection.link());
  isWell = now.mood !== "bad";
  const judged = isPast ? judgePast(judge(state, world.services, kNoLink), clock(rewind.behind / 1000)) : now;
  if (!judged.sentence && world.tiles.size > 0 && initialLoad.shown && !isAnyInView(world, camera)) judged.sentence = kElsewhere;
  if (!judged.sentence && isPast && settings.layers.cloud) judged.sentence = kNoCloud;
  showStatus(judged, now);
  if (grey === judged.grey && lives === !!judged.lives) return;
  [grey, lives] = [judged.grey, !!judged.lives];
  redraw();
}

/// Twice a second: updates what depends on the time or is not urgent.
function look(): void {
  const { state } = world, { isPast } = rewind;
  watch();
  showTimeline();
  if (initialLoad.asksForPart()) redraw();  // the part received so far
  settings.write(camera);
  const latency = grey || isPast || state?.playback?.ended ? null : state?.latency[0] ?? null;
  byId("latency").textContent = latency === null ? "" : `${seconds(latency)} from sensor to screen`;
  const alarm = showServices(world.services, isPast ? 0 : connection.age() / 1000, state?.playback ?? null);
  if (state) panel.showState(state, motion.speed);
  if (showSource(state)) resize();
  showSummary(state?.source === "map", motion.speed, latency, alarm);
  cloudLayer.trim(camera);
  const fresh = settings.mode === "height" || settings.layers.cloud ? heightRange(world, camera) : range;
  if (Math.abs(fresh[0] - range[0]) + Math.abs(fresh[1] - range[1]) > 0.1) {
    range = fresh;
    panel.refresh(range);
    redraw();
  }
}

function settingsChanged(): void {
  const root = document.documentElement;
  root.dataset.theme = settings.look;
  byId("follow").setAttribute("aria-pressed", String(settings.follow));
  byId("north").setAttribute("aria-pressed", String(settings.headingUp));
  root.classList.toggle("bare", !settings.panel);
  byId("aside").setAttribute("aria-expanded", String(settings.panel));
  panel.refresh(range);
  inspector.show(settings.look, settings.mode);
  connection.wantPoints(settings.layers.points);
  cloudLayer.ask();
  settings.write(camera);
  redraw();
}

/// Shows or hides the panel; where it is a sheet over the map, pulls it up or down.
function togglePanel(): void {
  if (matchMedia(kSheet).matches) return panel.open(!panel.isOpen);
  settings.panel = !settings.panel;
  settingsChanged();
  resize();
}

function resize(): void {
  fit(camera, map);
  redraw();
}

function toggleNorth(): void {
  settings.toggleNorth(camera);
  settingsChanged();
}

function toggleFollow(): void {
  if (world.state?.source === "map") return;
  settings.follow = !settings.follow;
  settingsChanged();
}

function toggleTilt(): void {
  tilting.toggle(performance.now());
  redraw();
}

function zoom(factor: number): void {
  camera.zoom(factor, ...camera.middle);
  redraw();
}

/// The user moved the view: stops following.
function leave(): void {
  if (!settings.follow) return;
  settings.follow = settings.headingUp = false;
  settingsChanged();
}

/// As in page.css: where the panel is a sheet.
const kSheet = "(max-width: 900px), (max-height: 500px)";

/// The arrow keys: a step on the screen. `leans`: turns and tilts.
function walk(right: number, down: number, leans: boolean): void {
  tilting.stop();
  if (!leans) leave();
  leans ? camera.lean(-down * 0.12, right * 0.12) : camera.step(80 * right, 80 * down);
  redraw();
}

/// A click, a tap or a long press.
function touched(x: number, y: number): void {
  const place = placeUnder(world, camera, x, y);
  if (ruler.isOn) ruler.put(place);
  else inspector.pick(place);
}

/// Called when another cell is selected, or none: keeps the view's centre in the centre of the area that the card
/// leaves free.
function onPicked(): void {
  const { x, y } = camera, middle = camera.toScreen(x, y);
  cloudLayer.ask();
  inspector.show(settings.look, settings.mode);
  resize();
  if (settings.follow) return;
  camera.hold(x, y, ...middle);
  if (inspector.picked) uncover(camera, ...inspector.picked);
}

/// Called when the measured places changed. Both must be visible beside the card, which grows with the second one.
function onMeasured(): void {
  ruler.show();
  inspector.covered = ruler.isOn;
  inspector.show(settings.look, settings.mode);
  resize();
  if (!settings.follow && ruler.places.length === 2) for (const { x, y } of ruler.places) uncover(camera, x, y, "ruler");
}

function savePicture(): void {
  draftMode.end();
  draw(performance.now());  // the ground can only be read in the task that drew it
  saveCanvases([groundCanvas, marksCanvas].filter(canvas => !canvas.hidden), css(kBackground[settings.look]));
}

function wire(): void {
  listen(map, camera, {
    moved: dragged => {
      if (dragged) leave();
      tilting.stop();
      redraw();
    },
    picked: touched,
    hovered: (x, y) => {
      byId("place").textContent = placeUnder(world, camera, x, y).map(m => fixed(m, 1)).join(", ") + " m";
    },
  });
  wireControls({
    follow: toggleFollow, north: toggleNorth, tilt: toggleTilt, measure: () => ruler.toggle(), save: savePicture, panel: togglePanel, zoom, whole: showWhole,
    live: () => rewind.goLive(),
    cloud: () => { settings.layers.cloud = !settings.layers.cloud; settingsChanged(); },
    escape: () => panel.isOpen ? panel.open(false) : ruler.isOn ? ruler.toggle() : inspector.pick(null),
  }, map, walk, () => touched(...camera.middle));
  byId("alarm").onclick = () => {
    if (!settings.panel) togglePanel();
    byId("health").scrollIntoView();
  };
  new ResizeObserver(resize).observe(map);  // the window was resized, or the phone was turned
  addEventListener("resize", resize);       // the window moved to a screen of another pixel density
  addEventListener("hashchange", () => {    // a link was pasted, or the browser's Back was used
    settings.read(camera);
    initialLoad.shown ||= settings.hasView;
    settingsChanged();
    resize();
  });
  document.addEventListener("visibilitychange", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", settingsChanged);
}

// For the browser's console and for tests/services/viewer/page.
rewind = new Rewind(world, onPast);
Object.assign(window, { curbstone: { world, camera, settings, rewind, initialLoad, redraw, get ruler() { return ruler; }, get ground() { return ground; } } });

settings.read(camera);
try {
  ground = new Ground(groundCanvas, world, redraw);
  const sheet = new Sheet(marksCanvas, canvas => ground.lay(canvas));
  [marks, tiltedMarks] = [new Marks(sheet, world), new TiltedMarks(sheet, world)];
  inspector = new Inspector(world, onPicked);
  ruler = new Ruler(world, onMeasured);
  connection = new Connection(rewind, onFrame);
  cloudLayer = new CloudLayer(settings, rewind, connection, inspector);
  timeline = new Timeline(order => world.state?.playback ? connection.order(order) : rewind.order(order), () => rewind.goLive());
  panel = new Panel(settings, settingsChanged);
  wire();
  settingsChanged();
  resize();
  look();
  setInterval(look, 500);
  setInterval(watch, 200);
} catch (error) {
  showFailure((error as Error).message);
}
