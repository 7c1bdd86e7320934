// Where the clip lies on the screen.

import { $, clamp } from "./basics.js";
import { page } from "./page.js";

export const ZOOM = 4;

// Sets what the zoomed view is centred on.
export function aim() {
  page.centre = page.session.nearest(page.object, page.frame);
}

// Where the clip lies in the canvas, in CSS pixels: {scale, left, top} of its top-left corner.
export function layout() {
  const { width, height } = page.session.clip;
  const [across, down] = [$("view").clientWidth, $("view").clientHeight];
  const scale = Math.min(across / width, down / height) * (page.zoomed ? ZOOM : 1);
  const place = (room, size, middle) =>
    size * scale <= room ? (room - size * scale) / 2 : clamp(room / 2 - (middle + 0.5) * scale, room - size * scale, 0);
  return { scale, left: place(across, width, page.centre.x), top: place(down, height, page.centre.y) };
}

// From clip pixels to CSS pixels of the canvas.
export function toScreen(point) {
  const { scale, left, top } = layout();
  return [left + (point.x + 0.5) * scale, top + (point.y + 0.5) * scale];
}

// Where the mouse is, in CSS pixels of the canvas.
export function screenOf(event) {
  const view = $("view").getBoundingClientRect();
  return [event.clientX - view.left, event.clientY - view.top];
}

// Where the mouse is, in clip pixels.
export function toClip(event) {
  const { scale, left, top } = layout();
  const [x, y] = screenOf(event);
  return { x: (x - left) / scale - 0.5, y: (y - top) / scale - 0.5 };
}

// A box's corners in turn, counted from the picture's corner, not from the first pixel's centre.
export const corners = ({ x, y, w, h }) => [0, 1, 2, 3].map((n) => [x + (n % 3 ? w : 0), y + (n > 1 ? h : 0)]);

// A clean canvas at the screen's own resolution, drawn on in CSS pixels.
export function fitted(canvas) {
  const ratio = devicePixelRatio;
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return pen;
}
