// Mouse and pen: points are dragged, boxes drawn, and the timeline is pressed.

import { $ } from "./basics.js";
import { place } from "./corrections.js";
import { draw } from "./drawing.js";
import { choose, go, stop } from "./navigation.js";
import { page } from "./page.js";
import { corners, layout, screenOf, toClip, toScreen } from "./view.js";

const GRAB = 12; // screen pixels from a point or a corner that still take hold of it

function onPress(event) {
  const { session, frame } = page;
  if (!session || event.button !== 0) return;
  event.preventDefault();
  stop();
  $("view").focus();
  $("view").setPointerCapture(event.pointerId);
  if (page.boxing) {
    page.boxing = { ...page.boxing, grip: gripOf(event) };
    return;
  }
  const close = (other) => {
    const now = session.shown(other, frame);
    return now.x === undefined
      ? Infinity
      : Math.hypot(...toScreen(now).map((each, axis) => each - screenOf(event)[axis]));
  };
  const nearest = [...Array(session.objects).keys()].sort((one, two) => close(one) - close(two))[0];
  if (close(nearest) <= GRAB && close(page.object) > GRAB) choose(nearest);
  const now = session.shown(page.object, frame);
  const held = close(page.object) <= GRAB; // takes hold of the point where it is, without a jump
  const from = toClip(event);
  page.drag = {
    ...(held ? { x: now.x, y: now.y } : session.inside(from)),
    dx: held ? now.x - from.x : 0,
    dy: held ? now.y - from.y : 0,
    how: now.how === "occluded" ? "occluded" : "key",
  };
  draw();
}

// Counted from the picture's corner, as boxes are.
function cornered(event) {
  const { x, y } = toClip(event);
  return [x + 0.5, y + 0.5];
}

// What of the box is held: a corner (the opposite one stays), its inside, or nothing: then a new box begins here.
function gripOf(event) {
  const { boxing } = page;
  const [x, y] = screenOf(event);
  const { scale, left, top } = layout();
  const all = corners(boxing);
  const near = all.findIndex(([cx, cy]) => Math.hypot(left + cx * scale - x, top + cy * scale - y) <= GRAB);
  if (near >= 0) return { fixed: all[(near + 2) % 4] };
  const [px, py] = cornered(event);
  const within = px >= boxing.x && px <= boxing.x + boxing.w && py >= boxing.y && py <= boxing.y + boxing.h;
  return within ? { offset: [boxing.x - px, boxing.y - py] } : { fixed: [px, py] };
}

function onDrag(event) {
  const { drag, boxing, session } = page;
  if (drag) {
    const point = toClip(event);
    page.drag = { ...drag, ...session.inside({ x: point.x + drag.dx, y: point.y + drag.dy }) };
    draw();
  } else if (boxing?.grip) {
    const { grip } = boxing;
    const [x, y] = cornered(event);
    const moved = grip.offset
      ? { ...boxing, x: x + grip.offset[0], y: y + grip.offset[1] }
      : {
          x: Math.min(x, grip.fixed[0]),
          y: Math.min(y, grip.fixed[1]),
          w: Math.abs(x - grip.fixed[0]),
          h: Math.abs(y - grip.fixed[1]),
        };
    page.boxing = { ...session.insideBox(moved), grip };
    draw();
  }
}

function onRelease() {
  if (page.drag) {
    const { x, y, how } = page.drag;
    page.drag = null;
    place({ x, y }, how !== "occluded");
  } else if (page.boxing?.grip) {
    delete page.boxing.grip;
  }
}

function onTimeline(event) {
  if (page.session && (event.type === "pointerdown" || event.buttons)) {
    stop();
    const view = $("timeline").getBoundingClientRect();
    go(Math.floor(((event.clientX - view.left) / view.width) * page.session.T));
  }
}

export function heedMouse() {
  for (const [type, run] of [
    ["pointerdown", onPress],
    ["pointermove", onDrag],
    ["pointerup", onRelease],
    ["pointercancel", onRelease],
  ]) {
    $("view").addEventListener(type, run);
  }
  for (const type of ["pointerdown", "pointermove"]) $("timeline").addEventListener(type, onTimeline);
}
