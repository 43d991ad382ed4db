// The WebSocket to the viewer. It reconnects by itself and resumes from the state the page has.
import { Link } from "./staleness";
import { World } from "./world";

const kRetry = 1000;    // ms
const kRefused = 5000;  // ms, the same after the viewer refused
const kSilence = 4000;  // ms without a frame: the connection counts as dead, whatever TCP reports

/// The receiver of the frames. take() returns the frame's number.
export interface Receiver { live: World; take(bytes: ArrayBuffer): number }

/// What is wanted of the dense cloud: all around the vehicle, and its saliencies; the tiles of a cross-section, m in map.
export interface CloudWish { wide: boolean; saliency: boolean; cut: [number, number] | null }

export class Connection {
  lastFrame = 0;  // ms of performance.now(); 0: none yet
  refusal = "";   // why the viewer refuses this page; empty: it does not, or it is away
  private socket: WebSocket | null = null;
  private undrawn: number | null = null;
  private points = false;
  private cloud: CloudWish = { wide: false, saliency: false, cut: null };

  constructor(private receiver: Receiver, private onFrame: () => void) {
    this.open();
    setInterval(() => this.watch(), 500);
  }

  get isOpen(): boolean { return this.socket?.readyState === WebSocket.OPEN; }

  /// ms since the last frame; 0 while a frame is not drawn yet, because until then the server sends no other.
  age(): number { return this.undrawn === null ? performance.now() - this.lastFrame : 0; }

  link(): Link {
    return { isOpen: this.isOpen && this.lastFrame > 0, age: this.age() / 1000, refusal: this.refusal };
  }

  /// Acknowledges the received frame as drawn: the server may send more.
  drawn(): void {
    if (this.undrawn === null) return;
    this.send({ ack: this.undrawn });
    this.undrawn = null;
    this.lastFrame = performance.now();  // not earlier: no frame could arrive while this one was drawn
  }

  wantPoints(wanted: boolean): void {
    this.points = wanted;
    this.send({ points: wanted });
  }

  wantCloud(wish: CloudWish): void {
    if (JSON.stringify(wish) === JSON.stringify(this.cloud)) return;
    this.cloud = wish;
    this.send({ cloud: wish });
  }

  /// Controls the playback of a log.
  order(play: { pause?: boolean; speed?: number; position?: number }): void {
    this.send({ play });
  }

  private open(): void {
    const address = liveAddress();
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const socket = this.socket = new WebSocket(address.href);
    let wasOpen = false;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      const { run, epoch, number } = this.receiver.live;
      wasOpen = true;
      this.refusal = "";
      this.undrawn = null;
      this.lastFrame = performance.now();
      this.send({ resume: run ? { run, epoch, number } : null });
      this.send({ points: this.points });
      if (this.cloud.wide || this.cloud.cut) this.send({ cloud: this.cloud });
    };
    socket.onmessage = event => {
      if (socket !== this.socket) return;
      this.undrawn = this.receiver.take(event.data);
      this.lastFrame = performance.now();
      this.onFrame();
    };
    socket.onclose = () => {
      if (socket !== this.socket) return;
      this.socket = null;
      this.undrawn = null;  // of a page that slept: it will not be drawn for this connection
      setTimeout(() => this.socket || this.open(), this.refusal ? kRefused : kRetry);
      if (!wasOpen) void this.ask();
    };
  }

  /// A browser does not tell why a WebSocket was refused, so the reason is requested.
  private async ask(): Promise<void> {
    try {
      const answer = await fetch(liveAddress().href, { cache: "no-store" });
      this.refusal = reasonOf(answer.status);
    } catch {
      this.refusal = "";  // nobody answers
    }
  }

  private watch(): void {
    if (this.isOpen && !document.hidden && this.undrawn === null && this.age() > kSilence) this.socket!.close();
  }

  private send(message: object): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(message));
  }
}

/// Beside the page, which a proxy may serve under a path of its own.
function liveAddress(): URL {
  const address = new URL("live", location.href);
  address.hash = address.search = "";
  return address;
}

/// As web/web_server.cpp answers a request for /live that is no WebSocket.
function reasonOf(status: number): string {
  if (status === 503) return "The viewer shows no more pages at a time: close one, or raise viewer.pages";
  if (status === 426) return `The viewer refuses a live connection from ${location.origin}: a proxy must pass on the Host header and WebSockets`;
  if (status === 403) return `The viewer does not answer to ${location.hostname}: add it to viewer.names`;
  return `What answers at ${location.host} is not curbstone-viewer (HTTP ${status})`;
}
