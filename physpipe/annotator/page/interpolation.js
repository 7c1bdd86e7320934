// Rows that follow the keys on either side.

import { rounded } from "./basics.js";
import { keyOf, middle } from "./said.js";

// What a span may end at: a position by the user's own word.
export function anchor(session, said, object, frame) {
  const row = said.corrections.get(keyOf(object, frame));
  if (row) return row.interpolated || row.x === null ? null : row;
  const box = session.clip.referenced ? undefined : said.boxes.get(keyOf(object, frame));
  return box ? middle(box) : null;
}

// Writes the rows between two anchors into `said`; a row that was hidden stays so.
export function interpolate(session, said, object, from, to) {
  const [a, b] = [anchor(session, said, object, from), anchor(session, said, object, to)];
  const times = session.clip.times_s;
  for (let frame = from + 1; frame < to; frame++) {
    const part = (times[frame] - times[from]) / (times[to] - times[from]);
    const before = said.corrections.get(keyOf(object, frame));
    said.corrections.set(keyOf(object, frame), {
      x: rounded(a.x + part * (b.x - a.x)),
      y: rounded(a.y + part * (b.y - a.y)),
      visible: before?.interpolated ? before.visible : true,
      interpolated: true,
    });
  }
}

// Draws every interpolated span of an object anew between the keys that it stands between.
export function follow(session, said, object) {
  const follows = (frame) => said.corrections.get(keyOf(object, frame))?.interpolated;
  for (let frame = 0; frame < session.T; frame++) {
    if (!follows(frame)) continue;
    let end = frame;
    while (follows(end + 1)) end++;
    const ends = [frame - 1, end + 1];
    if (ends.every((each) => anchor(session, said, object, each))) interpolate(session, said, object, ...ends);
    frame = end;
  }
}
