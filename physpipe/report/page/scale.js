// From values to places along an axis, and the values that deserve a tick.

const TRANSFORMS = {
  linear: (value) => value,
  log: (value) => Math.log10(value),
  symlog: (value) => (Math.abs(value) <= 1 ? value : Math.sign(value) * (1 + Math.log10(Math.abs(value)))), // linear to 1
};

/** Maps `low` to place `from` and `high` to place `to`. */
function scaleOf(kind, low, high, from, to) {
  const transform = TRANSFORMS[kind];
  const [start, end] = [transform(low), transform(high)];
  const stretch = end > start ? (to - from) / (end - start) : 0;
  return (value) => from + (transform(value) - start) * stretch;
}

/** Values from `low` to `high`, about `count` of them, that are easy to read. */
function ticksOf(kind, low, high, count) {
  if (kind === "linear" || high / Math.max(low, 1e-9) < 5) return roundTicks(low, high, count);
  const start = kind === "symlog" ? Math.max(low, 1) : low;
  for (const steps of [[1, 2, 5], [1, 3], [1]]) {
    const found = decades(start, high).flatMap((decade) => steps.map((step) => step * decade));
    const inside = found.filter((value) => value >= start * 0.999 && value <= high * 1.001);
    const whole = kind === "symlog" && low <= 0 ? [0, ...inside] : inside;
    if (whole.length <= count + 2) return whole;
  }
  return decades(start, high).filter((value, number) => number % 2 === 0 && value <= high);
}

function decades(low, high) {
  const first = Math.floor(Math.log10(low));
  return Array.from({ length: Math.ceil(Math.log10(high)) - first + 1 }, (_, number) => 10 ** (first + number));
}

function roundTicks(low, high, count) {
  const rough = (high - low) / count || 1;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((part) => part * decade).find((each) => each >= rough);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, number) => (first + number) * step);
}

/** As short as the value allows: 0.05, 12, 3000. */
const tickText = (value) => (value === 0 ? "0" : String(Number(value.toPrecision(3))));
