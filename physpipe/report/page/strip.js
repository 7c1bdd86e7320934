// A clip's frames: a few pictures of many frames each, decoded when the clip is looked at and dropped afterwards.

class Strip {
  constructor({ cell, columns, each, pictures }) {
    Object.assign(this, { cell, columns, each, pictures, decoded: null });
  }

  async load() {
    this.decoded ??= Promise.all(this.pictures.map(decodedPicture));
    this.images = await this.decoded;
  }

  drop() {
    this.decoded = this.images = null;
  }

  /** Draws frame `number`, of `size` pixels, over the whole canvas. */
  draw(context, number, [width, height]) {
    const image = this.images[Math.floor(number / this.each)];
    const cell = number % this.each;
    const left = (cell % this.columns) * this.cell[0];
    const top = Math.floor(cell / this.columns) * this.cell[1];
    context.imageSmoothingQuality = "high";
    context.drawImage(image, left, top, width, height, 0, 0, context.canvas.width, context.canvas.height);
  }
}

async function decodedPicture(address) {
  const image = new Image();
  image.src = address;
  await image.decode();
  return image;
}
