// Template boxes: one at a time is being drawn, and leaving its frame keeps it.

import { draw } from "./drawing.js";
import { say } from "./history.js";
import { at, page } from "./page.js";
import { hint } from "./telling.js";

// Begins a box here, or keeps the one that is being drawn.
export function box() {
  const { session, object, frame } = page;
  if (page.boxing) return finishBox();
  if (session.clip.referenced) return hint("Truth comes from this clip's reference positions, which make boxes idle.");
  const last = [...session.said.boxes].filter(([each]) => each.startsWith(`${object}:`)).at(-1)?.[1];
  const side = Math.round(Math.min(session.clip.width, session.clip.height) / 6);
  const { w, h } = last ?? { w: side, h: side };
  const { x, y } = session.nearest(object, frame);
  page.boxing = session.said.boxes.get(at()) ?? session.insideBox({ x: x - (w - 1) / 2, y: y - (h - 1) / 2, w, h });
  hint("Box: arrows move it, Alt+arrows change its size, + and − both sides at once, Enter keeps it, Esc leaves it.");
  draw();
}

export function moveBox(dx, dy) {
  const { boxing } = page;
  page.boxing = page.session.insideBox({ ...boxing, x: boxing.x + dx, y: boxing.y + dy });
  draw();
}

// Wider and higher by (dx, dy) pixels, the left and top edges staying; `around`: both edges of a side move by as much.
export function sizeBox(dx, dy, around = false) {
  const { x, y, w, h } = page.boxing;
  const by = around ? 2 : 1;
  page.boxing = page.session.insideBox({
    x: around ? x - dx : x,
    y: around ? y - dy : y,
    w: w + by * dx,
    h: h + by * dy,
  });
  draw();
}

export function finishBox() {
  const { x, y, w, h } = page.boxing;
  page.boxing = null;
  hint("");
  const before = page.session.said.boxes.get(at());
  if (before && before.x === x && before.y === y && before.w === w && before.h === h) return draw();
  say((said) => said.boxes.set(at(), { x, y, w, h }));
}

export function cancelBox() {
  page.boxing = null;
  hint("");
  draw();
}

export function removeBox() {
  cancelBox();
  if (page.session.said.boxes.has(at())) say((said) => said.boxes.delete(at()));
  else hint("No box of this object here.");
}
