// The marks on the picture: the object's point, trail and box, and where the others are.

import { COLOURS } from "./basics.js";
import { at, page } from "./page.js";
import { corners, layout, toScreen } from "./view.js";

const TRAIL = 8; // frames drawn on either side of the current one
const POINT = 10; // screen pixels, radius of its ring
const ARMS = [
  [-1, 0],
  [1, 0],
  [0, -1],
  [0, 1],
];

export function drawMarks(pen) {
  const { session, object, frame } = page;
  for (let other = 0; other < session.objects; other++) {
    if (other !== object) drawOther(pen, other);
  }
  drawTrail(pen);
  const rectangle = page.boxing ?? session.said.boxes.get(at());
  if (rectangle) drawBox(pen, rectangle);
  const now = page.drag ?? session.shown(object, frame);
  if (now.x !== undefined) drawPoint(pen, now);
}

function drawOther(pen, other) {
  const now = page.session.shown(other, page.frame);
  if (now.x === undefined) return;
  const [x, y] = toScreen(now);
  Object.assign(pen, {
    strokeStyle: "#fffc",
    fillStyle: "#fff",
    lineWidth: 1.5,
    font: "12px system-ui",
    shadowColor: "#000",
    shadowBlur: 3,
  });
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillText(other, x + 8, y - 6);
  pen.shadowBlur = 0;
}

function drawTrail(pen) {
  const { session, object, frame } = page;
  for (let on = Math.max(0, frame - TRAIL); on <= Math.min(session.T - 1, frame + TRAIL); on++) {
    const now = session.shown(object, on);
    if (now.x === undefined || on === frame) continue;
    pen.globalAlpha = 0.8 * (1 - Math.abs(on - frame) / (TRAIL + 1));
    pen.fillStyle = COLOURS[now.how];
    pen.beginPath();
    pen.arc(...toScreen(now), 2, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.globalAlpha = 1;
}

// A ring with a cross in it, so that what lies under its middle stays to be seen.
function drawPoint(pen, now) {
  const [x, y] = toScreen(now);
  const strokes = new Path2D();
  strokes.arc(x, y, POINT, 0, 2 * Math.PI);
  for (const [dx, dy] of ARMS) {
    strokes.moveTo(x + dx * 4, y + dy * 4);
    strokes.lineTo(x + dx * (POINT + 5), y + dy * (POINT + 5));
  }
  pen.setLineDash([]);
  Object.assign(pen, { strokeStyle: "#000a", lineWidth: 4 });
  pen.stroke(strokes);
  pen.setLineDash(now.how === "occluded" ? [4, 3] : []);
  Object.assign(pen, { strokeStyle: COLOURS[now.how], lineWidth: 2 });
  pen.stroke(strokes);
  pen.setLineDash([]);
}

function drawBox(pen, { x, y, w, h }) {
  const { boxing } = page;
  const { scale, left, top } = layout();
  Object.assign(pen, { strokeStyle: COLOURS.box, lineWidth: boxing ? 3 : 1.5 });
  pen.setLineDash(boxing ? [] : [5, 4]);
  pen.strokeRect(left + x * scale, top + y * scale, w * scale, h * scale);
  pen.setLineDash([]);
  if (!boxing) return;
  pen.fillStyle = COLOURS.box;
  for (const [cx, cy] of corners(boxing)) pen.fillRect(left + cx * scale - 4, top + cy * scale - 4, 8, 8);
}
