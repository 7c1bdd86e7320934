// The film of a data set: which frame of which scene is shown, and playing on from there at the film's own times.

const SPEEDS = [2, 1, 1 / 2, 1 / 4, 1 / 8, 1 / 16];

class Player {
  constructor(element, film) {
    Object.assign(this, { element, film, number: 0, playing: false, predictor: film.predictors[0], layers: new Set(Object.keys(LAYERS)) });
    this.canvas = element.querySelector("canvas");
    this.strips = film.scenes.map((scene) => new Strip(scene.strip));
    this.speed = SPEEDS.find((speed) => speed <= 1 && speed * film.fps <= film.fps_at_first * 1.001) ?? SPEEDS.at(-1);
    this.changed = () => {}; // called whenever what is shown, or how, is another
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  get scene() {
    return this.film.scenes[this.index];
  }

  /** The chosen predictor's forecast of the scene, if there is one. */
  get forecast() {
    return this.scene.forecasts[this.predictor] ?? null;
  }

  /** Shows a frame, by its number in the scene, of scene `index`. */
  async open(index, number = 0) {
    if (index !== this.index) {
      this.strips[this.index]?.drop();
      this.index = index;
      const [width, height] = this.scene.size;
      this.canvas.style.aspectRatio = `${width} / ${height}`;
      this.element.dataset.ready = "no";
    }
    this.show(number);
    await this.strips[index].load();
    if (index !== this.index) return; // another scene was opened meanwhile
    this.element.dataset.ready = "yes";
    this.draw();
  }

  /** Shows the frame of a clip that a link names; false where no scene has it. */
  seek(clip, frame) {
    const holds = (scene) => scene.clip === clip && frame >= scene.first && frame < scene.first + scene.times_s.length;
    const index = this.film.scenes.findIndex(holds);
    if (index < 0) return false;
    this.pause();
    this.open(index, frame - this.film.scenes[index].first);
    return true;
  }

  show(number) {
    this.number = clamp(number, 0, this.scene.times_s.length - 1);
    this.draw();
    this.changed();
  }

  step(frames) {
    this.pause();
    this.show(this.number + frames);
  }

  toggle(layer) {
    if (!this.layers.delete(layer)) this.layers.add(layer);
    this.draw();
    this.changed();
  }

  forecastOf(predictor) {
    this.predictor = predictor;
    this.draw();
    this.changed();
  }

  play() {
    this.playing = true;
    this.last = null;
    if (this.number === this.scene.times_s.length - 1) this.number = 0;
    this.time_s = this.scene.times_s[this.number];
    requestAnimationFrame((now) => this.advance(now));
    this.changed();
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.changed();
  }

  advance(now_ms) {
    if (!this.playing) return;
    this.time_s += this.last === null ? 0 : ((now_ms - this.last) / 1000) * this.speed;
    this.last = now_ms;
    const { times_s } = this.scene;
    const end_s = times_s.at(-1) + 1 / this.film.fps;
    if (this.time_s >= end_s) this.time_s = times_s[0]; // over again
    const number = times_s.findLastIndex((time_s) => time_s <= this.time_s + 1e-9);
    if (number !== this.number) this.show(number);
    requestAnimationFrame((later_ms) => this.advance(later_ms));
  }

  draw() {
    const strip = this.strips[this.index];
    const width = this.canvas.clientWidth;
    if (!strip?.images || !width) return;
    const [wide, high] = this.scene.size;
    const pixels = Math.round(width * (window.devicePixelRatio || 1));
    if (this.canvas.width !== pixels) this.canvas.width = pixels;
    const rows = Math.round((pixels * high) / wide);
    if (this.canvas.height !== rows) this.canvas.height = rows;
    const context = this.canvas.getContext("2d");
    strip.draw(context, this.number, this.scene.size);
    new Marks(context, this.scene, this.forecast).draw(this.number, this.layers);
  }
}
