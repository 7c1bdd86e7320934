// Saying something new, and taking it back.

import { askForAnswer } from "./answer.js";
import { draw } from "./drawing.js";
import { follow } from "./interpolation.js";
import * as journal from "./journal.js";
import { page } from "./page.js";
import { save } from "./saving.js";
import { hint } from "./telling.js";

// Says something new. `change` gets a copy to write on; `merge` joins it to the step before, as keys held down do.
export function say(change, merge = false) {
  const { session } = page;
  const next = session.said.copy();
  change(next);
  follow(session, next, page.object);
  if (!merge) session.remember(session.said);
  became(next);
}

export function undo() {
  const { session } = page;
  if (!session.past.length) return hint("Nothing to undo.");
  session.future.push(session.said);
  became(session.past.pop());
}

export function redo() {
  const { session } = page;
  if (!session.future.length) return hint("Nothing to redo.");
  session.past.push(session.said);
  became(session.future.pop());
}

function became(said) {
  const { session } = page;
  session.said = said;
  journal.keep(session);
  askForAnswer(session);
  save(session);
  draw();
}
