// Draws the page once for all that changed, and fetches the pictures around the current frame.

import { $ } from "./basics.js";
import { drawMarks } from "./marks.js";
import { page } from "./page.js";
import { askForPicture } from "./server.js";
import { tell } from "./telling.js";
import { drawTimeline } from "./timeline.js";
import { fitted, layout } from "./view.js";

const FRAMES_AHEAD = 16;
const FRAMES_KEPT = 400; // decoded pictures

let drawing = null;

export function draw() {
  drawing ??= requestAnimationFrame(paint); // once, however much changes before the screen does
}

function paint() {
  const { session, frame } = page;
  drawing = null;
  if (!session) return;
  const pen = fitted($("view"));
  const { scale, left, top } = layout();
  const shot = picture(session, frame);
  pen.imageSmoothingEnabled = false;
  if (shot) pen.drawImage(shot, left, top, session.clip.width * scale, session.clip.height * scale);
  if (page.marks) drawMarks(pen);
  drawTimeline();
  tell();
  prefetch();
}

function picture(session, number) {
  const known = session.pictures.get(number);
  if (known) return known instanceof Promise ? null : known;
  const coming = askForPicture(session.clip.name, number).then(
    (bitmap) => {
      session.pictures.set(number, bitmap);
      if (number === page.frame) draw();
    },
    () => session.pictures.delete(number),
  );
  session.pictures.set(number, coming);
  return null;
}

function prefetch() {
  const { session, frame } = page;
  const far = [...session.pictures.keys()].sort((a, b) => Math.abs(b - frame) - Math.abs(a - frame));
  for (const number of far.slice(0, Math.max(0, far.length - FRAMES_KEPT))) session.pictures.delete(number);
  for (let ahead = -4; ahead <= FRAMES_AHEAD; ahead++) {
    if (frame + ahead >= 0 && frame + ahead < session.T) picture(session, frame + ahead);
  }
}
