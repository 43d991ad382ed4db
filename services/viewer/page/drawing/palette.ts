// Colours of the map. The clear palette differs in lightness as well as in hue and has no red-green pair, which one man
// in twelve cannot tell apart. The paper's palette is that of its Table I.

export type Rgb = [number, number, number];
export type Theme = "light" | "dark";
export type Mode = "class" | "paper" | "height" | "cost" | "confidence" | "age";

export const kModes: [Mode, string][] =
  [["class", "Class"], ["height", "Height"], ["cost", "Cost"], ["confidence", "Confidence"], ["age", "Age"]];

export const kClassNames = ["Unknown", "Road", "Curb", "Obstacle", "Wall or vehicle"];

const kClear: Record<Theme, (Rgb | null)[]> = {
  light: [null, [190, 196, 203], [233, 133, 8], [126, 186, 232], [28, 88, 160]],
  dark: [null, [70, 78, 89], [255, 178, 52], [164, 212, 255], [56, 134, 216]],
};
const kPaper: (Rgb | null)[] = [[0, 70, 30], [150, 150, 150], [0, 190, 0], [0, 0, 0], [200, 20, 20]];

/// The colour of unknown; --paper in page.css.
export const kBackground: Record<Theme, Rgb> = { light: [243, 244, 241], dark: [14, 17, 20] };

/// Road paint, as in kInk.
export const kPaint: Record<Theme, Rgb> = { light: [255, 255, 255], dark: [217, 226, 234] };

/// Colour per class; null: not drawn.
export function classColours(theme: Theme, mode: Mode): (Rgb | null)[] {
  return mode === "paper" ? kPaper : kClear[theme];
}

const kRamps: Record<"height" | "cost" | "confidence" | "age", Rgb[]> = {
  height: [[68, 1, 84], [70, 50, 127], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 194, 109], [159, 218, 58], [253, 231, 37]],
  cost: [[214, 222, 228], [224, 211, 176], [240, 192, 116], [244, 160, 62], [228, 120, 30], [196, 82, 22], [150, 48, 20], [96, 20, 18]],
  age: [[255, 214, 102], [246, 178, 84], [226, 140, 92], [196, 108, 108], [160, 86, 122], [124, 74, 128], [92, 66, 122], [66, 58, 108]],
  confidence: [[222, 228, 232], [190, 212, 222], [148, 194, 208], [104, 172, 192], [62, 146, 174], [30, 116, 152], [14, 86, 126], [8, 56, 96]],
};

/// Eight colours from the lowest value to the highest.
export function ramp(mode: Mode): Rgb[] {
  return mode === "cost" || mode === "confidence" || mode === "age" ? kRamps[mode] : kRamps.height;
}

/// For the LiDAR's points, low to high or faint to bright; the paper has no such colours.
export function pointRamp(theme: Theme): Rgb[] {
  return kPointRamps[theme];
}

const kPointRamps: Record<Theme, Rgb[]> = {
  light: [[110, 120, 132], [112, 100, 140], [120, 80, 145], [134, 60, 142], [150, 42, 134], [168, 28, 124], [182, 20, 114], [190, 14, 104]],
  dark: [[120, 136, 152], [140, 136, 168], [164, 136, 184], [188, 138, 194], [210, 140, 200], [230, 144, 204], [244, 148, 206], [255, 156, 210]],
};

/// What colours the dense cloud.
export type CloudColour = "height" | "intensity" | "surface" | "line";
export const kCloudColours: [CloudColour, string][] = [["height", "Height"], ["intensity", "Intensity"], ["surface", "Surface"], ["line", "Line"]];

/// Eight colours from low, faint or none to high, bright or full. What stands out is dark on a light map, light on a dark one.
export function cloudRamp(theme: Theme, by: CloudColour): Rgb[] {
  if (by === "height" || by === "intensity") return kCloudRamps[by];
  const [light, dark] = by === "surface" ? [kRamps.confidence, kCloudRamps.surface] : [kRamps.cost, kCloudRamps.line];
  return theme === "light" ? light : dark;
}

const kCloudRamps: Record<CloudColour, Rgb[]> = {
  height: kRamps.height,
  intensity: [[0, 34, 78], [40, 62, 108], [84, 88, 108], [116, 116, 118], [150, 145, 118], [188, 175, 106], [226, 206, 84], [255, 234, 70]],
  surface: [[34, 44, 54], [32, 60, 78], [30, 78, 104], [34, 100, 134], [52, 128, 164], [88, 160, 194], [132, 194, 220], [186, 228, 244]],
  line: [[40, 40, 44], [70, 46, 40], [110, 56, 34], [156, 72, 28], [204, 100, 34], [240, 144, 60], [255, 190, 100], [255, 228, 164]],
};

export function css(colour: Rgb): string {
  return `rgb(${colour.join(" ")})`;
}
