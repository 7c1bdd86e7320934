// A panel of curves: an axis each way, and the values of every line at the place that is pointed at, in its legend.

const MARGIN = { top: 8, right: 12, bottom: 40, left: 52 };
const SMALL = 430; // px: a narrower panel is drawn lower and with fewer ticks
const TICK_PX = { x: 70, y: 38 };
const LETTER_PX = 8; // of a tick, at most

class Chart {
  constructor(panel) {
    Object.assign(this, { panel, lines: panel.lines, at: null, width: 0 });
    const title = panel.title ? `<h4>${escaped(panel.title)}</h4>` : "";
    this.element = made(`<div class="chart">${title}<div class="plot"></div><p class="at" role="status"></p><ul></ul></div>`);
    [this.plot, this.place, this.legend] = [".plot", ".at", "ul"].map((each) => this.element.querySelector(each));
    this.plot.addEventListener("pointermove", (event) => this.pointAt(event));
    this.plot.addEventListener("pointerdown", (event) => this.pointAt(event));
    this.plot.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && this.read(null));
    this.plot.addEventListener("keydown", (event) => this.press(event));
    this.plot.addEventListener("blur", () => this.read(null), true);
    new ResizeObserver(() => this.plot.clientWidth && this.plot.clientWidth !== this.width && this.draw()).observe(this.plot);
  }

  /** Keeps the lines of models that `shown` says yes to, and what they are compared with, which has no model. */
  filter(shown) {
    this.lines = this.panel.lines.filter((line) => line.model === "" || shown(line.model));
    this.element.hidden = this.lines.every((line) => line.model === "");
    if (!this.element.hidden) this.draw();
  }

  draw() {
    const { x, y } = this.panel;
    this.width = Math.max(this.plot.clientWidth || SMALL, 220);
    this.height = Math.round(this.width < SMALL ? clamp(this.width * 0.66, 150, 240) : clamp(this.width * 0.5, 240, 340));
    this.places = [...new Set(this.lines.flatMap((line) => line.x))].sort((a, b) => a - b);
    const values = this.lines.flatMap((line) => line.y.filter((value) => value !== null));
    const low = y.from ?? Math.min(...values);
    const [bottom, right] = [this.height - MARGIN.bottom, this.width - MARGIN.right];
    const first = x.ticks ? Math.min(this.places[0], x.ticks[0][0]) : this.places[0];
    const xs = [first, this.places.at(-1)];
    const ys = [low, y.to ?? Math.max(...values)];
    this.toX = scaleOf(x.scale, ...xs, MARGIN.left, right);
    this.toY = scaleOf(y.scale, ...ys, bottom, MARGIN.top);
    const drawn = [this.gridX(xs, bottom), this.gridY(ys, right), ...this.lines.map((line) => this.path(line))];
    const names = this.lines.map((line) => line.name).join(", ");
    const label = escaped(`${this.panel.title} ${y.label} over ${x.label}: ${names}. Arrow keys read values.`.trim());
    this.plot.innerHTML = `<svg viewBox="0 0 ${this.width} ${this.height}" role="img" tabindex="0" aria-label="${label}">${drawn.join("")}<g class="cursor"></g></svg>`;
    this.cursor = this.plot.querySelector(".cursor");
    this.legend.innerHTML = this.lines.map((line) => `<li>${swatch(line)}<span>${escaped(line.name)}</span><output></output></li>`).join("");
    all("li", this.legend).forEach((item, number) => this.stressOn(item, number));
    this.read(null);
  }

  gridX(ends, bottom) {
    const { ticks, scale, label } = this.panel.x;
    const wanted = ticks ?? ticksOf(scale, ...ends, this.width / TICK_PX.x).map((value) => [value, tickText(value)]);
    const lines = wanted.filter(([value]) => value <= ends[1]).map(([value, text]) => {
      const at = this.toX(value).toFixed(1);
      const half = (text.length * LETTER_PX) / 2;
      const inside = clamp(at, half, this.width - half).toFixed(1);
      return `<line class="grid" x1="${at}" x2="${at}" y1="${MARGIN.top}" y2="${bottom}"/><text x="${inside}" y="${bottom + 15}" text-anchor="middle">${escaped(text)}</text>`;
    });
    const middle = (this.toX(ends[0]) + this.toX(ends[1])) / 2;
    return `${lines.join("")}<text class="label" x="${middle}" y="${bottom + 32}" text-anchor="middle">${escaped(label)}</text>`;
  }

  gridY(ends, right) {
    const { scale, label } = this.panel.y;
    const lines = ticksOf(scale, ...ends, this.height / TICK_PX.y).map((value) => {
      const at = this.toY(value).toFixed(1);
      return `<line class="grid" x1="${MARGIN.left}" x2="${right}" y1="${at}" y2="${at}"/><text x="${MARGIN.left - 6}" y="${at}" dy=".35em" text-anchor="end">${this.panel.y.percent ? `${Math.round(100 * value)} %` : tickText(value)}</text>`;
    });
    const middle = (this.toY(ends[0]) + this.toY(ends[1])) / 2;
    return `${lines.join("")}<text class="label" transform="translate(11 ${middle}) rotate(-90)" text-anchor="middle">${escaped(label)}</text>`;
  }

  path(line) {
    let pen = "M";
    const steps = line.x.map((x, number) => {
      if (line.y[number] === null) {
        pen = "M";
        return "";
      }
      const step = `${pen}${this.toX(x).toFixed(1)} ${this.toY(line.y[number]).toFixed(1)}`;
      pen = "L";
      return step;
    });
    if (line.x.length === 1) steps.push("h0");
    const kind = `line${line.dashed ? " dashed" : ""}${line.wide ? " broad" : ""}${line.x.length === 1 ? " dot" : ""}`;
    return `<path class="${kind}" style="--line-colour:${line.colour}" d="${steps.join("")}"/>`;
  }

  pointAt(event) {
    const box = this.plot.firstElementChild.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * this.width;
    const near = this.places.reduce((best, x) => (Math.abs(this.toX(x) - at) < Math.abs(this.toX(best) - at) ? x : best));
    this.read(near);
  }

  press(event) {
    const last = this.places.length - 1;
    const now = this.at === null ? -1 : this.places.indexOf(this.at);
    const step = event.shiftKey ? 10 : 1;
    const to = { ArrowRight: now + step, ArrowLeft: now < 0 ? last : now - step, Home: 0, End: last }[event.key];
    if (event.key === "Escape") this.read(null);
    if (to === undefined) return;
    event.preventDefault();
    this.read(this.places[clamp(to, 0, last)]);
  }

  /** Writes every line's value at `x` into the legend, or clears it. */
  read(x) {
    this.at = x;
    this.place.textContent = x === null ? "" : this.panel.x.at.replace("{}", figure(x).replace(/\.0+$/, ""));
    const values = this.lines.map((line) => (x === null ? null : valueAt(line, x)));
    const text = this.panel.y.percent ? percent : figure;
    all("output", this.legend).forEach((output, number) => (output.textContent = x === null ? "" : text(values[number])));
    if (x === null) return void (this.cursor.innerHTML = "");
    const at = this.toX(x).toFixed(1);
    const dots = this.lines.map((line, number) => (values[number] === null ? "" : `<circle r="3.5" cx="${at}" cy="${this.toY(values[number]).toFixed(1)}" style="--line-colour:${line.colour}"/>`));
    this.cursor.innerHTML = `<line x1="${at}" x2="${at}" y1="${MARGIN.top}" y2="${this.height - MARGIN.bottom}"/>${dots.join("")}`;
  }

  stressOn(item, number) {
    const paths = all(".line", this.plot);
    item.addEventListener("pointerenter", () => paths.forEach((path, other) => path.classList.toggle("faint", other !== number)));
    item.addEventListener("pointerleave", () => paths.forEach((path) => path.classList.remove("faint")));
  }
}

/** The line's value at its point nearest to `x`, null beyond its ends. */
function valueAt(line, x) {
  if (x < line.x[0] || x > line.x.at(-1)) return null;
  const near = line.x.reduce((best, each, number) => (Math.abs(each - x) < Math.abs(line.x[best] - x) ? number : best), 0);
  return line.y[near];
}

const swatch = (line) =>
  `<svg class="swatch" viewBox="0 0 22 8" aria-hidden="true"><path class="line${line.dashed ? " dashed" : ""}${line.wide ? " broad" : ""}" style="--line-colour:${line.colour}" d="M0 4H22"/></svg>`;
