const kWheelPauseMs = 400;

/**
 * Names what the user's hand is doing, so that a drag is undone as one: from a press of a pointer or a key to the
 * next is one gesture; so is a turn of the wheel without a pause.
 */
export class Gestures {
  #name = 0;
  #down = new Set(); // pointers
  #wheeled = -Infinity; // when, while nothing else came
  #prefix = Math.random().toString(36).slice(2, 8); // of this page: an older one's are over

  constructor(target) {
    const listen = (type, act) => target.addEventListener(type, act, { capture: true, passive: true });
    listen('pointerdown', ({ pointerId }) => {
      if (this.#down.size === 0 || this.#down.has(pointerId)) this.#next(); // it may have gone up elsewhere
      this.#down.add(pointerId);
    });
    for (const type of ['pointerup', 'pointercancel']) {
      listen(type, ({ pointerId }) => this.#down.delete(pointerId));
    }
    // After those who hear it: a value that was set by other means than keys and pointers.
    for (const type of ['change', 'click']) target.addEventListener(type, () => this.#next());
    listen('keydown', ({ repeat }) => { if (!repeat) this.#next(); });
    listen('wheel', ({ timeStamp }) => {
      if (timeStamp - this.#wheeled > kWheelPauseMs) this.#next();
      this.#wheeled = timeStamp;
    });
  }

  get current() {
    return `${this.#prefix} ${this.#name}`;
  }

  #next() {
    this.#name += 1;
    this.#wheeled = -Infinity;
  }
}
