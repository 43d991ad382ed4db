// The source of the map: a vehicle, its log, or a file. Controls without data in a saved map are hidden.
import { byId } from "../format";
import { State } from "../world";

/// True: the source changed to or from a saved map, so other cards now lie on the map.
export function showSource(state: State | null): boolean {
  const isFile = state?.source === "map", { classList } = document.documentElement;
  const isOther = classList.contains("file") !== isFile;
  classList.toggle("file", isFile);
  if (state?.localized) classList.add("localized");
  byId("source").textContent = state?.title ?? "";
  byId("health").hidden = isFile;
  const follow = byId<HTMLButtonElement>("follow");
  follow.disabled = isFile;
  follow.title = isFile ? "A saved map has no vehicle to follow" : "Follow the vehicle (F)";
  follow.classList.toggle("idle", !state?.pose);
  return isOther;
}
