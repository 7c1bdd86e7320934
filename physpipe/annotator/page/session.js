// One clip while its page is open: what was said, its past and future, and what the server knows of it.

import { clamp, rounded } from "./basics.js";
import { Said, keyOf, middle } from "./said.js";

const DOUBTFUL = 0.6; // correlation below which the tracker's answer deserves a look
const SMALLEST_BOX = 3; // pixels, as the reader of the file wants it
const UNDO_STEPS = 300;

export class Session {
  // `offered` is the number of objects to choose from, whether anything was said of them or not.
  constructor(clip, offered) {
    this.clip = clip;
    this.T = clip.times_s.length;
    this.said = this.saved = Said.fromRows(clip.state);
    this.revision = clip.revision;
    this.past = [];
    this.future = [];
    this.answer = new Map(); // object -> {x, y, score}, each an array over frames; null where lost
    this.answered = null; // the boxes that `answer` belongs to
    this.coming = false; // whether `answer` is empty only until the server has said it
    this.pictures = new Map(); // frame -> ImageBitmap, or its promise
    this.offered = offered;
    this.busy = false;
  }

  get objects() {
    return Math.max(this.offered, this.said.objects(), ...[...this.answer.keys()].map((k) => k + 1));
  }

  // Makes `said` what undo brings back.
  remember(said) {
    this.past.push(said);
    if (this.past.length > UNDO_STEPS) this.past.shift();
    this.future = [];
  }

  // Where an object is shown, and why there: {how, x, y, score}.
  shown(object, frame) {
    const row = this.said.corrections.get(keyOf(object, frame));
    if (row) {
      if (row.x === null) return { how: "lost" };
      const how = row.visible ? (row.interpolated ? "between" : "key") : "occluded";
      return { how, x: row.x, y: row.y, interpolated: row.interpolated };
    }
    const answer = this.answer.get(object);
    if (answer && answer.x[frame] !== null) {
      return { how: "tracker", x: answer.x[frame], y: answer.y[frame], score: answer.score[frame] };
    }
    const box = !this.clip.referenced && !answer && this.said.boxes.get(keyOf(object, frame));
    return box ? { how: "tracker", ...middle(box) } : { how: "none" };
  }

  isDoubtful(object, frame) {
    const { how, score } = this.shown(object, frame);
    return how === "none" || (how === "tracker" && score < DOUBTFUL);
  }

  // The object's shown position here, else in the nearest frame that has one, else the middle of the picture.
  nearest(object, frame) {
    for (let away = 0; away < this.T; away++) {
      for (const at of [frame - away, frame + away]) {
        const point = at >= 0 && at < this.T ? this.shown(object, at) : {};
        if (point.x !== undefined) return { x: point.x, y: point.y };
      }
    }
    return { x: (this.clip.width - 1) / 2, y: (this.clip.height - 1) / 2 };
  }

  inside({ x, y }) {
    const { width, height } = this.clip;
    return { x: rounded(clamp(x, -0.5, width - 0.5)), y: rounded(clamp(y, -0.5, height - 0.5)) };
  }

  insideBox({ x, y, w, h }) {
    const { width, height } = this.clip;
    [w, h] = [clamp(Math.round(w), SMALLEST_BOX, width), clamp(Math.round(h), SMALLEST_BOX, height)];
    return { x: clamp(Math.round(x), 0, width - w), y: clamp(Math.round(y), 0, height - h), w, h };
  }
}
