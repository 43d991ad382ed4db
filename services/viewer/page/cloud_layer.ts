// What the page asks the viewer of the dense cloud for, and what it keeps of it.
import { Inspector } from "./cards/inspector";
import { Connection } from "./connection";
import { Camera } from "./drawing/camera";
import { Rewind } from "./past/rewind";
import { Settings } from "./settings";

export class CloudLayer {
  private wasShown = false;

  constructor(private settings: Settings, private rewind: Rewind, private connection: Connection, private inspector: Inspector) {}

  /// Call it after the settings or the selection changed.
  ask(): void {
    const { layers, cloud } = this.settings, cut = this.inspector.cut;
    if (this.wasShown && !layers.cloud || !layers.cloud && !cut) this.rewind.live.cloud.clear();
    this.wasShown = layers.cloud;
    this.connection.wantCloud({ wide: layers.cloud, saliency: layers.cloud && (cloud === "surface" || cloud === "line"), cut });
  }

  /// Keeps to the budget; call it now and then.
  trim({ x, y }: Camera): void {
    const { cloud, state } = this.rewind.live;
    cloud.trim(x, y, state?.pose ?? null);
  }
}
