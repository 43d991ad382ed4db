// Colours of the map. The clear palette differs in lightness as well as in hue, and has no pair of red and green: one
// man in twelve cannot tell these apart. The paper's is that of its Table I.

export type Rgb = [number, number, number];
export type Theme = "light" | "dark";
export type Mode = "class" | "paper" | "height" | "cost" | "confidence";

export const kModes: [Mode, string][] =
  [["class", "Class"], ["height", "Height"], ["cost", "Cost"], ["confidence", "Trust"]];

export const kClassNames = ["Unknown", "Road", "Curb", "Obstacle", "Wall or vehicle"];

const kClear: Record<Theme, (Rgb | null)[]> = {
  light: [null, [190, 196, 203], [233, 133, 8], [126, 186, 232], [28, 88, 160]],
  dark: [null, [70, 78, 89], [255, 178, 52], [164, 212, 255], [56, 134, 216]],
};
const kPaper: (Rgb | null)[] = [[0, 70, 30], [150, 150, 150], [0, 190, 0], [0, 0, 0], [200, 20, 20]];

/// By class; null: nothing is drawn.
export function classColours(theme: Theme, mode: Mode): (Rgb | null)[] {
  return mode === "paper" ? kPaper : kClear[theme];
}

const kRamps: Record<"height" | "cost" | "confidence", Rgb[]> = {
  height: [[68, 1, 84], [70, 50, 127], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 194, 109], [159, 218, 58], [253, 231, 37]],
  cost: [[214, 222, 228], [224, 211, 176], [240, 192, 116], [244, 160, 62], [228, 120, 30], [196, 82, 22], [150, 48, 20], [96, 20, 18]],
  confidence: [[222, 228, 232], [190, 212, 222], [148, 194, 208], [104, 172, 192], [62, 146, 174], [30, 116, 152], [14, 86, 126], [8, 56, 96]],
};

/// Eight colours from the lowest value to the highest.
export function ramp(mode: Mode): Rgb[] {
  return mode === "cost" || mode === "confidence" ? kRamps[mode] : kRamps.height;
}

export function css(colour: Rgb): string {
  return `rgb(${colour.join(" ")})`;
}
