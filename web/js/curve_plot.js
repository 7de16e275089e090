// A curve over the bins' positions as SVG, with points to drag.
import { angleAt, kBins, positionOf } from './curve_points.js';

const kSpace = 'http://www.w3.org/2000/svg';
const kWidth = 400;
const kHeight = 240;
const kBox = { left: 46, right: kWidth - 12, top: 12, bottom: kHeight - 40 };
const kColours = ['red', 'green', 'blue'];
const kTicks = { half_angle: [0, 1, 5, 10, 20, 40, 60, 90], difference_angle: [0, 15, 30, 45, 60, 75, 90] };
export const kDecades = 5; // of the logarithmic scale

function made(name, attributes, parent) {
  const element = document.createElementNS(kSpace, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent?.append(element);
  return element;
}

/** Three digits, without an exponent where it can be read so. */
export function numberText(value) {
  if (value === 0) return '0';
  const isPlain = Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5;
  return isPlain ? String(Number(value.toPrecision(3))) : value.toExponential(1).replace('.0', '');
}

export function angleText(axis, position) {
  const degrees = (angleAt(axis, position) * 180) / Math.PI;
  return `${degrees.toFixed(degrees < 10 ? 2 : 1)}°`;
}

/** The least of 1, 2 and 5 times a power of ten that holds a value. */
export function roundTop(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 2, 5].find((step) => step * power >= value * (1 - 1e-9)) ?? 10);
}

/** A value's share of the height, 0 … 1, and back; `top` is what the plot ends at. */
export function shareOf(scale, top, value) {
  if (scale === 'linear') return Math.min(1, value / top);
  return value > 0 ? Math.min(1, Math.max(0, 1 + Math.log10(value / top) / kDecades)) : 0;
}
export function valueAt(scale, top, share) {
  const within = Math.min(1, Math.max(0, share));
  if (scale === 'linear') return top * within;
  return within > 0 ? top * 10 ** (kDecades * (within - 1)) : 0;
}

/**
 * Draws, and says what is done to it: onGrab(index), onMove(index, position, value), onDrop(),
 * onAdd(position, value), onAddAfter(index), onRemove(index), onNudge(index, right, up, isLarge).
 */
export class CurvePlot {
  #svg;
  #actions;
  #grid;
  #compare;
  #lines;
  #handles;
  #view = { axis: 'half_angle', scale: 'linear', top: 1, points: [] };
  #grabbed = null; // {pointer, index}

  constructor(svg, actions) {
    this.#svg = svg;
    this.#actions = actions;
    svg.setAttribute('viewBox', `0 0 ${kWidth} ${kHeight}`);
    this.#grid = made('g', { class: 'curve-grid' }, svg);
    this.#compare = kColours.map((colour) => made('path', { class: `curve-compare ${colour}` }, svg));
    this.#lines = kColours.map((colour) => made('path', { class: `curve-line ${colour}` }, svg));
    this.#handles = made('g', { class: 'curve-points' }, svg);
    svg.addEventListener('pointerdown', (event) => this.#down(event));
    svg.addEventListener('pointermove', (event) => this.#move(event));
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      svg.addEventListener(type, (event) => this.#up(event));
    }
    svg.addEventListener('dblclick', (event) => this.#double(event));
    svg.addEventListener('keydown', (event) => this.#key(event));
    svg.addEventListener('keyup', (event) => {
      if (this.#indexOf(event.target) >= 0) actions.onDrop();
    });
  }

  get isGrabbed() {
    return this.#grabbed !== null;
  }

  /** view: {axis, scale, top, bins, compare (bins or null), points [[position, value, text]], isDrawn}. */
  show(view) {
    this.#view = view;
    this.#drawGrid();
    this.#drawBins(this.#lines, view.bins);
    this.#drawBins(this.#compare, view.compare);
    this.#drawPoints();
  }

  focusPoint(index) {
    const handles = [...this.#handles.children];
    handles[Math.min(index, handles.length - 1)]?.focus();
  }

  #x(position) {
    return kBox.left + position * (kBox.right - kBox.left);
  }
  #y(value) {
    const { scale, top } = this.#view;
    return kBox.bottom - shareOf(scale, top, value) * (kBox.bottom - kBox.top);
  }

  #drawGrid() {
    const { axis, scale, top } = this.#view;
    const key = `${axis} ${scale} ${top}`;
    if (this.#grid.dataset.key === key) return;
    this.#grid.dataset.key = key;
    this.#grid.replaceChildren();
    for (const degrees of kTicks[axis]) {
      const x = this.#x(positionOf(axis, (degrees * Math.PI) / 180));
      made('line', { x1: x, x2: x, y1: kBox.top, y2: kBox.bottom }, this.#grid);
      made('text', { x, y: kBox.bottom + 16, 'text-anchor': 'middle' }, this.#grid).textContent = `${degrees}°`;
    }
    for (let i = 0; i <= kDecades; ++i) {
      const value = scale === 'linear' ? (top * i) / kDecades : top * 10 ** (i - kDecades);
      const y = kBox.bottom - (i / kDecades) * (kBox.bottom - kBox.top);
      made('line', { x1: kBox.left, x2: kBox.right, y1: y, y2: y }, this.#grid);
      made('text', { x: kBox.left - 6, y: y + 4, 'text-anchor': 'end' }, this.#grid).textContent = numberText(value);
    }
    made('text', { x: (kBox.left + kBox.right) / 2, y: kHeight - 6, 'text-anchor': 'middle' }, this.#grid)
      .textContent = axis === 'half_angle' ? 'θh, half angle' : 'θd, difference angle';
  }

  #drawBins(paths, bins) {
    const isGrey = bins?.every(([r, g, b]) => r === g && g === b);
    paths.forEach((path, c) => {
      path.classList.toggle('grey', Boolean(isGrey));
      const places = bins?.map((value, i) =>
        `${this.#x((i + 0.5) / kBins).toFixed(2)} ${this.#y(value[c]).toFixed(2)}`);
      path.setAttribute('d', places && !(isGrey && c > 0) ? `M${places.join('L')}` : '');
    });
  }

  /** The same elements as long as they can be: one of them may have the focus. */
  #drawPoints() {
    const { points, isDrawn, axis } = this.#view;
    while (this.#handles.children.length > points.length) this.#handles.lastChild.remove();
    while (this.#handles.children.length < points.length) {
      made('circle', { r: 6, tabindex: 0, role: 'slider', 'aria-valuemin': 0 }, this.#handles);
    }
    this.#handles.classList.toggle('ghost', !isDrawn);
    points.forEach(([position, value, colour], i) => {
      const handle = this.#handles.children[i];
      handle.setAttribute('cx', this.#x(position).toFixed(2));
      handle.setAttribute('cy', this.#y(value).toFixed(2));
      handle.setAttribute('aria-label', `Point ${i + 1} of ${points.length}`);
      handle.setAttribute('aria-valuemax', this.#view.top);
      handle.setAttribute('aria-valuenow', value);
      handle.setAttribute('aria-valuetext', `${angleText(axis, position)}, ${colour}`);
    });
  }

  #indexOf(target) {
    return [...this.#handles.children].indexOf(target);
  }

  /** Where a pointer is: {position, value}. */
  #at(event) {
    const place = new DOMPoint(event.clientX, event.clientY)
      .matrixTransform(this.#svg.getScreenCTM().inverse());
    const position = (place.x - kBox.left) / (kBox.right - kBox.left);
    const share = (kBox.bottom - place.y) / (kBox.bottom - kBox.top);
    const { scale, top } = this.#view;
    return { position: Math.min(1, Math.max(0, position)), value: valueAt(scale, top, share) };
  }

  /** The point nearest to a pointer, if it is near: a finger need not hit it. */
  #near(event) {
    const reach = event.pointerType === 'touch' ? 24 : 10;
    let [nearest, index] = [reach, -1];
    [...this.#handles.children].forEach((handle, i) => {
      const box = handle.getBoundingClientRect();
      const distance = Math.hypot(event.clientX - box.x - box.width / 2, event.clientY - box.y - box.height / 2);
      if (distance < nearest) [nearest, index] = [distance, i];
    });
    return index;
  }

  #down(event) {
    const index = this.#near(event);
    if (event.button !== 0 || index < 0 || this.#grabbed) return;
    event.preventDefault();
    this.#handles.children[index].focus();
    this.#svg.setPointerCapture(event.pointerId);
    this.#grabbed = { pointer: event.pointerId, index, x: event.clientX, y: event.clientY, moved: false };
    this.#actions.onGrab(index);
  }

  #move(event) {
    const grabbed = this.#grabbed;
    if (grabbed?.pointer !== event.pointerId) return;
    // A click or its double is no drag, however unsteady.
    grabbed.moved ||= Math.hypot(event.clientX - grabbed.x, event.clientY - grabbed.y) > 3;
    if (!grabbed.moved) return;
    const { position, value } = this.#at(event);
    this.#actions.onMove(grabbed.index, position, value);
  }

  #up(event) {
    if (this.#grabbed?.pointer !== event.pointerId) return;
    this.#grabbed = null;
    this.#actions.onDrop();
  }

  #double(event) {
    const index = this.#near(event);
    if (index >= 0) {
      this.#actions.onRemove(index);
    } else {
      const { position, value } = this.#at(event);
      this.#actions.onAdd(position, value);
    }
  }

  #key(event) {
    const index = this.#indexOf(event.target);
    if (index < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (event.key in steps) {
      this.#actions.onNudge(index, ...steps[event.key], event.shiftKey);
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      this.#actions.onRemove(index);
    } else if (event.key === 'Insert' || event.key === 'Enter') {
      this.#actions.onAddAfter(index);
    } else {
      return;
    }
    event.preventDefault();
  }
}
