// A film of what is seen while the clock runs, as WebM: each frame is drawn as a picture onto one canvas, and the browser
// records that.

import { drawPicture, saveBlob } from "./picture.js";

const FRAMES_PER_S = 30;
const BITS_PER_S = 8e6;
const TYPE = "video/webm";

export function canRecord() {
  return typeof MediaRecorder === "function" && MediaRecorder.isTypeSupported(TYPE);
}

export class Recorder {
  // scene(): for drawPicture; the film ends with the clock.
  constructor(scene, cinema, name, onEnd) {
    Object.assign(this, { scene, cinema });
    this.canvas = drawPicture(scene());
    this.recorder = new MediaRecorder(this.canvas.captureStream(FRAMES_PER_S), { mimeType: TYPE, videoBitsPerSecond: BITS_PER_S });
    const pieces = [];
    this.recorder.addEventListener("dataavailable", ({ data }) => pieces.push(data));
    this.recorder.addEventListener("stop", () => {
      saveBlob(new Blob(pieces, { type: TYPE }), name);
      onEnd();
    });
    this.recorder.start(1000);
    cinema.player.play();
    this.draw();
  }

  draw() {
    if (this.recorder.state === "inactive") return;
    drawPicture(this.scene(), this.canvas);
    if (this.cinema.player.isPlaying) requestAnimationFrame(() => this.draw());
    else this.stop();
  }

  stop() {
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }
}
