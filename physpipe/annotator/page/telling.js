// What the page says in words.

import { $, plural } from "./basics.js";
import { page, unsaved } from "./page.js";

const HOW = {
  tracker: "the tracker's answer",
  key: "by hand",
  between: "interpolated",
  occluded: "occluded: a guess, hidden in the truth",
  lost: "lost, by hand",
  none: "no position",
};

// About the current frame and object.
export function tell() {
  const { session, object, frame } = page;
  const { clip, T } = session;
  const now = page.drag ?? session.shown(object, frame);
  const why = clip.referenced && now.how === "tracker" ? "the reference position" : HOW[now.how];
  const score = now.score === undefined || clip.referenced ? "" : `, score ${now.score.toFixed(2)}`;
  const place = now.x === undefined ? "" : `(${now.x.toFixed(1)}, ${now.y.toFixed(1)}) px${score}`;
  $("where").textContent = [
    `frame ${frame} / ${T - 1}, ${clip.times_s[frame].toFixed(2)} s`,
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
  const numbers = [...Array(page.session.objects).keys()];
  if ($("objects").childElementCount !== numbers.length) {
    $("objects").innerHTML = numbers.map((k) => `<button type="button" data-object="${k}">${k}</button>`).join("");
  }
  for (const button of $("objects").children) {
    button.setAttribute("aria-pressed", Number(button.dataset.object) === page.object);
    button.setAttribute("aria-label", `object ${button.dataset.object}`);
  }
}

export function tellSaved(trouble = "") {
  const waiting = unsaved().length > 0;
  $("saved").textContent = trouble || (waiting ? "saving …" : "saved");
  $("saved").className = trouble ? "failed" : waiting ? "waiting" : "";
}

export function hint(text) {
  $("hint").textContent = text;
}

export function alarm(text) {
  $("alert").hidden = !text;
  $("alert").firstElementChild.textContent = text ?? "";
}

export function listClips() {
  for (const option of $("clip").options) {
    const said = page.sessions.get(option.value)?.said;
    const listed = page.set.clips.find((each) => each.name === option.value);
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
