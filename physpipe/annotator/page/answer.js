// The tracker's answer to the boxes of a clip.

import { draw } from "./drawing.js";
import { ask, clipPath } from "./server.js";
import { hint } from "./telling.js";

const TRACKER_MS = 600000; // over a long clip with many objects

export async function askForAnswer(session) {
  const boxes = session.said.toRows().boxes;
  const wanted = JSON.stringify(boxes);
  if (session.answered === wanted) return;
  session.answered = wanted;
  if (!boxes.length && !session.clip.referenced) {
    session.answer = new Map();
    return draw();
  }
  if (!session.clip.referenced) hint("The tracker follows the boxes …");
  session.coming = session.clip.referenced; // at once: nobody need guess where the object is
  try {
    const found = await ask(clipPath(session.clip.name, "answer"), "POST", { boxes, corrections: [] }, TRACKER_MS);
    if (session.answered !== wanted) return; // the boxes changed meanwhile
    session.answer = new Map(Object.entries(found).map(([object, columns]) => [Number(object), columns]));
    if (!session.clip.referenced) hint("");
  } catch (error) {
    session.answered = null;
    hint(`No answer of the tracker: ${error.message}`);
  }
  session.coming = false;
  draw();
}
