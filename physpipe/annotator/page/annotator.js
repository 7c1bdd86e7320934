// Corrects the truth of a filmed set. What a person says about a clip is a value that never changes in place (`Said`);
// undo keeps the old values, saving sends the newest one, and a copy of what is not saved yet lies in the browser.

const DOUBTFUL = 0.6; // correlation below which the tracker's answer deserves a look
const TRAIL = 8; // frames drawn on either side of the current one
const UNDO_STEPS = 300;
const FRAMES_AHEAD = 16;
const FRAMES_KEPT = 400; // decoded pictures
const RETRY_MS = 2000;
const ANSWER_MS = 15000;
const TRACKER_MS = 600000; // over a long clip with many objects
const SMALLEST_BOX = 3; // pixels, as the reader of the file wants it
const GRAB = 12; // screen pixels from a point or a corner that still take hold of it
const ZOOM = 4;

const $ = (id) => document.getElementById(id);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const rounded = (value) => Math.round(value * 100) / 100;
const plural = (count, word, words = `${word}s`) => `${count} ${count === 1 ? word : words}`;
const keyOf = (object, frame) => `${object}:${frame}`;
const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const COLOURS = Object.fromEntries(["tracker", "key", "between", "lost", "box"].map((name) => [name, colourOf(name)]));
COLOURS.occluded = COLOURS.key;

// ---- The server -----------------------------------------------------------------------------------------------------

class Refused extends Error {
  constructor(code, answer) {
    super(answer.error ?? `the server answered ${code}`);
    Object.assign(this, { code, answer });
  }
}

async function ask(path, method = "GET", body = undefined, patience = ANSWER_MS) {
  const headers = body === undefined ? {} : { "Content-Type": "application/json" };
  const signal = AbortSignal.timeout(patience);
  const response = await fetch(`api/${path}`, { method, headers, body: body && JSON.stringify(body), signal });
  const answer = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

const clipPath = (name, ...rest) => ["clips", encodeURIComponent(name), ...rest].join("/");

// ---- What was said about a clip -------------------------------------------------------------------------------------

class Said {
  // Maps from "object:frame" to {x, y, w, h} (left, top, width, height) and {x, y, visible, interpolated}, clip pixels.
  constructor(boxes = new Map(), corrections = new Map()) {
    Object.assign(this, { boxes, corrections });
  }

  static fromRows({ boxes, corrections }) {
    const mapped = (rows) => new Map(rows.map(({ object, frame, ...row }) => [keyOf(object, frame), row]));
    return new Said(mapped(boxes), mapped(corrections));
  }

  toRows() {
    const rows = (map) =>
      [...map].map(([key, row]) => {
        const [object, frame] = key.split(":").map(Number);
        return { object, frame, ...row };
      });
    return { boxes: rows(this.boxes), corrections: rows(this.corrections) };
  }

  copy() {
    return new Said(new Map(this.boxes), new Map(this.corrections));
  }

  objects() {
    const keys = [...this.boxes.keys(), ...this.corrections.keys()];
    return keys.reduce((most, key) => Math.max(most, Number(key.split(":")[0]) + 1), 0);
  }
}

const sameSaid = (one, two) => {
  const plain = (map) =>
    [...map].sort(([a], [b]) => (a < b ? -1 : 1)).map(([key, row]) => [key, Object.entries(row).sort()]);
  return (
    JSON.stringify([plain(one.boxes), plain(one.corrections)]) ===
    JSON.stringify([plain(two.boxes), plain(two.corrections)])
  );
};

const middle = (box) => ({ x: box.x + (box.w - 1) / 2, y: box.y + (box.h - 1) / 2 });

// One clip while its page is open: what was said, its past and future, and what the server knows of it.
class Session {
  constructor(clip) {
    this.clip = clip;
    this.T = clip.times_s.length;
    this.said = this.saved = Said.fromRows(clip.state);
    this.revision = clip.revision;
    this.past = [];
    this.future = [];
    this.answer = new Map(); // object -> {x, y, score}, each an array over frames; null where lost
    this.answered = null; // the boxes that `answer` belongs to
    this.pictures = new Map(); // frame -> ImageBitmap, or its promise
    this.offered = set.objects; // objects to choose from, whether anything was said of them or not
    this.busy = false;
  }

  get objects() {
    return Math.max(this.offered, this.said.objects(), ...[...this.answer.keys()].map((k) => k + 1));
  }

  // Where an object is shown, and why there: {how, x, y, score}.
  shown(object, frame) {
    const row = this.said.corrections.get(keyOf(object, frame));
    if (row) {
      if (row.x === null) return { how: "lost" };
      const how = row.visible ? (row.interpolated ? "between" : "key") : "occluded";
      return { how, x: row.x, y: row.y, interpolated: row.interpolated };
    }
    const answer = this.answer.get(object);
    if (answer && answer.x[frame] !== null) {
      return { how: "tracker", x: answer.x[frame], y: answer.y[frame], score: answer.score[frame] };
    }
    const box = !this.clip.referenced && !answer && this.said.boxes.get(keyOf(object, frame));
    return box ? { how: "tracker", ...middle(box) } : { how: "none" };
  }

  // The object's shown position here, else in the nearest frame that has one, else the middle of the picture.
  nearest(object, frame) {
    for (let away = 0; away < this.T; away++) {
      for (const at of [frame - away, frame + away]) {
        const point = at >= 0 && at < this.T ? this.shown(object, at) : {};
        if (point.x !== undefined) return { x: point.x, y: point.y };
      }
    }
    return { x: (this.clip.width - 1) / 2, y: (this.clip.height - 1) / 2 };
  }

  inside({ x, y }) {
    const { width, height } = this.clip;
    return { x: rounded(clamp(x, -0.5, width - 0.5)), y: rounded(clamp(y, -0.5, height - 0.5)) };
  }

  insideBox({ x, y, w, h }) {
    const { width, height } = this.clip;
    [w, h] = [clamp(Math.round(w), SMALLEST_BOX, width), clamp(Math.round(h), SMALLEST_BOX, height)];
    return { x: clamp(Math.round(x), 0, width - w), y: clamp(Math.round(y), 0, height - h), w, h };
  }
}

// ---- Interpolation: rows that follow the keys on either side --------------------------------------------------------

// What a span may end at: a position by the user's own word.
function anchor(session, said, object, frame) {
  const row = said.corrections.get(keyOf(object, frame));
  if (row) return row.interpolated || row.x === null ? null : row;
  const box = session.clip.referenced ? undefined : said.boxes.get(keyOf(object, frame));
  return box ? middle(box) : null;
}

function interpolate(session, said, object, from, to) {
  const [a, b] = [anchor(session, said, object, from), anchor(session, said, object, to)];
  const times = session.clip.times_s;
  for (let frame = from + 1; frame < to; frame++) {
    const part = (times[frame] - times[from]) / (times[to] - times[from]);
    const before = said.corrections.get(keyOf(object, frame));
    said.corrections.set(keyOf(object, frame), {
      x: rounded(a.x + part * (b.x - a.x)),
      y: rounded(a.y + part * (b.y - a.y)),
      visible: before?.interpolated ? before.visible : true,
      interpolated: true,
    });
  }
}

// Draws every interpolated span of an object anew between the keys that it stands between.
function follow(session, said, object) {
  const follows = (frame) => said.corrections.get(keyOf(object, frame))?.interpolated;
  for (let frame = 0; frame < session.T; frame++) {
    if (!follows(frame)) continue;
    let end = frame;
    while (follows(end + 1)) end++;
    const ends = [frame - 1, end + 1];
    if (ends.every((each) => anchor(session, said, object, each))) interpolate(session, said, object, ...ends);
    frame = end;
  }
}

// ---- What is not saved yet lies in the browser, so that a crash of either side loses nothing --------------------------

const tab = crypto.randomUUID();
navigator.locks.request(tab, () => new Promise(() => {})); // held as long as this tab lives

const journal = {
  place: (clip, of = tab) => `physpipe/${set.place}/${clip}/${of}`,

  keep(session) {
    const kept = { revision: session.revision, state: session.said.toRows(), at: Date.now() };
    try {
      localStorage.setItem(this.place(session.clip.name), JSON.stringify(kept));
    } catch {
      hint("This browser keeps no copy of unsaved changes (its storage is full or switched off).");
    }
  },

  drop(clip, of = tab) {
    localStorage.removeItem(this.place(clip, of));
  },

  // What tabs that are gone left behind for a clip, oldest first.
  async orphans(clip) {
    const prefix = this.place(clip, "");
    const held = new Set((await navigator.locks.query()).held.map((lock) => lock.name));
    return Object.keys(localStorage)
      .filter((key) => key.startsWith(prefix) && !held.has(key.slice(prefix.length)))
      .map((key) => ({ tab: key.slice(prefix.length), ...JSON.parse(localStorage.getItem(key)) }))
      .sort((one, two) => one.at - two.at);
  },
};

// ---- Saving ---------------------------------------------------------------------------------------------------------

async function save(session) {
  if (session.busy) return;
  session.busy = true;
  let trouble = null;
  while (session.said !== session.saved && !trouble) {
    tellSaved();
    const sent = session.said;
    const change = { place: set.place, revision: session.revision, state: sent.toRows() };
    try {
      const { revision } = await persistently(() => ask(clipPath(session.clip.name), "PUT", change));
      [session.revision, session.saved] = [revision, sent];
    } catch (error) {
      if (error.code === 409) await meet(session, sent, error.answer);
      else trouble = error;
    }
  }
  session.busy = false;
  if (!trouble) journal.drop(session.clip.name);
  alarm(trouble && `${session.clip.name} is not saved; this browser keeps your changes. ${trouble.message}`);
  tellSaved(trouble ? "not saved" : "");
  listClips();
}

// Tries until the server answers; whatever it answers counts.
async function persistently(request) {
  for (;;) {
    try {
      return await request();
    } catch (error) {
      if (error instanceof Refused) throw error;
      tellSaved("the server does not answer; kept in this browser, trying again");
      await new Promise((done) => setTimeout(done, RETRY_MS));
    }
  }
}

// The server holds something else than the change began with: what was sent before its answer got lost, or another's.
async function meet(session, sent, { revision, state }) {
  const theirs = Said.fromRows(state);
  session.revision = revision;
  if (sameSaid(theirs, sent)) session.saved = sent;
  else await settle(session, theirs, "Yours");
}

// Two versions of one clip: a person chooses, and undo holds the other.
async function settle(session, theirs, whose) {
  const mine = session.said;
  const choice = await chosen(session.clip.name, mine, theirs, whose);
  session.saved = theirs;
  session.said = choice === "mine" ? mine : theirs;
  remember(session, choice === "mine" ? theirs : mine);
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

// Takes over what tabs that are gone left behind for the clip; returns what to tell of it.
async function adopt(session) {
  let told = "";
  for (const left of await journal.orphans(session.clip.name)) {
    const [now, mine] = [session.said, Said.fromRows(left.state)];
    if (!sameSaid(mine, now)) {
      session.said = mine;
      journal.keep(session);
      if (left.revision === session.revision) {
        remember(session, now);
        told = "Changes that were not saved when this page was last open are back.";
      } else {
        await settle(session, now, `What this browser kept from ${new Date(left.at).toLocaleString()}`);
      }
      await save(session);
    }
    journal.drop(session.clip.name, left.tab);
  }
  return told;
}

$("conflict").addEventListener("cancel", (event) => event.preventDefault());
const unsaved = () => [...sessions.values()].filter((each) => each.said !== each.saved);
$("retry").addEventListener("click", () => (unsaved().length ? unsaved().forEach(save) : location.reload()));
addEventListener("beforeunload", (event) => unsaved().length && event.preventDefault());

// ---- The tracker's answer -------------------------------------------------------------------------------------------

async function askForAnswer(session) {
  const boxes = session.said.toRows().boxes;
  const wanted = JSON.stringify(boxes);
  if (session.answered === wanted) return;
  session.answered = wanted;
  if (!boxes.length && !session.clip.referenced) {
    session.answer = new Map();
    return draw();
  }
  if (!session.clip.referenced) hint("The tracker follows the boxes …");
  try {
    const found = await ask(clipPath(session.clip.name, "answer"), "POST", { boxes, corrections: [] }, TRACKER_MS);
    if (session.answered !== wanted) return; // the boxes changed meanwhile
    session.answer = new Map(Object.entries(found).map(([object, columns]) => [Number(object), columns]));
    if (!session.clip.referenced) hint("");
  } catch (error) {
    session.answered = null;
    hint(`No answer of the tracker: ${error.message}`);
  }
  draw();
}

// ---- State of the page ----------------------------------------------------------------------------------------------

let set = null;
let session = null;
let object = 0;
let frame = 0;
let drag = null; // {x, y, dx, dy, how}: a point under the mouse, not said yet, and where it was taken hold of
let boxing = null; // {x, y, w, h}: a box of the current object and frame that is being drawn
let zoomed = false;
let centre = null; // clip pixels in the middle of the zoomed view; stays while a point moves
let marks = true;
let playing = null;
const sessions = new Map(); // clip -> Session, so that undo survives a look at another clip

function remember(session, said) {
  session.past.push(said);
  if (session.past.length > UNDO_STEPS) session.past.shift();
  session.future = [];
}

// Says something new. `change` gets a copy to write on; `merge` joins it to the step before, as keys held down do.
function say(change, merge = false) {
  const next = session.said.copy();
  change(next);
  follow(session, next, object);
  if (!merge) remember(session, session.said);
  became(next);
}

function became(said) {
  session.said = said;
  journal.keep(session);
  askForAnswer(session);
  save(session);
  draw();
}

let opening = null;

async function open(name, number = 0) {
  stop();
  if (boxing) finishBox();
  opening = name;
  let told = "";
  try {
    if (!sessions.has(name)) {
      sessions.set(name, new Session(await ask(clipPath(name))));
      told = await adopt(sessions.get(name));
    }
  } catch (error) {
    sessions.delete(name);
    $("clip").value = session?.clip.name ?? name;
    return alarm(error.message);
  }
  if (opening !== name) return; // another clip was asked for meanwhile
  session?.pictures.clear();
  session = sessions.get(name);
  object = clamp(object, 0, session.objects - 1);
  $("clip").value = name;
  tellSaved();
  go(number);
  hint(told || welcome());
  askForAnswer(session);
}

function welcome() {
  const { boxes, corrections } = session.said;
  const said = boxes.size || corrections.size || session.clip.referenced;
  return said
    ? ""
    : "Nobody annotated this clip. b draws a box for the tracker; arrows place the point by hand; d goes on.";
}

function go(to) {
  if (boxing) finishBox();
  drag = null;
  frame = clamp(to, 0, session.T - 1);
  aim();
  hint("");
  noteAddress();
  draw();
}

// A reload comes back to the same frame; seldom, because browsers limit how often the address may change.
function noteAddress() {
  clearTimeout(noteAddress.timer);
  noteAddress.timer = setTimeout(() => {
    history.replaceState(null, "", `#${new URLSearchParams({ clip: session.clip.name, frame, object })}`);
  }, 300);
}

function choose(number) {
  if (number >= session.objects) return hint(`There is no object ${number} yet; n makes a new one.`);
  if (boxing) finishBox();
  object = number;
  aim();
  draw();
}

function offerObject() {
  session.offered = session.objects + 1;
  choose(session.offered - 1);
}

function toggleZoom() {
  zoomed = !zoomed;
  aim();
  draw();
}

function toggleMarks() {
  marks = !marks;
  draw();
}

// ---- Pictures -------------------------------------------------------------------------------------------------------

function picture(session, number) {
  const known = session.pictures.get(number);
  if (known) return known instanceof Promise ? null : known;
  const coming = decoded(session.clip.name, number).then(
    (bitmap) => {
      session.pictures.set(number, bitmap);
      if (number === frame) draw();
    },
    () => session.pictures.delete(number),
  );
  session.pictures.set(number, coming);
  return null;
}

async function decoded(clip, number) {
  const response = await fetch(`api/${clipPath(clip, "frames", number)}`);
  return createImageBitmap(await response.blob(), { colorSpaceConversion: "none" });
}

function prefetch() {
  const far = [...session.pictures.keys()].sort((a, b) => Math.abs(b - frame) - Math.abs(a - frame));
  for (const number of far.slice(0, Math.max(0, far.length - FRAMES_KEPT))) session.pictures.delete(number);
  for (let ahead = -4; ahead <= FRAMES_AHEAD; ahead++) {
    if (frame + ahead >= 0 && frame + ahead < session.T) picture(session, frame + ahead);
  }
}

// ---- What can be done -----------------------------------------------------------------------------------------------

const at = (number = frame) => keyOf(object, number);
const correct = (row, number = frame, merge = false) => say((said) => said.corrections.set(at(number), row), merge);
const key = (point, visible = true) => ({ ...session.inside(point), visible, interpolated: false });

function nudge(dx, dy, held) {
  if (boxing) return moveBox(dx, dy);
  const now = session.shown(object, frame);
  const point = now.x === undefined ? session.nearest(object, frame) : { x: now.x + dx, y: now.y + dy };
  correct(key(point, now.how !== "occluded"), frame, held && now.how === "key");
}

function keep() {
  const now = session.shown(object, frame);
  if (now.x === undefined) {
    hint("No position to keep here; an arrow key makes one.");
    return false;
  }
  correct(key(now, now.how !== "occluded"));
  return true;
}

const LOST = { x: null, y: null, visible: false, interpolated: false };

function occlude(said, on) {
  const now = session.shown(object, on);
  const point = now.x === undefined ? session.nearest(object, on) : now;
  said.corrections.set(at(on), { ...key(point, false), interpolated: now.interpolated ?? false });
}

function toggleOccluded() {
  const now = session.shown(object, frame);
  if (now.how === "occluded") correct({ ...key(now), interpolated: now.interpolated });
  else say((said) => occlude(said, frame));
}

// Marks all frames from the last one marked like `how` to this one.
function extend(how) {
  let from = frame - 1;
  while (from >= 0 && session.shown(object, from).how !== how) from--;
  if (from < 0) return hint(`No earlier frame of object ${object} is ${how}; mark the first one, then come here.`);
  say((said) => {
    for (let on = from + 1; on <= frame; on++) {
      if (how === "occluded") occlude(said, on);
      else said.corrections.set(at(on), LOST);
    }
  });
}

// Back to the tracker's answer, together with the interpolated rows that hang on this one.
function takeBack() {
  if (boxing) return removeBox();
  if (!session.said.corrections.has(at())) return hint("Nothing was corrected here.");
  say((said) => {
    said.corrections.delete(at());
    for (const step of [-1, 1]) {
      for (let on = frame + step; said.corrections.get(at(on))?.interpolated; on += step) {
        said.corrections.delete(at(on));
      }
    }
  });
}

function fill() {
  const isAnchor = (on) => anchor(session, session.said, object, on);
  const word = (on) => isAnchor(on) || session.said.corrections.get(at(on))?.x === null; // what filling stops at
  let [from, to] = [frame - 1, frame];
  while (from >= 0 && !word(from)) from--;
  while (to < session.T && !word(to)) to++;
  if (from < 0 || to >= session.T || !isAnchor(from) || !isAnchor(to)) {
    return hint(
      "Needs a key (a position by hand, or a box) before this frame, one here or after it, none lost between.",
    );
  }
  if (to === from + 1) return hint(`Frames ${from} and ${to} have nothing between them.`);
  say((said) => interpolate(session, said, object, from, to));
  hint(`Interpolated frames ${from + 1} to ${to - 1}.`);
}

function undo() {
  if (boxing) return cancelBox();
  if (!session.past.length) return hint("Nothing to undo.");
  session.future.push(session.said);
  became(session.past.pop());
}

function redo() {
  if (!session.future.length) return hint("Nothing to redo.");
  session.past.push(session.said);
  became(session.future.pop());
}

function seek(step, wanted, what) {
  for (let on = frame + step; on >= 0 && on < session.T; on += step) {
    if (wanted(on)) return go(on);
  }
  hint(`No ${what} ${step > 0 ? "after" : "before"} this frame.`);
}

const isKey = (on) => session.said.boxes.has(at(on)) || session.said.corrections.get(at(on))?.interpolated === false;

function isDoubtful(on) {
  const { how, score } = session.shown(object, on);
  return how === "none" || (how === "tracker" && score < DOUBTFUL);
}

function play() {
  if (playing) return stop();
  if (frame === session.T - 1) go(0);
  const times = session.clip.times_s;
  const [from, began] = [frame, performance.now()];
  const tick = (now) => {
    let on = frame;
    while (on + 1 < session.T && times[on + 1] <= times[from] + (now - began) / 1000) on++;
    if (on !== frame) go(on);
    playing = on + 1 < session.T ? requestAnimationFrame(tick) : null;
  };
  playing = requestAnimationFrame(tick);
}

function stop() {
  if (playing) cancelAnimationFrame(playing);
  playing = null;
}

const otherClip = (step) => {
  const names = set.clips.map((each) => each.name);
  const to = names.indexOf(session.clip.name) + step;
  if (names[to]) open(names[to]);
  else hint(`No clip ${step > 0 ? "after" : "before"} this one.`);
};

// ---- Template boxes -------------------------------------------------------------------------------------------------

function box() {
  if (boxing) return finishBox();
  if (session.clip.referenced) return hint("Truth comes from this clip's reference positions, which make boxes idle.");
  const last = [...session.said.boxes].filter(([each]) => each.startsWith(`${object}:`)).at(-1)?.[1];
  const side = Math.round(Math.min(session.clip.width, session.clip.height) / 6);
  const { w, h } = last ?? { w: side, h: side };
  const { x, y } = session.nearest(object, frame);
  boxing = session.said.boxes.get(at()) ?? session.insideBox({ x: x - (w - 1) / 2, y: y - (h - 1) / 2, w, h });
  hint("Box: arrows move it, Alt+arrows change its size, + and − both sides at once, Enter keeps it, Esc leaves it.");
  draw();
}

function moveBox(dx, dy) {
  boxing = session.insideBox({ ...boxing, x: boxing.x + dx, y: boxing.y + dy });
  draw();
}

// Wider and higher by (dx, dy) pixels, the left and top edges staying; `around`: both edges of a side move by as much.
function sizeBox(dx, dy, around = false) {
  const { x, y, w, h } = boxing;
  const by = around ? 2 : 1;
  boxing = session.insideBox({ x: around ? x - dx : x, y: around ? y - dy : y, w: w + by * dx, h: h + by * dy });
  draw();
}

function finishBox() {
  const { x, y, w, h } = boxing;
  boxing = null;
  hint("");
  const before = session.said.boxes.get(at());
  if (before && before.x === x && before.y === y && before.w === w && before.h === h) return draw();
  say((said) => said.boxes.set(at(), { x, y, w, h }));
}

function cancelBox() {
  boxing = null;
  hint("");
  draw();
}

function removeBox() {
  cancelBox();
  if (session.said.boxes.has(at())) say((said) => said.boxes.delete(at()));
  else hint("No box of this object here.");
}

// ---- Commands: one list for keys, buttons and the help --------------------------------------------------------------

const DIRECTIONS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

const COMMANDS = [
  ["Frames", "next", ["d", "."], "next frame", () => go(frame + 1), "holds"],
  ["Frames", "previous", ["a", ","], "previous frame", () => go(frame - 1), "holds"],
  ["Frames", "on", ["Shift+d"], "10 frames on", () => go(frame + 10), "holds"],
  ["Frames", "back", ["Shift+a"], "10 frames back", () => go(frame - 10), "holds"],
  ["Frames", "first", ["Home"], "first frame", () => go(0)],
  ["Frames", "last", ["End"], "last frame", () => go(session.T - 1)],
  ["Frames", "next-key", ["e", "]"], "next key (by hand, or a box)", () => seek(1, isKey, "key")],
  ["Frames", "previous-key", ["q", "["], "previous key", () => seek(-1, isKey, "key")],
  ["Frames", "next-doubt", ["w"], "next doubtful frame", () => seek(1, isDoubtful, "doubtful frame")],
  ["Frames", "previous-doubt", ["Shift+w"], "previous doubtful frame", () => seek(-1, isDoubtful, "doubtful frame")],
  ["Frames", "play", ["Space"], "play, stop", play],
  ["Frames", "next-clip", ["PageDown"], "next clip", () => otherClip(1)],
  ["Frames", "previous-clip", ["PageUp"], "previous clip", () => otherClip(-1)],
  ["Point", "keep", ["k"], "keep this position", keep, "button"],
  ["Point", "keep-on", ["Enter"], "keep it, next frame", () => (boxing ? finishBox() : keep() && go(frame + 1))],
  ["Point", "occluded", ["o"], "occluded: hidden, a guess", toggleOccluded, "button"],
  ["Point", "lost", ["l"], "lost: out of the picture", () => correct(LOST), "button"],
  ["Point", "occluded-since", ["Shift+o"], "occluded since the last such frame", () => extend("occluded")],
  ["Point", "lost-since", ["Shift+l"], "lost since the last such frame", () => extend("lost")],
  ["Point", "back-to-tracker", ["Delete", "Backspace"], "take the correction back", takeBack, "button"],
  ["Point", "interpolate", ["i"], "interpolate between keys", fill, "button"],
  ["Template box", "box", ["b"], "draw or change the box here", box, "button"],
  ["Template box", "remove-box", ["x"], "remove the box here", removeBox, "button"],
  ["Template box", "larger", ["+", "="], "box larger", () => boxing && sizeBox(1, 1, true), "holds"],
  ["Template box", "smaller", ["-"], "box smaller", () => boxing && sizeBox(-1, -1, true), "holds"],
  ["Template box", "cancel", ["Escape"], "leave the box as it was", () => boxing && cancelBox()],
  ["Changes", "undo", ["z", "Ctrl+z"], "undo", undo, "button holds"],
  ["Changes", "redo", ["Shift+z", "Ctrl+Shift+z", "Ctrl+y"], "redo", redo, "button holds"],
  ["Objects", "new-object", ["n"], "new object", offerObject, "button"],
  ["View", "zoom", ["f"], `zoom ${ZOOM}×, and back`, toggleZoom, "button"],
  ["View", "marks", ["m"], "hide or show the marks", toggleMarks, "button"],
  ["View", "help", ["?", "h"], "keys", () => $("help").showModal()],
].map(([group, id, keys, label, run, flags = ""]) => ({ group, id, keys, label, run, flags }));

const BY_KEY = new Map(COMMANDS.flatMap((command) => command.keys.map((each) => [each, command])));
const MORE_KEYS = [
  ["Point", ["←", "↑", "→", "↓"], "move by 1 px"],
  ["Point", ["Shift+arrow"], "by 10 px"],
  ["Point", ["Alt+arrow", "Ctrl+arrow"], "by 0.1 px"],
  ["Template box", ["arrow"], "move the box; with Shift by 10 px"],
  ["Template box", ["Alt+arrow", "Ctrl+arrow"], "wider, higher or less so"],
  ["Objects", ["0 … 9"], "choose an object"],
];

// As in COMMANDS. Where a keyboard writes other letters than a to z, the place of the key counts.
function nameOf(event) {
  const placed = /^Key[A-Z]$/.test(event.code) && /^[^ -~]$/.test(event.key) ? event.code.slice(3) : event.key;
  const letter = /^[a-z]$/i.test(placed);
  const name = placed === " " ? "Space" : letter ? placed.toLowerCase() : placed;
  const shift = event.shiftKey && (letter || placed.length > 1) ? "Shift+" : "";
  const control = (event.ctrlKey || event.metaKey) && !event.getModifierState("AltGraph") ? "Ctrl+" : "";
  return control + shift + name;
}

function onKey(event) {
  if (!session || document.querySelector("dialog[open]") || event.target.matches("select")) return;
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
  if (boxing && fine) return sizeBox(dx, dy);
  const step = event.shiftKey ? 10 : fine ? 0.1 : 1;
  nudge(dx * step, dy * step, event.repeat);
}

function perform(command) {
  if (command.id !== "play") stop();
  command.run();
}

function lay() {
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
    if (!pressed || !session) return;
    if (pressed.dataset.object) choose(Number(pressed.dataset.object));
    else perform(COMMANDS.find((each) => each.id === pressed.dataset.command));
    if (event.detail) $("view").focus(); // a mouse pressed it: keys go on meaning the film
  });
}

// ---- The picture and the marks on it --------------------------------------------------------------------------------

// Sets what the zoomed view is centred on.
function aim() {
  centre = session.nearest(object, frame);
}

// Where the clip lies in the canvas, in CSS pixels: {scale, left, top} of its top-left corner.
function layout() {
  const { width, height } = session.clip;
  const [across, down] = [$("view").clientWidth, $("view").clientHeight];
  const scale = Math.min(across / width, down / height) * (zoomed ? ZOOM : 1);
  const place = (room, size, middle) =>
    size * scale <= room ? (room - size * scale) / 2 : clamp(room / 2 - (middle + 0.5) * scale, room - size * scale, 0);
  return { scale, left: place(across, width, centre.x), top: place(down, height, centre.y) };
}

function toScreen(point, { scale, left, top } = layout()) {
  return [left + (point.x + 0.5) * scale, top + (point.y + 0.5) * scale];
}

function toClip(event, { scale, left, top } = layout()) {
  const frameOf = $("view").getBoundingClientRect();
  return {
    x: (event.clientX - frameOf.left - left) / scale - 0.5,
    y: (event.clientY - frameOf.top - top) / scale - 0.5,
  };
}

function fitted(canvas) {
  const ratio = devicePixelRatio;
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return pen;
}

let drawing = null;

function draw() {
  drawing ??= requestAnimationFrame(paint); // once, however much changes before the screen does
}

function paint() {
  drawing = null;
  if (!session) return;
  const pen = fitted($("view"));
  const { scale, left, top } = layout();
  const shot = picture(session, frame);
  pen.imageSmoothingEnabled = false;
  if (shot) pen.drawImage(shot, left, top, session.clip.width * scale, session.clip.height * scale);
  if (marks) drawMarks(pen);
  drawTimeline();
  tell();
  prefetch();
}

function drawMarks(pen) {
  for (let other = 0; other < session.objects; other++) {
    if (other !== object) drawOther(pen, other);
  }
  drawTrail(pen);
  const rectangle = boxing ?? session.said.boxes.get(at());
  if (rectangle) drawBox(pen, rectangle);
  const now = drag ?? session.shown(object, frame);
  if (now.x !== undefined) drawPoint(pen, now);
}

function drawOther(pen, other) {
  const now = session.shown(other, frame);
  if (now.x === undefined) return;
  const [x, y] = toScreen(now);
  Object.assign(pen, {
    strokeStyle: "#fffc",
    fillStyle: "#fff",
    lineWidth: 1.5,
    font: "12px system-ui",
    shadowColor: "#000",
    shadowBlur: 3,
  });
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.stroke();
  pen.fillText(other, x + 8, y - 6);
  pen.shadowBlur = 0;
}

function drawTrail(pen) {
  for (let on = Math.max(0, frame - TRAIL); on <= Math.min(session.T - 1, frame + TRAIL); on++) {
    const now = session.shown(object, on);
    if (now.x === undefined || on === frame) continue;
    pen.globalAlpha = 0.8 * (1 - Math.abs(on - frame) / (TRAIL + 1));
    pen.fillStyle = COLOURS[now.how];
    pen.beginPath();
    pen.arc(...toScreen(now), 2, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.globalAlpha = 1;
}

// A ring with a cross in it, so that what lies under its middle stays to be seen.
function drawPoint(pen, { how, x: across, y: down }) {
  const [x, y] = toScreen({ x: across, y: down });
  const radius = 10;
  const strokes = new Path2D();
  strokes.arc(x, y, radius, 0, 2 * Math.PI);
  for (const [dx, dy] of Object.values(DIRECTIONS)) {
    strokes.moveTo(x + dx * 4, y + dy * 4);
    strokes.lineTo(x + dx * (radius + 5), y + dy * (radius + 5));
  }
  pen.setLineDash([]);
  Object.assign(pen, { strokeStyle: "#000a", lineWidth: 4 });
  pen.stroke(strokes);
  pen.setLineDash(how === "occluded" ? [4, 3] : []);
  Object.assign(pen, { strokeStyle: COLOURS[how], lineWidth: 2 });
  pen.stroke(strokes);
  pen.setLineDash([]);
}

function drawBox(pen, { x, y, w, h }) {
  const { scale, left, top } = layout();
  Object.assign(pen, { strokeStyle: COLOURS.box, lineWidth: boxing ? 3 : 1.5 });
  pen.setLineDash(boxing ? [] : [5, 4]);
  pen.strokeRect(left + x * scale, top + y * scale, w * scale, h * scale);
  pen.setLineDash([]);
  if (!boxing) return;
  pen.fillStyle = COLOURS.box;
  for (const [cx, cy] of corners(boxing)) pen.fillRect(left + cx * scale - 4, top + cy * scale - 4, 8, 8);
}

// Counted from the picture's corner, not from the first pixel's centre.
const corners = ({ x, y, w, h }) => [0, 1, 2, 3].map((n) => [x + (n % 3 ? w : 0), y + (n > 1 ? h : 0)]);

// ---- The timeline: a column a frame, its height the tracker's score ---------------------------------------------------

function drawTimeline() {
  const pen = fitted($("timeline"));
  const [across, down] = [$("timeline").clientWidth, $("timeline").clientHeight];
  const step = across / session.T;
  pen.fillStyle = "#2a2e36";
  pen.fillRect(0, 0, across, down);
  for (let on = 0; on < session.T; on++) {
    const now = session.shown(object, on);
    const [x, width] = [on * step, Math.max(step - (step > 4 ? 1 : 0), 0.5)];
    if (now.how === "tracker") {
      const high = (down - 14) * (0.15 + 0.85 * (now.score ?? 1));
      pen.fillStyle = COLOURS.tracker;
      pen.globalAlpha = isDoubtful(on) ? 1 : 0.55;
      pen.fillRect(x, down - high, width, high);
      pen.globalAlpha = 1;
    } else if (now.how === "lost" || now.how === "none") {
      pen.fillStyle = COLOURS.lost;
      pen.globalAlpha = now.how === "lost" ? 1 : 0.35;
      pen.fillRect(x, down - 6, width, 6);
      pen.globalAlpha = 1;
    } else {
      pen.fillStyle = COLOURS[now.how];
      const high = now.how === "occluded" ? (down - 14) / 3 : down - 14;
      pen.fillRect(x, down - high, width, high);
    }
    pen.fillStyle = COLOURS.box;
    if (session.said.boxes.has(at(on))) pen.fillRect(x, 0, Math.max(width, 3), 10);
  }
  Object.assign(pen, { strokeStyle: "#fff", lineWidth: 2 });
  pen.strokeRect(frame * step - 1, 1, Math.max(step, 2) + 1, down - 2);
}

// ---- What the page says ---------------------------------------------------------------------------------------------

const HOW = {
  tracker: "the tracker's answer",
  key: "by hand",
  between: "interpolated",
  occluded: "occluded: a guess, hidden in the truth",
  lost: "lost, by hand",
  none: "no position",
};

function tell() {
  const { clip, T } = session;
  const now = drag ?? session.shown(object, frame);
  const why = clip.referenced && now.how === "tracker" ? "the reference position" : HOW[now.how];
  const score = now.score === undefined || clip.referenced ? "" : `, score ${now.score.toFixed(2)}`;
  const place = now.x === undefined ? "" : `(${now.x.toFixed(1)}, ${now.y.toFixed(1)}) px${score}`;
  $("where").textContent = [
    `frame ${frame} of 0 … ${T - 1}, ${clip.times_s[frame].toFixed(2)} s`,
    `object ${object}: ${why}`,
    place,
  ].join("\n");
  $("view").setAttribute("aria-label", `Frame ${frame} of clip ${clip.name}`);
  const status = clip.status[frame];
  $("badge").hidden = status === "ok";
  $("badge").textContent =
    status === "missing"
      ? "no frame was filmed here: an older picture"
      : "this frame could not be decoded: an older picture";
  tellObjects();
}

function tellObjects() {
  const numbers = [...Array(session.objects).keys()];
  if ($("objects").childElementCount !== numbers.length) {
    $("objects").innerHTML = numbers.map((k) => `<button type="button" data-object="${k}">${k}</button>`).join("");
  }
  for (const button of $("objects").children) {
    button.setAttribute("aria-pressed", Number(button.dataset.object) === object);
    button.setAttribute("aria-label", `object ${button.dataset.object}`);
  }
}

function tellSaved(trouble = "") {
  const waiting = unsaved().length > 0;
  $("saved").textContent = trouble || (waiting ? "saving …" : "saved");
  $("saved").className = trouble ? "failed" : waiting ? "waiting" : "";
}

function hint(text) {
  $("hint").textContent = text;
}

function alarm(text) {
  $("alert").hidden = !text;
  $("alert").firstElementChild.textContent = text ?? "";
}

function listClips() {
  for (const option of $("clip").options) {
    const said = sessions.get(option.value)?.said;
    const listed = set.clips.find((each) => each.name === option.value);
    const [boxes, corrections] = said
      ? [said.boxes.size, said.corrections.size]
      : [listed.templates, listed.corrections];
    const parts = [
      boxes && plural(boxes, "box", "boxes"),
      corrections && `${corrections} corrected`,
      listed.reference && "reference",
    ];
    option.textContent = [option.value, listed.split, ...parts.filter(Boolean)].join(" · ");
  }
}

// ---- Mouse and pen --------------------------------------------------------------------------------------------------

function onPress(event) {
  if (!session || event.button !== 0) return;
  event.preventDefault();
  stop();
  $("view").focus();
  $("view").setPointerCapture(event.pointerId);
  if (boxing) return (boxing = { ...boxing, grip: gripOf(event) });
  const close = (other) => {
    const now = session.shown(other, frame);
    return now.x === undefined
      ? Infinity
      : Math.hypot(...toScreen(now).map((each, axis) => each - screenOf(event)[axis]));
  };
  const nearest = [...Array(session.objects).keys()].sort((one, two) => close(one) - close(two))[0];
  if (close(nearest) <= GRAB && close(object) > GRAB) choose(nearest);
  const now = session.shown(object, frame);
  const held = close(object) <= GRAB; // takes hold of the point where it is, without a jump
  const from = toClip(event);
  drag = {
    ...(held ? { x: now.x, y: now.y } : session.inside(from)),
    dx: held ? now.x - from.x : 0,
    dy: held ? now.y - from.y : 0,
    how: now.how === "occluded" ? "occluded" : "key",
  };
  draw();
}

const screenOf = (event) => {
  const view = $("view").getBoundingClientRect();
  return [event.clientX - view.left, event.clientY - view.top];
};

// What of the box is held: a corner (the opposite one stays), its inside, or nothing: then a new box begins here.
function gripOf(event) {
  const [x, y] = screenOf(event);
  const { scale, left, top } = layout();
  const all = corners(boxing);
  const near = all.findIndex(([cx, cy]) => Math.hypot(left + cx * scale - x, top + cy * scale - y) <= GRAB);
  if (near >= 0) return { fixed: all[(near + 2) % 4] };
  const point = toClip(event);
  const [px, py] = [point.x + 0.5, point.y + 0.5];
  const within = px >= boxing.x && px <= boxing.x + boxing.w && py >= boxing.y && py <= boxing.y + boxing.h;
  return within ? { offset: [boxing.x - px, boxing.y - py] } : { fixed: [px, py] };
}

function onDrag(event) {
  if (drag) {
    const point = toClip(event);
    drag = { ...drag, ...session.inside({ x: point.x + drag.dx, y: point.y + drag.dy }) };
    draw();
  } else if (boxing?.grip) {
    const { grip } = boxing;
    const point = toClip(event);
    const [x, y] = [point.x + 0.5, point.y + 0.5];
    const moved = grip.offset
      ? { ...boxing, x: x + grip.offset[0], y: y + grip.offset[1] }
      : {
          x: Math.min(x, grip.fixed[0]),
          y: Math.min(y, grip.fixed[1]),
          w: Math.abs(x - grip.fixed[0]),
          h: Math.abs(y - grip.fixed[1]),
        };
    boxing = { ...session.insideBox(moved), grip };
    draw();
  }
}

function onRelease() {
  if (drag) {
    const { x, y, how } = drag;
    drag = null;
    correct(key({ x, y }, how !== "occluded"));
  } else if (boxing?.grip) {
    delete boxing.grip;
  }
}

function onTimeline(event) {
  if (session && (event.type === "pointerdown" || event.buttons)) {
    stop();
    const view = $("timeline").getBoundingClientRect();
    go(Math.floor(((event.clientX - view.left) / view.width) * session.T));
  }
}

// ---- Beginning ------------------------------------------------------------------------------------------------------

async function begin() {
  lay();
  try {
    set = await ask("set");
  } catch (error) {
    return alarm(error.message);
  }
  $("set").textContent = set.name;
  document.title = `annotate ${set.name}`;
  $("clip").replaceChildren(...set.clips.map(({ name }) => new Option(name, name)));
  listClips();
  $("clip").addEventListener("change", () => {
    open($("clip").value);
    $("view").focus();
  });
  document.addEventListener("keydown", onKey);
  for (const [type, run] of [
    ["pointerdown", onPress],
    ["pointermove", onDrag],
    ["pointerup", onRelease],
    ["pointercancel", onRelease],
  ]) {
    $("view").addEventListener(type, run);
  }
  for (const type of ["pointerdown", "pointermove"]) $("timeline").addEventListener(type, onTimeline);
  new ResizeObserver(draw).observe($("stage"));
  const asked = new URLSearchParams(location.hash.slice(1));
  object = Number(asked.get("object")) || 0;
  const known = set.clips.some(({ name }) => name === asked.get("clip"));
  await open(known ? asked.get("clip") : set.clips[0].name, Number(asked.get("frame")) || 0);
  $("view").focus();
}

begin();
