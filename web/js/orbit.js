import { axisAngle, cross, dot, normalized, rotated } from './quaternion.js';

const kRadiansAcross = Math.PI; // a drag over the shorter side of the picture
const kKeyRadians = (4 * Math.PI) / 180;
const kFineKeyRadians = (0.5 * Math.PI) / 180;
const kNearestToPole = 0.02; // radians between the view and up
const kDollyStep = 1.1; // of one notch of the wheel, or a key
const kDollyRange = 50; // nearer and farther than the scene's own camera

function minus(a, b) {
  return a.map((x, i) => x - b[i]);
}

/** The camera turned about its target: `right` and `down` in radians, as if one pulled the scene. */
export function orbited(camera, right, down) {
  const up = normalized(camera.up);
  const offset = minus(camera.position, camera.target);
  const distance = Math.hypot(...offset);
  const polar = Math.acos(Math.min(1, Math.max(-1, dot(offset, up) / distance)));
  const least = kNearestToPole;
  const turned = Math.min(Math.PI - least, Math.max(least, polar - down));
  const side = normalized(cross(up, offset));
  const lifted = rotated(axisAngle(side, turned - polar), offset);
  const moved = rotated(axisAngle(up, -right), lifted);
  return { ...camera, position: camera.target.map((x, i) => x + moved[i]) };
}

/** The camera at `factor` times its distance, within what a start at `usual` distance allows. */
export function dollied(camera, factor, usual) {
  const offset = minus(camera.position, camera.target);
  const distance = Math.hypot(...offset);
  const wanted = Math.min(usual * kDollyRange, Math.max(usual / kDollyRange, distance * factor));
  return { ...camera,
    position: camera.target.map((x, i) => x + (offset[i] * wanted) / distance) };
}

/**
 * Turns drags, the wheel, two fingers and keys on an element into views of the scene: with the right
 * button or Alt always, with the left one and plain arrow keys while `leads()`. Calls onView(camera)
 * and onGrab(true or false).
 */
export class Orbit {
  #element;
  #leads;
  #onView;
  #onGrab;
  #camera = null;
  #home = null; // the scene's own
  #enabled = false;
  #pointers = new Map(); // id → {x, y}
  #grab = null; // {camera, x, y, spread}

  constructor(element, { leads, onView, onGrab }) {
    this.#element = element;
    this.#leads = leads;
    this.#onView = onView;
    this.#onGrab = onGrab;
    element.addEventListener('contextmenu', (event) => this.#enabled && event.preventDefault());
    element.addEventListener('pointerdown', (event) => this.#start(event));
    element.addEventListener('pointermove', (event) => this.#move(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      element.addEventListener(end, (event) => this.#end(event));
    }
    element.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    element.addEventListener('keydown', (event) => this.#key(event));
  }

  get isDragging() {
    return this.#grab !== null;
  }

  /** Whether the scene can be seen from elsewhere, and its own camera. */
  setHome(camera, enabled) {
    this.#home = camera;
    this.#enabled = enabled;
    this.#camera ??= camera;
  }

  /** The view now: what the next turn starts from. A drag goes on from its own. */
  setCamera(camera) {
    this.#camera = camera;
  }

  /** Whether a press belongs to the camera, not to the light. */
  takes(event) {
    if (!this.#enabled) return false;
    return event.button === 2 || (event.button === 0 && (event.altKey || this.#leads()));
  }

  /** One finger turns; the way between two of them is the distance. */
  #state() {
    const points = [...this.#pointers.values()];
    const mean = (key) => points.reduce((sum, p) => sum + p[key], 0) / points.length;
    const spread = points.length < 2 ? 0
      : Math.hypot(points[0].x - points[1].x, points[0].y - points[1].y);
    return { x: mean('x'), y: mean('y'), spread };
  }

  #regrab() {
    this.#grab = this.#pointers.size > 0 ? { camera: this.#camera, ...this.#state() } : null;
  }

  #start(event) {
    if (this.#pointers.size === 0 ? !this.takes(event) : this.#pointers.size >= 2) return;
    event.preventDefault();
    this.#element.focus({ preventScroll: true });
    this.#element.setPointerCapture(event.pointerId);
    const first = this.#pointers.size === 0;
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.#regrab();
    if (first) this.#onGrab(true);
  }

  #move(event) {
    if (!this.#pointers.has(event.pointerId)) return;
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const box = this.#element.getBoundingClientRect();
    const scale = kRadiansAcross / Math.min(box.width, box.height);
    const now = this.#state();
    const { camera, x, y, spread } = this.#grab;
    let view = orbited(camera, (now.x - x) * scale, (now.y - y) * scale);
    if (spread > 0 && now.spread > 0) view = dollied(view, spread / now.spread, this.#usual());
    this.#show(view);
  }

  #end(event) {
    if (!this.#pointers.delete(event.pointerId)) return;
    this.#regrab();
    if (!this.#grab) this.#onGrab(false);
  }

  #wheel(event) {
    if (!this.#enabled) return;
    event.preventDefault();
    const notches = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
    this.#show(dollied(this.#camera, kDollyStep ** notches, this.#usual()));
    if (this.#grab) this.#regrab();
  }

  #key(event) {
    if (!this.#enabled) return;
    const step = event.shiftKey ? kFineKeyRadians : kKeyRadians;
    const turns = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const dollies = { '+': 1 / kDollyStep, '=': 1 / kDollyStep, '-': kDollyStep };
    const turnsView = this.#leads() || event.altKey;
    if (event.key in dollies && !event.ctrlKey && !event.metaKey) {
      this.#show(dollied(this.#camera, dollies[event.key], this.#usual()));
    } else if (turnsView && event.key in turns) {
      this.#show(orbited(this.#camera, ...turns[event.key]));
    } else if (turnsView && event.key === 'Home') {
      this.#camera = this.#home;
      this.#onView(null);
    } else {
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation(); // the light stays
  }

  #usual() {
    return Math.hypot(...minus(this.#home.position, this.#home.target));
  }

  #show(camera) {
    this.#camera = camera;
    this.#onView(camera);
  }
}
