// The state of the page: which set, clip, object and frame it shows, and what is under the mouse.

import { keyOf } from "./said.js";

export const page = {
  set: null, // as the server tells it: {name, place, objects, clips}
  session: null,
  sessions: new Map(), // clip -> Session, so that undo survives a look at another clip
  object: 0,
  frame: 0,
  drag: null, // {x, y, dx, dy, how}: a point under the mouse, not said yet, and where it was taken hold of
  boxing: null, // {x, y, w, h}: a box of the current object and frame that is being drawn
  zoomed: false,
  centre: null, // clip pixels in the middle of the zoomed view; stays while a point moves
  marks: true,
};

// The key of the current object in a frame.
export const at = (frame = page.frame) => keyOf(page.object, frame);

export const unsaved = () => [...page.sessions.values()].filter((each) => each.said !== each.saved);
