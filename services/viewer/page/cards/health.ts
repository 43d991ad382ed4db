// The processes and their faults.
import { byId, bytes, make, seconds, setText } from "../format";
import { firstFault, isViewer } from "../staleness";
import { Playback, Service } from "../world";
import { LossHistory } from "./loss_history";

const kSilent = 2.5;   // s: SERVICE_STATUS comes each second
const kForget = 120;   // s
const kUnits: Record<string, string> = { dropped: "dropped", refused: "refused", lost: "lost", faults: "faults" };

const history = new LossHistory();

/// `log`: of a log that is played. While it stands nobody can be heard, so silence is counted from the last one that was.
/// At its end the states are those of processes that were being ended, one after the other: they are no alarms.
/// Returns what is wrong in words: the first fault along the way of the data, or who is silent; empty: all is well.
export function showServices(services: Service[], age: number, log: Playback | null): string {
  history.note(services);
  const stands = !!log && (log.paused || log.ended), isOver = !!log?.ended;
  const from = stands ? -Math.min(...services.map(s => s.age)) : age;
  const seen = services.map(s => ({ ...s, age: s.age + from })).filter(s => s.age < kForget);
  const faults = isOver ? 0 : seen.filter(s => s.faults.length > 0).length, silent = isOver ? 0 : seen.filter(s => s.age > kSilent).length;
  byId("services").replaceChildren(...(seen.length ? seen.map(s => row(s, isOver)) : [make("li", "None has been heard.", "none")]));
  const verdict = byId("verdict");
  verdict.textContent = seen.every(isViewer) ? "" : isOver ? "at the end of the log" : faults ? `${faults} with faults` : silent ? `${silent} silent` : "all well";
  verdict.className = isOver ? "" : faults || silent ? "bad" : "good";
  const heard = seen.filter(s => s.age <= kSilent), missed = seen.find(s => s.age > kSilent);
  showTotal(heard);
  const words = isOver ? "" : firstFault(heard) ||
    (!missed ? "" : heard.length > 0 ? `${missed.name}: silent for ${seconds(missed.age)}` : "no process is heard");
  showAlarm(words, heard.length > 0 ? seen.filter(s => s.faults.length > 0 || s.age > kSilent).length - 1 : 0);
  return words;
}

/// In the bar, which is seen whatever the panel shows. `others`: how many more there are.
function showAlarm(words: string, others: number): void {
  const alarm = byId("alarm");
  alarm.hidden = !words;
  setText(alarm, words + (others > 0 ? ` (and ${others} more)` : ""));
  if (words) alarm.title = alarm.textContent!;
}

/// Of the processes that are heard.
function showTotal(heard: Service[]): void {
  const sum = (of: (service: Service) => number) => heard.reduce((all, service) => all + of(service), 0);
  byId("total").replaceChildren(...(heard.length < 2 ? [] :
    [make("b", `All ${heard.length}`), make("span", `${percent(sum(s => s.cpu))} of a core  ·  ${bytes(sum(s => s.memory))}`)]));
}

function row(service: Service, isOver: boolean): HTMLElement {
  const silent = service.age > kSilent;
  const numbers = silent && !isOver ? `silent for ${seconds(service.age)}` :
    [percent(service.cpu), bytes(service.memory), ...latency(service)].join("  ·  ");
  const head = make("div", "", "row", make("b", service.name), make("span", numbers, "numbers"));
  head.title = `${service.host}, pid ${service.pid}, up for ${seconds(service.uptime)}, ${service.version}`;
  const item = make("li", "", isOver ? "over" : silent ? "silent" : service.faults.length ? "fault" : "", head);
  for (const fault of service.faults) item.append(make("p", fault, isOver ? "" : "words"));
  const growing = service.losses.filter(([, , rate]) => rate > 0);
  const line = silent || isOver ? null : history.line(service.name);
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
