import { axisAngle, between, cross, multiply, normalized } from './quaternion.js';

const kKeyDegrees = 4;
const kFineKeyDegrees = 0.5;

/** The camera's axes in the world: right, up, and back towards the viewer. */
export function cameraAxes(camera) {
  const back = normalized(camera.position.map((p, i) => p - camera.target[i]));
  const right = normalized(cross(camera.up, back));
  return { right, up: cross(back, right), back };
}

/**
 * A point of the picture, in units of half its shorter side from its middle, on a sphere around
 * the scene that bends smoothly into a hyperbola outside (Bell; see Henriksen et al. 2004,
 * "Virtual trackballs revisited").
 */
export function spherePoint(x, y) {
  const d2 = x * x + y * y;
  const z = d2 <= 0.5 ? Math.sqrt(1 - d2) : 0.5 / Math.sqrt(d2);
  return normalized([x, y, z]);
}

/** A turn given in the camera's axes, in the world's. */
function toWorld(q, axes) {
  const [x, y, z, w] = q;
  const world = [0, 1, 2].map((i) => axes.right[i] * x + axes.up[i] * y + axes.back[i] * z);
  return [...world, w];
}

/**
 * Turns drags and arrow keys on an element into rotations of the light, as if one grabbed the
 * sphere of light around the scene. Calls onTurn(rotation), and onGrab(true or false). Presses that
 * isTaken(event) says are another's are left alone.
 */
export class Trackball {
  #element;
  #axes = { right: [1, 0, 0], up: [0, 1, 0], back: [0, 0, 1] };
  #rotation = [0, 0, 0, 1];
  #grab = null; // {pointer, point, rotation}
  #onTurn;
  #onGrab;
  #isTaken;

  constructor(element, { onTurn, onGrab, isTaken = () => false }) {
    this.#isTaken = isTaken;
    this.#element = element;
    this.#onTurn = onTurn;
    this.#onGrab = onGrab;
    element.addEventListener('pointerdown', (event) => this.#start(event));
    element.addEventListener('pointermove', (event) => this.#move(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      element.addEventListener(end, (event) => this.#end(event));
    }
    element.addEventListener('keydown', (event) => this.#key(event));
  }

  get isDragging() {
    return this.#grab !== null;
  }

  setCamera(camera) {
    this.#axes = cameraAxes(camera);
  }

  /** The light's rotation now: what the next turn starts from. A drag goes on from its own. */
  setRotation(rotation) {
    this.#rotation = rotation;
  }

  #point(event) {
    const box = this.#element.getBoundingClientRect();
    const half = Math.min(box.width, box.height) / 2;
    return spherePoint((event.clientX - box.left - box.width / 2) / half,
      (box.top + box.height / 2 - event.clientY) / half);
  }

  #start(event) {
    if (this.#grab || event.button !== 0 || this.#isTaken(event)) return;
    this.#element.setPointerCapture(event.pointerId);
    this.#grab = { pointer: event.pointerId, point: this.#point(event), rotation: this.#rotation };
    this.#onGrab(true);
  }

  #move(event) {
    if (this.#grab?.pointer !== event.pointerId) return;
    const turn = toWorld(between(this.#grab.point, this.#point(event)), this.#axes);
    this.#turn(multiply(turn, this.#grab.rotation));
  }

  #end(event) {
    if (this.#grab?.pointer !== event.pointerId) return;
    this.#grab = null;
    this.#onGrab(false);
  }

  #key(event) {
    const degrees = event.shiftKey ? kFineKeyDegrees : kKeyDegrees;
    const turns = {
      ArrowLeft: [this.#axes.up, -degrees],
      ArrowRight: [this.#axes.up, degrees],
      ArrowUp: [this.#axes.right, -degrees],
      ArrowDown: [this.#axes.right, degrees],
    };
    if (event.key === 'Home') {
      this.#turn([0, 0, 0, 1]);
    } else if (event.key in turns) {
      const [axis, angle] = turns[event.key];
      this.#turn(multiply(axisAngle(axis, (angle * Math.PI) / 180), this.#rotation));
    } else {
      return;
    }
    event.preventDefault();
  }

  #turn(rotation) {
    this.#rotation = normalized(rotation);
    this.#onTurn(this.#rotation);
  }
}
