// Two versions of one clip: a person chooses, and undo holds the other.

import { askForAnswer } from "./answer.js";
import { $, plural } from "./basics.js";
import { draw } from "./drawing.js";

export async function settle(session, theirs, whose) {
  const mine = session.said;
  const choice = await chosen(session.clip.name, mine, theirs, whose);
  session.saved = theirs;
  session.said = choice === "mine" ? mine : theirs;
  session.remember(choice === "mine" ? theirs : mine);
  askForAnswer(session);
  draw();
}

function chosen(clip, mine, theirs, whose) {
  const dialog = $("conflict");
  const count = (said) =>
    `${plural(said.boxes.size, "box", "boxes")} and ${plural(said.corrections.size, "corrected frame")}`;
  $("conflict-title").textContent = `${clip} was changed elsewhere`;
  $("conflict-text").textContent =
    `In another tab, or in the files by hand. The newer one holds ${count(theirs)}. ${whose} holds ${count(mine)}.`;
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((done) => {
    dialog.onclose = () => (dialog.returnValue ? done(dialog.returnValue) : dialog.showModal()); // Escape chooses nothing
  });
}

$("conflict").addEventListener("cancel", (event) => event.preventDefault());
