// The timeline: a column a frame, its height the tracker's score.

import { $, COLOURS } from "./basics.js";
import { at, page } from "./page.js";
import { fitted } from "./view.js";

export function drawTimeline() {
  const { session } = page;
  const pen = fitted($("timeline"));
  const [across, down] = [$("timeline").clientWidth, $("timeline").clientHeight];
  const step = across / session.T;
  pen.fillStyle = "#2a2e36";
  pen.fillRect(0, 0, across, down);
  for (let on = 0; on < session.T; on++) {
    const [x, width] = [on * step, Math.max(step - (step > 4 ? 1 : 0), 0.5)];
    drawColumn(pen, on, x, width, down);
    pen.fillStyle = COLOURS.box;
    if (session.said.boxes.has(at(on))) pen.fillRect(x, 0, Math.max(width, 3), 10);
  }
  Object.assign(pen, { strokeStyle: "#fff", lineWidth: 2 });
  pen.strokeRect(page.frame * step - 1, 1, Math.max(step, 2) + 1, down - 2);
}

function drawColumn(pen, on, x, width, down) {
  const { session, object } = page;
  const { how, score } = session.shown(object, on);
  pen.fillStyle = COLOURS[how === "none" ? "lost" : how];
  if (how === "tracker") {
    const high = (down - 14) * (0.15 + 0.85 * (score ?? 1));
    pen.globalAlpha = session.isDoubtful(object, on) ? 1 : 0.55;
    pen.fillRect(x, down - high, width, high);
  } else if (how === "lost" || how === "none") {
    pen.globalAlpha = how === "lost" ? 1 : 0.35;
    pen.fillRect(x, down - 6, width, 6);
  } else {
    const high = how === "occluded" ? (down - 14) / 3 : down - 14;
    pen.fillRect(x, down - high, width, high);
  }
  pen.globalAlpha = 1;
}
