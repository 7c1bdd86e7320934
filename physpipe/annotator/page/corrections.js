// What a person says of the point: here it is, it is hidden, it is lost.

import { moveBox, removeBox } from "./boxes.js";
import { say } from "./history.js";
import { anchor, interpolate } from "./interpolation.js";
import { at, page } from "./page.js";
import { hint } from "./telling.js";

const LOST = { x: null, y: null, visible: false, interpolated: false };

const key = (point, visible) => ({ ...page.session.inside(point), visible, interpolated: false });
const shownHere = () => page.session.shown(page.object, page.frame);
const correct = (row, merge = false) => say((said) => said.corrections.set(at(), row), merge);

export const place = (point, visible) => correct(key(point, visible));
export const lose = () => correct(LOST);

export function nudge(dx, dy, held) {
  if (page.boxing) return moveBox(dx, dy);
  const now = shownHere();
  if (now.x === undefined && page.session.coming) return hint("The positions of this clip are on their way.");
  const point = now.x === undefined ? page.session.nearest(page.object, page.frame) : { x: now.x + dx, y: now.y + dy };
  correct(key(point, now.how !== "occluded"), held && now.how === "key");
}

export function keep() {
  const now = shownHere();
  if (now.x === undefined) {
    hint("No position to keep here; an arrow key makes one.");
    return false;
  }
  place(now, now.how !== "occluded");
  return true;
}

function occlude(said, on) {
  const now = page.session.shown(page.object, on);
  const point = now.x === undefined ? page.session.nearest(page.object, on) : now;
  said.corrections.set(at(on), { ...key(point, false), interpolated: now.interpolated ?? false });
}

export function toggleOccluded() {
  const now = shownHere();
  if (now.how === "occluded") correct({ ...key(now, true), interpolated: now.interpolated });
  else say((said) => occlude(said, page.frame));
}

// Marks all frames from the last one marked like `how` to this one.
export function extend(how) {
  const { session, object, frame } = page;
  let from = frame - 1;
  while (from >= 0 && session.shown(object, from).how !== how) from--;
  if (from < 0) return hint(`No earlier frame of object ${object} is ${how}; mark the first one, then come here.`);
  say((said) => {
    for (let on = from + 1; on <= frame; on++) {
      if (how === "occluded") occlude(said, on);
      else said.corrections.set(at(on), LOST);
    }
  });
}

// Back to the tracker's answer, together with the interpolated rows that hang on this one.
export function takeBack() {
  if (page.boxing) return removeBox();
  if (!page.session.said.corrections.has(at())) return hint("Nothing was corrected here.");
  say((said) => {
    said.corrections.delete(at());
    for (const step of [-1, 1]) {
      for (let on = page.frame + step; said.corrections.get(at(on))?.interpolated; on += step) {
        said.corrections.delete(at(on));
      }
    }
  });
}

// Interpolates between the keys on either side of this frame.
export function fill() {
  const { session, object, frame } = page;
  const isAnchor = (on) => anchor(session, session.said, object, on);
  const word = (on) => isAnchor(on) || session.said.corrections.get(at(on))?.x === null; // what filling stops at
  let [from, to] = [frame - 1, frame];
  while (from >= 0 && !word(from)) from--;
  while (to < session.T && !word(to)) to++;
  if (from < 0 || to >= session.T || !isAnchor(from) || !isAnchor(to)) {
    return hint(
      "Needs a key (a position by hand, or a box) before this frame, one here or after it, none lost between.",
    );
  }
  if (to === from + 1) return hint(`Frames ${from} and ${to} have nothing between them.`);
  say((said) => interpolate(session, said, object, from, to));
  hint(`Interpolated frames ${from + 1} to ${to - 1}.`);
}
