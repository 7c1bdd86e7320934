// Truth, track and forecast drawn over a frame; each is a layer that can be left out.

const LAYERS = { truth: "truth", track: "track", trail: "trail", forecast: "forecast", ellipse: "90 % ellipse" };
const SIZES = { picture: 384, ring: 13, dot: 5, line: 2, dash: 7 }; // of marks, on a picture that wide

/** Layers that `scene` has anything for. */
function layersOf(scene) {
  const something = (key) => scene[key].some((row) => row.some((each) => each !== null));
  return Object.keys(LAYERS).filter((layer) => something(layer === "trail" ? "track" : layer));
}

class Marks {
  constructor(context, scene) {
    Object.assign(this, { context, scene });
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
    if (layers.has("ellipse")) objects.forEach((object) => this.ellipse(scene.forecast[number][object], scene.ellipse[number][object]));
    if (layers.has("truth")) scene.truth[number].forEach((spot) => this.ring(spot));
    if (layers.has("track")) scene.track[number].forEach((spot, object) => this.dot(spot, colour(object)));
  }

  trail(object, number) {
    return this.scene.track.slice(Math.max(0, number - data.trail), number + 1).map((row) => row[object]);
  }

  forecast(object, number) {
    const { forecast, track, seen, first } = this.scene;
    if (seen === null) return;
    const start = track[seen - first]?.[object] ?? null;
    const path = forecast.slice(0, number + 1).map((row) => row[object]).filter(Boolean);
    if (path.length === 0) return;
    this.line(start ? [start, ...path] : path, data.colours.forecast, SIZES.dash);
    this.dot(forecast[number][object], data.colours.forecast);
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

  ellipse(spot, ellipse) {
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
