// Truth, track and forecast drawn over a frame; each is a layer that can be left out.

const LAYERS = { truth: "truth", track: "track", trail: "trail", forecast: "forecast", ellipse: "90 % ellipse" };
const SIZES = { picture: 384, ring: 13, dot: 5, line: 2, dash: 7 }; // of marks, on a picture that wide

/** Layers that `scene` has anything for. */
function layersOf(scene) {
  const something = (rows) => rows.some((row) => row.some((each) => each !== null));
  const forecasts = Object.values(scene.forecasts);
  const has = {
    truth: something(scene.truth),
    track: something(scene.track),
    trail: something(scene.track),
    forecast: forecasts.some(({ xy }) => something(xy)),
    ellipse: forecasts.some(({ ellipse }) => ellipse && something(ellipse)),
  };
  return Object.keys(LAYERS).filter((layer) => has[layer]);
}

class Marks {
  /** `forecast` is one of the scene's, if any. */
  constructor(context, scene, forecast) {
    Object.assign(this, { context, scene, coming: forecast });
    this.zoom = context.canvas.width / scene.size[0];
    this.unit = context.canvas.width / SIZES.picture;
  }

  /** Draws `layers` (a Set) of frame `number` of the scene. */
  draw(number, layers) {
    const { scene } = this;
    const objects = scene.track[number].map((_, object) => object);
    const colour = (object) => data.colours.objects[object % data.colours.objects.length];
    if (layers.has("trail")) objects.forEach((object) => this.line(this.trail(object, number), colour(object)));
    if (layers.has("forecast")) objects.forEach((object) => this.forecast(object, number));
    if (layers.has("ellipse")) objects.forEach((object) => this.ellipse(object, number));
    if (layers.has("truth")) scene.truth[number].forEach((spot) => this.ring(spot));
    if (layers.has("track")) scene.track[number].forEach((spot, object) => this.dot(spot, colour(object)));
  }

  trail(object, number) {
    return this.scene.track.slice(Math.max(0, number - data.trail), number + 1).map((row) => row[object]);
  }

  forecast(object, number) {
    if (!this.coming || number < this.coming.start) return;
    const { xy, seen, start } = this.coming;
    const last = this.scene.track[seen - this.scene.first]?.[object] ?? null;
    const path = xy.slice(0, number - start + 1).map((row) => row[object]).filter(Boolean);
    this.line(last ? [last, ...path] : path, data.colours.forecast, SIZES.dash);
    this.dot(xy[number - start][object], data.colours.forecast);
  }

  // Clip pixels count from the middle of the top-left one, the canvas from its corner.
  place([x, y]) {
    return [(x + 0.5) * this.zoom, (y + 0.5) * this.zoom];
  }

  line(path, colour, dash = 0) {
    this.stroke(colour, SIZES.line, () => {
      let pen = "moveTo";
      for (const spot of path) {
        if (spot) this.context[pen](...this.place(spot));
        pen = spot ? "lineTo" : "moveTo";
      }
    }, dash);
  }

  ellipse(object, number) {
    const row = number - (this.coming?.start ?? Infinity);
    const [spot, ellipse] = [this.coming?.xy[row]?.[object], this.coming?.ellipse?.[row]?.[object]];
    if (!spot || !ellipse) return;
    const [long, short, angle] = ellipse;
    const outline = () => this.context.ellipse(...this.place(spot), long * this.zoom, short * this.zoom, angle, 0, 2 * Math.PI);
    this.stroke("#000", SIZES.line, outline);
    this.stroke(data.colours.forecast, SIZES.line * 0.7, outline);
  }

  ring(spot) {
    if (!spot) return;
    const outline = () => this.context.arc(...this.place(spot), SIZES.ring * this.unit, 0, 2 * Math.PI);
    this.stroke("#000", 2 * SIZES.line, outline);
    this.stroke(data.colours.truth, SIZES.line, outline);
  }

  dot(spot, colour) {
    if (!spot) return;
    for (const [radius, fill] of [[SIZES.dot + 1.5, "#000"], [SIZES.dot, colour]]) {
      this.context.beginPath();
      this.context.arc(...this.place(spot), radius * this.unit, 0, 2 * Math.PI);
      this.context.fillStyle = fill;
      this.context.fill();
    }
  }

  stroke(colour, width, outline, dash = 0) {
    const { context, unit } = this;
    context.beginPath();
    outline();
    context.setLineDash([dash * unit, dash * unit].filter(Boolean));
    Object.assign(context, { strokeStyle: colour, lineWidth: width * unit, lineJoin: "round" });
    context.stroke();
    context.setLineDash([]);
  }
}
