// The processes and their faults.
import { byId, bytes, make, seconds } from "../format";
import { Service } from "../world";
import { LossHistory } from "./loss_history";

const kSilent = 2.5;   // s: SERVICE_STATUS comes each second
const kForget = 120;   // s
const kUnits: Record<string, string> = { dropped: "dropped", refused: "refused", lost: "lost", faults: "faults" };

const history = new LossHistory();

export interface Verdict { faults: number; silent: number; all: number }

export function showServices(services: Service[], age: number): Verdict {
  history.note(services);
  const seen = services.map(s => ({ ...s, age: s.age + age })).filter(s => s.age < kForget);
  const faults = seen.filter(s => s.faults.length > 0).length, silent = seen.filter(s => s.age > kSilent).length;
  byId("services").replaceChildren(...(seen.length ? seen.map(row) : [make("li", "None has been heard.", "none")]));
  const verdict = byId("verdict");
  verdict.textContent = seen.length === 0 ? "" : faults ? `${faults} with faults` : silent ? `${silent} silent` : "all well";
  verdict.className = faults || silent ? "bad" : "good";
  return { faults, silent, all: seen.length };
}

function row(service: Service): HTMLElement {
  const silent = service.age > kSilent;
  const numbers = silent ? `silent for ${seconds(service.age)}` :
    [percent(service.cpu), bytes(service.memory), ...latency(service)].join("  ·  ");
  const head = make("div", "", "row", make("b", service.name), make("span", numbers, "numbers"));
  head.title = `${service.host}, pid ${service.pid}, up for ${seconds(service.uptime)}, ${service.version}`;
  const item = make("li", "", silent ? "silent" : service.faults.length ? "fault" : "", head);
  for (const fault of service.faults) item.append(make("p", fault, "words"));
  const growing = service.losses.filter(([, , rate]) => rate > 0);
  const line = silent ? null : history.line(service.name);
  if (line) item.append(make("p", growing.map(loss).join(", ") || "nothing lost any more", "loss", line));
  return item;
}

function percent(cores: number): string {
  return `${(100 * cores).toFixed(0)} %`;
}

function latency({ latency: [p50, p99] }: Service): string[] {
  return p50 === null || p99 === null ? [] : [`${(1000 * p50).toFixed(0)} / ${seconds(p99)}`];
}

function loss([name, , rate]: [string, number, number]): string {
  const [kind, ...cause] = name.split(".");
  return `${rate < 10 ? rate.toFixed(1) : Math.round(rate)}/s ${kUnits[kind] ?? kind}: ${cause.join(" ").replace(/_/g, " ")}`;
}
