// What every part of the page's script uses. All files of it are joined into one module, in the order of page.py.

const data = JSON.parse(document.getElementById("report-data").textContent);
const INK = "var(--ink)";

const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

function escaped(text) {
  return String(text).replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** The first element of some HTML. */
function made(html) {
  const template = document.createElement("template");
  template.innerHTML = html.trim();
  return template.content.firstElementChild;
}

/** Three significant digits, as in the tables; a dash for what is not known. */
function figure(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return Math.abs(value) >= 1000 || value === 0 ? value.toFixed(0) : value.toPrecision(3);
}

const percent = (share) => (share === null ? "–" : `${(100 * share).toFixed(1)} %`);
