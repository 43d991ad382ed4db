// Formats numbers and makes small elements.

export function seconds(s: number | null): string {
  if (s === null) return "–";
  if (s < 0.9995) return `${Math.round(s * 1000)} ms`;
  if (s < 10) return `${s.toFixed(1)} s`;
  if (s < 90) return `${Math.round(s)} s`;
  return s < 5400 ? `${Math.round(s / 60)} min` : `${(s / 3600).toFixed(1)} h`;
}

/// As toFixed(), with a minus sign instead of the hyphen.
export function fixed(value: number, digits: number): string {
  return value.toFixed(digits).replace("-", "−");
}

export function metres(m: number): string {
  if (Math.abs(m) < 0.9995) return `${fixed(m * 100, Math.abs(m) < 0.0995 ? 1 : 0)} cm`;
  return `${fixed(m, 2)} m`;
}

export function bytes(n: number): string {
  return n < 1e9 ? `${Math.round(n / 1e6)} MB` : `${(n / 1e9).toFixed(1)} GB`;
}

/// An element with text and children; never parses HTML.
export function make(tag: string, text = "", className = "", ...children: Node[]): HTMLElement {
  const element = document.createElement(tag);
  if (text) element.textContent = text;
  if (className) element.className = className;
  element.append(...children);
  return element;
}

export function byId<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

export function closeButton(close: () => void): HTMLElement {
  const button = make("button", "×");
  button.setAttribute("aria-label", "Close");
  button.title = "Close (Esc)";
  button.onclick = close;
  return button;
}

/// Sets the text only if it differs: a screen reader reads each change aloud.
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/// Fills a <dl> with terms and values.
export function list(into: HTMLElement, rows: [string, string, boolean?][]): void {
  into.replaceChildren(...rows.flatMap(([term, value, bad]) => [make("dt", term), make("dd", value, bad ? "bad" : "")]));
}
