// Corrects the truth of a filmed set. What a person says about a clip is a value that never changes in place (`Said`);
// undo keeps the old values, saving sends the newest one, and a copy of what is not saved yet lies in the browser.

import { $ } from "./basics.js";
import { layCommands } from "./commands.js";
import { draw } from "./drawing.js";
import { onKey } from "./keyboard.js";
import { heedMouse } from "./mouse.js";
import { openClip } from "./navigation.js";
import { page, unsaved } from "./page.js";
import { save } from "./saving.js";
import { ask } from "./server.js";
import { alarm, listClips } from "./telling.js";

$("retry").addEventListener("click", () => (unsaved().length ? unsaved().forEach(save) : location.reload()));
addEventListener("beforeunload", (event) => unsaved().length && event.preventDefault());

async function begin() {
  layCommands();
  try {
    page.set = await ask("set");
  } catch (error) {
    return alarm(error.message);
  }
  const { name: title, clips } = page.set;
  $("set").textContent = title;
  document.title = `annotate ${title}`;
  $("clip").replaceChildren(...clips.map(({ name }) => new Option(name, name)));
  listClips();
  $("clip").addEventListener("change", () => {
    openClip($("clip").value);
    $("view").focus();
  });
  document.addEventListener("keydown", onKey);
  heedMouse();
  new ResizeObserver(draw).observe($("stage"));
  const asked = new URLSearchParams(location.hash.slice(1));
  page.object = Number(asked.get("object")) || 0;
  const known = clips.some(({ name }) => name === asked.get("clip"));
  await openClip(known ? asked.get("clip") : clips[0].name, Number(asked.get("frame")) || 0);
  $("view").focus();
}

begin();
