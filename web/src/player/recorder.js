// A film of what is seen while the clock runs, as MP4 or, where the browser makes none, as WebM: each frame is drawn as a picture
// onto one canvas, and the browser records that.

import { saveBlob } from "../base/files.js";
import { drawPicture } from "./picture.js";

const FRAMES_PER_S = 30;
const BITS_PER_S = 8e6;
const HOLD_MS = 1000; // that the last picture is seen; a film of fewer pictures than an encoder begins with would be empty
// Files' endings and kinds, the first one that there is; H.264 of a level that holds 4096 x 2304 pixels.
const KINDS = [["mp4", "video/mp4;codecs=avc1.640033"], ["webm", "video/webm"]];

const kindOf = () => KINDS.find(([, type]) => globalThis.MediaRecorder?.isTypeSupported(type));

// The ending of the file of a film; undefined: this browser makes none.
export function filmEnding() {
  return kindOf()?.[0];
}

export class Recorder {
  // scene(): for drawPicture; the film ends with the clock.
  constructor(scene, cinema, name, onEnd) {
    Object.assign(this, { scene, cinema, end: performance.now() + HOLD_MS });
    const [, type] = kindOf();
    this.canvas = drawPicture(scene());
    this.recorder = new MediaRecorder(this.canvas.captureStream(FRAMES_PER_S), { mimeType: type, videoBitsPerSecond: BITS_PER_S });
    const pieces = [];
    this.recorder.addEventListener("dataavailable", ({ data }) => pieces.push(data));
    this.recorder.addEventListener("stop", () => {
      saveBlob(new Blob(pieces, { type }), name);
      onEnd();
    });
    this.recorder.start(1000);
    cinema.player.play();
    this.draw();
  }

  draw() {
    if (this.recorder.state === "inactive") return;
    drawPicture(this.scene(), this.canvas);
    const now = performance.now();
    if (this.cinema.player.isPlaying) this.end = now + HOLD_MS;
    if (now < this.end) requestAnimationFrame(() => this.draw());
    else this.stop();
  }

  stop() {
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }
}
