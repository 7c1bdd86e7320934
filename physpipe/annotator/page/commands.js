// What can be done: one list for keys, buttons and the help.

import { $ } from "./basics.js";
import { box, cancelBox, finishBox, removeBox, sizeBox } from "./boxes.js";
import { extend, fill, keep, lose, takeBack, toggleOccluded } from "./corrections.js";
import { draw } from "./drawing.js";
import { redo, undo } from "./history.js";
import { choose, go, goToClip, goToDoubt, goToKey, offerObject, play, stop } from "./navigation.js";
import { page } from "./page.js";
import { ZOOM, aim } from "./view.js";

const goBy = (step) => go(page.frame + step);

function toggleZoom() {
  page.zoomed = !page.zoomed;
  aim();
  draw();
}

function toggleMarks() {
  page.marks = !page.marks;
  draw();
}

const COMMANDS = [
  ["Frames", "next", ["d", "."], "next frame", () => goBy(1), "holds"],
  ["Frames", "previous", ["a", ","], "previous frame", () => goBy(-1), "holds"],
  ["Frames", "on", ["Shift+d"], "10 frames on", () => goBy(10), "holds"],
  ["Frames", "back", ["Shift+a"], "10 frames back", () => goBy(-10), "holds"],
  ["Frames", "first", ["Home"], "first frame", () => go(0)],
  ["Frames", "last", ["End"], "last frame", () => go(page.session.T - 1)],
  ["Frames", "next-key", ["e", "]"], "next key (by hand, or a box)", () => goToKey(1)],
  ["Frames", "previous-key", ["q", "["], "previous key", () => goToKey(-1)],
  ["Frames", "next-doubt", ["w"], "next doubtful frame", () => goToDoubt(1)],
  ["Frames", "previous-doubt", ["Shift+w"], "previous doubtful frame", () => goToDoubt(-1)],
  ["Frames", "play", ["Space"], "play, stop", play],
  ["Frames", "next-clip", ["PageDown"], "next clip", () => goToClip(1)],
  ["Frames", "previous-clip", ["PageUp"], "previous clip", () => goToClip(-1)],
  ["Point", "keep", ["k"], "keep this position", keep, "button"],
  ["Point", "keep-on", ["Enter"], "keep it, next frame", () => (page.boxing ? finishBox() : keep() && goBy(1))],
  ["Point", "occluded", ["o"], "occluded: hidden, a guess", toggleOccluded, "button"],
  ["Point", "lost", ["l"], "lost: out of the picture", lose, "button"],
  ["Point", "occluded-since", ["Shift+o"], "occluded since the last such frame", () => extend("occluded")],
  ["Point", "lost-since", ["Shift+l"], "lost since the last such frame", () => extend("lost")],
  ["Point", "back-to-tracker", ["Delete", "Backspace"], "take the correction back", takeBack, "button"],
  ["Point", "interpolate", ["i"], "interpolate between keys", fill, "button"],
  ["Template box", "box", ["b"], "draw or change the box here", box, "button"],
  ["Template box", "remove-box", ["x"], "remove the box here", removeBox, "button"],
  ["Template box", "larger", ["+", "="], "box larger", () => page.boxing && sizeBox(1, 1, true), "holds"],
  ["Template box", "smaller", ["-"], "box smaller", () => page.boxing && sizeBox(-1, -1, true), "holds"],
  ["Template box", "cancel", ["Escape"], "leave the box as it was", () => page.boxing && cancelBox()],
  ["Changes", "undo", ["z", "Ctrl+z"], "undo", () => (page.boxing ? cancelBox() : undo()), "button holds"],
  ["Changes", "redo", ["Shift+z", "Ctrl+Shift+z", "Ctrl+y"], "redo", redo, "button holds"],
  ["Objects", "new-object", ["n"], "new object", offerObject, "button"],
  ["View", "zoom", ["f"], `zoom ${ZOOM}×, and back`, toggleZoom, "button"],
  ["View", "marks", ["m"], "hide or show the marks", toggleMarks, "button"],
  ["View", "help", ["?", "h"], "keys", () => $("help").showModal()],
].map(([group, id, keys, label, run, flags = ""]) => ({ group, id, keys, label, run, flags }));

export const BY_KEY = new Map(COMMANDS.flatMap((command) => command.keys.map((each) => [each, command])));

// Keys that keyboard.js reads by itself, for the help.
const MORE_KEYS = [
  ["Point", ["←", "↑", "→", "↓"], "move by 1 px"],
  ["Point", ["Shift+arrow"], "by 10 px"],
  ["Point", ["Alt+arrow", "Ctrl+arrow"], "by 0.1 px"],
  ["Template box", ["arrow"], "move the box; with Shift by 10 px"],
  ["Template box", ["Alt+arrow", "Ctrl+arrow"], "wider, higher or less so"],
  ["Objects", ["0 … 9"], "choose an object"],
];

export function perform(command) {
  if (command.id !== "play") stop();
  command.run();
}

// Writes the buttons and the help, and lets the buttons do what they say.
export function layCommands() {
  const groups = [...new Set(COMMANDS.map((each) => each.group))];
  const shownKey = (name) =>
    `<kbd>${name.replace("Delete", "Del").replace("Escape", "Esc").replace("Backspace", "⌫")}</kbd>`;
  for (const group of groups) {
    const commands = COMMANDS.filter((each) => each.group === group);
    const lines = [
      ...MORE_KEYS.filter(([of]) => of === group).map(([, keys, label]) => ({ keys, label })),
      ...commands,
    ].map(({ keys, label }) => `<dt>${keys.map(shownKey).join(" ")}</dt><dd>${label}</dd>`);
    $("keys").insertAdjacentHTML("beforeend", `<section><h3>${group}</h3><dl>${lines.join("")}</dl></section>`);
    const buttons = commands
      .filter((each) => each.flags.includes("button"))
      .map(
        ({ id, keys, label }) => `<button type="button" data-command="${id}">${label} ${shownKey(keys[0])}</button>`,
      );
    if (buttons.length) $("commands").insertAdjacentHTML("beforeend", `<h3>${group}</h3>${buttons.join("")}`);
  }
  $("help-open").innerHTML = `Keys ${shownKey("?")}`;
  document.addEventListener("click", (event) => {
    const pressed = event.target.closest("[data-command], [data-object]");
    if (!pressed || !page.session) return;
    if (pressed.dataset.object) choose(Number(pressed.dataset.object));
    else perform(COMMANDS.find((each) => each.id === pressed.dataset.command));
    if (event.detail) $("view").focus(); // a mouse pressed it: keys go on meaning the film
  });
}
