// The WebSocket to the viewer. It reconnects by itself and resumes from the state the page has.
import { World } from "./world";

const kRetry = 1000;    // ms
const kSilence = 4000;  // ms without a frame: the connection counts as dead, whatever TCP reports

/// The receiver of the frames. take() returns the frame's number.
export interface Receiver { live: World; take(bytes: ArrayBuffer): number }

export class Connection {
  lastFrame = 0;  // ms of performance.now(); 0: none yet
  private socket: WebSocket | null = null;
  private undrawn: number | null = null;
  private points = false;

  constructor(private receiver: Receiver, private onFrame: () => void) {
    this.open();
    setInterval(() => this.watch(), 500);
  }

  get isOpen(): boolean { return this.socket?.readyState === WebSocket.OPEN; }

  /// ms since the last frame; 0 while a frame is not drawn yet, because until then the server sends no other.
  age(): number { return this.undrawn === null ? performance.now() - this.lastFrame : 0; }

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

  /// Controls the playback of a log.
  order(play: { pause?: boolean; speed?: number; position?: number }): void {
    this.send({ play });
  }

  private open(): void {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = this.socket = new WebSocket(`${scheme}//${location.host}/live`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      const { run, epoch, number } = this.receiver.live;
      this.undrawn = null;
      this.lastFrame = performance.now();
      this.send({ resume: run ? { run, epoch, number } : null });
      this.send({ points: this.points });
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
      setTimeout(() => this.socket || this.open(), kRetry);
    };
  }

  private watch(): void {
    if (this.isOpen && !document.hidden && this.undrawn === null && this.age() > kSilence) this.socket!.close();
  }

  private send(message: object): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(message));
  }
}
