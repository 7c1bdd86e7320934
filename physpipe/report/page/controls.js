// Everything around the picture: buttons, keys, the scrubber with the tracker's score above it, and what is said.

const speedText = (speed) => (speed >= 1 ? `${speed} ×` : `1/${1 / speed} ×`);

class Controls {
  constructor(player) {
    this.player = player;
    const { element, film } = player;
    for (const name of ["scrub", "speed", "clip", "predictor", "now", "scores", "layers"]) this[name] = element.querySelector(`.${name}`);
    this.speed.innerHTML = SPEEDS.map((each) => `<option value="${each}">${speedText(each)}</option>`).join("");
    this.clip.innerHTML = film.scenes.map((scene, index) => `<option value="${index}">${escaped(titleOf(scene))}</option>`).join("");
    this.predictor.innerHTML = film.predictors.map((name) => `<option value="${escaped(name)}">${escaped(name.replaceAll("_", " "))}</option>`).join("");
    this.predictor.addEventListener("change", () => player.forecastOf(this.predictor.value));
    this.speed.addEventListener("change", () => (player.speed = Number(this.speed.value)));
    this.clip.addEventListener("change", () => this.pick(Number(this.clip.value)));
    this.scrub.addEventListener("input", () => player.step(Number(this.scrub.value) - player.number));
    player.canvas.addEventListener("click", () => this.do("play"));
    all("[data-do]", element).forEach((button) => button.addEventListener("click", () => this.do(button.dataset.do)));
    element.addEventListener("keydown", (event) => this.press(event));
    player.changed = () => this.tell();
    this.offer(film.scenes);
  }

  /** A check box for every layer that some scene has. */
  offer(scenes) {
    const known = new Set(scenes.flatMap(layersOf));
    this.known = Object.keys(LAYERS).filter((layer) => known.has(layer));
    for (const [number, layer] of this.known.entries()) {
      const box = made(`<label><input type="checkbox" name="${layer}" checked> ${LAYERS[layer]} <kbd>${number + 1}</kbd></label>`);
      box.firstElementChild.addEventListener("change", () => this.player.toggle(layer));
      this.layers.append(box);
    }
  }

  do(what) {
    const { player } = this;
    if (what === "back") player.step(-1);
    else if (what === "on") player.step(1);
    else if (player.playing) player.pause();
    else player.play();
  }

  pick(index) {
    this.player.pause();
    this.player.open(clamp(index, 0, this.player.film.scenes.length - 1));
  }

  nextPredictor() {
    const { film, predictor } = this.player;
    this.player.forecastOf(film.predictors[(film.predictors.indexOf(predictor) + 1) % film.predictors.length]);
  }

  faster(steps) {
    this.player.speed = SPEEDS[clamp(SPEEDS.indexOf(this.player.speed) - steps, 0, SPEEDS.length - 1)];
    this.tell();
  }

  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const { player } = this;
    const own = event.target;
    const presses = event.key === " " && own.matches("button, [type=checkbox], select");
    const chooses = own.matches("select") && event.key !== "Escape";
    if (presses || chooses) return; // the element's own keys
    const step = event.shiftKey ? 10 : 1;
    const acts = {
      " ": () => this.do("play"),
      ArrowLeft: () => player.step(-step),
      ArrowRight: () => player.step(step),
      Home: () => player.step(-Infinity),
      End: () => player.step(Infinity),
      ArrowUp: () => this.pick(player.index - 1),
      ArrowDown: () => this.pick(player.index + 1),
      "+": () => this.faster(1),
      "-": () => this.faster(-1),
      p: () => this.nextPredictor(),
    };
    const layer = this.known[Number(event.key) - 1];
    const act = acts[event.key] ?? (layer && (() => player.toggle(layer)));
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** Makes every control say what the player shows. */
  tell() {
    const { player } = this;
    const { scene, number } = player;
    this.scrub.max = scene.times_s.length - 1;
    this.scrub.value = number;
    this.speed.value = player.speed;
    this.clip.value = player.index;
    this.predictor.value = player.predictor;
    player.element.querySelector("[data-do=play]").textContent = player.playing ? "Pause" : "Play";
    Object.assign(player.element.dataset, { clip: scene.clip, frame: scene.first + number, playing: player.playing });
    for (const layer of this.known) this.layers.querySelector(`[name=${layer}]`).checked = player.layers.has(layer);
    this.now.setAttribute("aria-live", player.playing ? "off" : "polite");
    this.now.innerHTML = said(player).map((line) => `<span>${escaped(line)}</span>`).join("");
    const drawn = `${player.index} ${player.predictor}`;
    if (this.drawn !== drawn) this.scores.innerHTML = scoreCurve(scene, player.film.spans, player.forecast);
    this.drawn = drawn;
    this.scrub.setAttribute("aria-valuetext", `frame ${scene.first + number}`);
  }
}

function titleOf(scene) {
  const count = scene.times_s.length;
  const part = count < scene.total ? `, frames ${scene.first} to ${scene.first + count - 1} of ${scene.total}` : "";
  return `${scene.clip} (${scene.split}${part})`;
}

/** What there is to say of a frame: when it is, how far the marks are off, and what to doubt. */
function said({ scene, number, forecast, predictor, film }) {
  const frame = scene.first + number;
  const distances = (values) => `${values.map(figure).join(", ")} px`;
  const known = (values) => values.some((value) => value !== null);
  const lines = [`frame ${frame} of ${scene.total - 1}, ${scene.times_s[number].toFixed(3)} s`];
  if (known(scene.track_px[number])) lines.push(`track off by ${distances(scene.track_px[number])}`);
  const off = forecast?.off_px[number - forecast.start];
  if (!forecast) lines.push(`no forecast of ${predictor.replaceAll("_", " ")}`);
  else if (frame <= forecast.seen) lines.push("seen by the predictor");
  if (off && known(off)) lines.push(`forecast off by ${distances(off)} (T = ${film.horizon})`);
  [...scene.state[number]].forEach((state, object) => {
    if (state === "l") lines.push(`object ${object} lost`);
    if (state === "a") lines.push(`object ${object} perhaps mistaken for another`);
  });
  if (scene.faults[number]) lines.push(`frame ${scene.faults[number].replace("_", " ")}: the one before is shown`);
  return lines;
}

/** The lowest score of any object over the frames, doubtful spans shaded, a line where the forecast begins. */
function scoreCurve(scene, spans, forecast) {
  const width = Math.max(scene.times_s.length - 1, 1);
  const x = (frame) => clamp((frame - scene.first) / width, 0, 1).toFixed(4);
  const shades = spans
    .filter((span) => span.clip === scene.clip && span.last >= scene.first && span.first <= scene.first + width)
    .map((span) => `<rect x="${x(span.first)}" y="0" height="1" width="${(x(span.last) - x(span.first)).toFixed(4)}"/>`);
  const points = scene.score.map((row, number) => `${x(scene.first + number)},${(1 - 0.94 * Math.min(...row)).toFixed(3)}`);
  const begins = forecast && forecast.seen >= scene.first ? `<line x1="${x(forecast.seen)}" x2="${x(forecast.seen)}" y1="0" y2="1"/>` : "";
  return `${shades.join("")}${begins}<polyline points="${points.join(" ")}"/>`;
}
