// Going from frame to frame, from object to object and from clip to clip.

import { askForAnswer } from "./answer.js";
import { $, clamp } from "./basics.js";
import { finishBox } from "./boxes.js";
import { draw } from "./drawing.js";
import { at, page } from "./page.js";
import { adopt } from "./saving.js";
import { ask, clipPath } from "./server.js";
import { Session } from "./session.js";
import { alarm, hint, tellSaved } from "./telling.js";
import { aim } from "./view.js";

let opening = null; // the clip that was asked for last
let playing = null;

export async function openClip(name, number = 0) {
  const { sessions } = page;
  stop();
  if (page.boxing) finishBox();
  opening = name;
  let told = "";
  try {
    if (!sessions.has(name)) {
      sessions.set(name, new Session(await ask(clipPath(name)), page.set.objects));
      told = await adopt(sessions.get(name));
    }
  } catch (error) {
    sessions.delete(name);
    $("clip").value = page.session?.clip.name ?? name;
    return alarm(error.message);
  }
  if (opening !== name) return; // another clip was asked for meanwhile
  page.session?.pictures.clear();
  page.session = sessions.get(name);
  page.object = clamp(page.object, 0, page.session.objects - 1);
  $("clip").value = name;
  tellSaved();
  go(number);
  hint(told || welcome(page.session));
  askForAnswer(page.session);
}

function welcome({ said: { boxes, corrections }, clip }) {
  return boxes.size || corrections.size || clip.referenced
    ? ""
    : "Nobody annotated this clip. b draws a box for the tracker; arrows place the point by hand; d goes on.";
}

export function goToClip(step) {
  const names = page.set.clips.map((each) => each.name);
  const to = names.indexOf(page.session.clip.name) + step;
  if (names[to]) openClip(names[to]);
  else hint(`No clip ${step > 0 ? "after" : "before"} this one.`);
}

export function go(to) {
  if (page.boxing) finishBox();
  page.drag = null;
  page.frame = clamp(to, 0, page.session.T - 1);
  aim();
  hint("");
  noteAddress();
  draw();
}

// A reload comes back to the same frame; seldom, because browsers limit how often the address may change.
function noteAddress() {
  clearTimeout(noteAddress.timer);
  noteAddress.timer = setTimeout(() => {
    const { session, frame, object } = page;
    history.replaceState(null, "", `#${new URLSearchParams({ clip: session.clip.name, frame, object })}`);
  }, 300);
}

export function goToKey(step) {
  const { said } = page.session;
  seek(step, (on) => said.boxes.has(at(on)) || said.corrections.get(at(on))?.interpolated === false, "key");
}

export function goToDoubt(step) {
  seek(step, (on) => page.session.isDoubtful(page.object, on), "doubtful frame");
}

function seek(step, wanted, what) {
  for (let on = page.frame + step; on >= 0 && on < page.session.T; on += step) {
    if (wanted(on)) return go(on);
  }
  hint(`No ${what} ${step > 0 ? "after" : "before"} this frame.`);
}

export function choose(number) {
  if (number >= page.session.objects) return hint(`There is no object ${number} yet; n makes a new one.`);
  if (page.boxing) finishBox();
  page.object = number;
  aim();
  draw();
}

export function offerObject() {
  page.session.offered = page.session.objects + 1;
  choose(page.session.offered - 1);
}

export function play() {
  const { session } = page;
  if (playing) return stop();
  if (page.frame === session.T - 1) go(0);
  const times = session.clip.times_s;
  const [from, began] = [page.frame, performance.now()];
  const tick = (now) => {
    let on = page.frame;
    while (on + 1 < session.T && times[on + 1] <= times[from] + (now - began) / 1000) on++;
    if (on !== page.frame) go(on);
    playing = on + 1 < session.T ? requestAnimationFrame(tick) : null;
  };
  playing = requestAnimationFrame(tick);
}

export function stop() {
  if (playing) cancelAnimationFrame(playing);
  playing = null;
}
