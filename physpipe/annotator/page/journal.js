// What is not saved yet lies in the browser, so that a crash of either side loses nothing.

import { page } from "./page.js";
import { hint } from "./telling.js";

const tab = crypto.randomUUID();
navigator.locks.request(tab, () => new Promise(() => {})); // held as long as this tab lives

const place = (clip, of = tab) => `physpipe/${page.set.place}/${clip}/${of}`;

export function keep(session) {
  const kept = { revision: session.revision, state: session.said.toRows(), at: Date.now() };
  try {
    localStorage.setItem(place(session.clip.name), JSON.stringify(kept));
  } catch {
    hint("This browser keeps no copy of unsaved changes (its storage is full or switched off).");
  }
}

export function drop(clip, of = tab) {
  localStorage.removeItem(place(clip, of));
}

// What tabs that are gone left behind for a clip, oldest first.
export async function orphans(clip) {
  const prefix = place(clip, "");
  const held = new Set((await navigator.locks.query()).held.map((lock) => lock.name));
  return Object.keys(localStorage)
    .filter((key) => key.startsWith(prefix) && !held.has(key.slice(prefix.length)))
    .map((key) => ({ tab: key.slice(prefix.length), ...JSON.parse(localStorage.getItem(key)) }))
    .sort((one, two) => one.at - two.at);
}
