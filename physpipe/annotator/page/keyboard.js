// Keys: arrows move, digits choose an object, all others are commands.

import { sizeBox } from "./boxes.js";
import { BY_KEY, perform } from "./commands.js";
import { nudge } from "./corrections.js";
import { choose, stop } from "./navigation.js";
import { page } from "./page.js";

const DIRECTIONS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

// As in the list of commands. Where a keyboard writes other letters than a to z, the place of the key counts.
function nameOf(event) {
  const placed = /^Key[A-Z]$/.test(event.code) && /^[^ -~]$/.test(event.key) ? event.code.slice(3) : event.key;
  const letter = /^[a-z]$/i.test(placed);
  const name = placed === " " ? "Space" : letter ? placed.toLowerCase() : placed;
  const shift = event.shiftKey && (letter || placed.length > 1) ? "Shift+" : "";
  const control = (event.ctrlKey || event.metaKey) && !event.getModifierState("AltGraph") ? "Ctrl+" : "";
  return control + shift + name;
}

export function onKey(event) {
  if (!page.session || document.querySelector("dialog[open]") || event.target.matches("select")) return;
  if (event.target.matches("button") && ["Enter", " "].includes(event.key)) return; // presses the button
  const direction = DIRECTIONS[event.key];
  if (event.altKey && !direction && !event.getModifierState("AltGraph")) return; // the browser's own
  if (direction) onArrow(direction, event);
  else if (/^[0-9]$/.test(event.key) && !event.ctrlKey && !event.altKey && !event.metaKey) choose(Number(event.key));
  else {
    const command = BY_KEY.get(nameOf(event));
    if (!command) return;
    if (!event.repeat || command.flags.includes("holds")) perform(command);
  }
  event.preventDefault();
}

function onArrow([dx, dy], event) {
  const fine = event.altKey || event.ctrlKey || event.metaKey;
  stop();
  if (page.boxing && fine) return sizeBox(dx, dy);
  const step = event.shiftKey ? 10 : fine ? 0.1 : 1;
  nudge(dx * step, dy * step, event.repeat);
}
