// Small words, and the colours of the style sheet by what they mark: for every part of the page.

export const $ = (id) => document.getElementById(id);
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
export const rounded = (value) => Math.round(value * 100) / 100;
export const plural = (count, word, words = `${word}s`) => `${count} ${count === 1 ? word : words}`;

const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const COLOURS = Object.fromEntries(
  ["tracker", "key", "between", "lost", "box"].map((name) => [name, colourOf(name)]),
);
COLOURS.occluded = COLOURS.key;
