const kSnap = 0.12; // a scale this little above a whole one becomes whole: pixels stay square

/** The largest size for an image in a box, both in device pixels. */
export function fittedSize(image, box) {
  let scale = Math.min(box.width / image.width, box.height / image.height);
  const whole = Math.floor(scale);
  if (whole >= 1 && scale - whole < kSnap) scale = whole;
  return { width: Math.max(1, Math.round(image.width * scale)),
    height: Math.max(1, Math.round(image.height * scale)) };
}

/** Draws frames on a canvas, one backing pixel for each of the image, scaled by the browser. */
export class Viewer {
  #canvas;
  #stage;
  #context;

  constructor(canvas, stage) {
    this.#canvas = canvas;
    this.#stage = stage;
    this.#context = canvas.getContext('2d', { alpha: false });
    new ResizeObserver(() => this.#fit()).observe(stage);
    this.#fit();
  }

  setSize({ width, height }) {
    if (this.#canvas.width === width && this.#canvas.height === height) return;
    this.#canvas.width = width;
    this.#canvas.height = height;
    this.#fit();
  }

  /** Draws a decoded frame; smaller ones are enlarged to the whole canvas. */
  draw(picture, header) {
    if (header.exact) this.setSize(header);
    this.#context.imageSmoothingQuality = 'high';
    this.#context.drawImage(picture, 0, 0, this.#canvas.width, this.#canvas.height);
  }

  #fit() {
    const ratio = devicePixelRatio || 1;
    const style = getComputedStyle(this.#stage);
    const box = {
      width: (this.#stage.clientWidth - parseFloat(style.paddingLeft) -
        parseFloat(style.paddingRight)) * ratio,
      height: this.#stage.clientHeight * ratio,
    };
    const size = fittedSize(this.#canvas, box);
    this.#canvas.style.width = `${size.width / ratio}px`;
    this.#canvas.style.height = `${size.height / ratio}px`;
    // Enlarged by whole numbers, pixels show as they are; else the browser interpolates.
    const scale = size.width / this.#canvas.width;
    this.#canvas.style.imageRendering = scale === 1 ? 'pixelated' : 'auto';
  }
}
