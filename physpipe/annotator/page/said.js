// What was said about a clip: a value that never changes once it is shown.

export const keyOf = (object, frame) => `${object}:${frame}`;
export const middle = (box) => ({ x: box.x + (box.w - 1) / 2, y: box.y + (box.h - 1) / 2 });

export class Said {
  // Maps from "object:frame" to {x, y, w, h} (left, top, width, height) and {x, y, visible, interpolated}, clip pixels.
  constructor(boxes = new Map(), corrections = new Map()) {
    Object.assign(this, { boxes, corrections });
  }

  static fromRows({ boxes, corrections }) {
    const mapped = (rows) => new Map(rows.map(({ object, frame, ...row }) => [keyOf(object, frame), row]));
    return new Said(mapped(boxes), mapped(corrections));
  }

  toRows() {
    const rows = (map) =>
      [...map].map(([key, row]) => {
        const [object, frame] = key.split(":").map(Number);
        return { object, frame, ...row };
      });
    return { boxes: rows(this.boxes), corrections: rows(this.corrections) };
  }

  copy() {
    return new Said(new Map(this.boxes), new Map(this.corrections));
  }

  objects() {
    const keys = [...this.boxes.keys(), ...this.corrections.keys()];
    return keys.reduce((most, key) => Math.max(most, Number(key.split(":")[0]) + 1), 0);
  }
}

export const sameSaid = (one, two) => {
  const plain = (map) =>
    [...map].sort(([a], [b]) => (a < b ? -1 : 1)).map(([key, row]) => [key, Object.entries(row).sort()]);
  return (
    JSON.stringify([plain(one.boxes), plain(one.corrections)]) ===
    JSON.stringify([plain(two.boxes), plain(two.corrections)])
  );
};
