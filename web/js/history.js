import { mergedMaterials } from './edits.js';

const kMostSteps = 200;

/** What was done, to take it back: steps {undo, redo}, both changes of materials. */
export class History {
  #done = [];
  #undone = [];
  #open = null; // the key of what the last step is still part of

  get canUndo() {
    return this.#done.length > 0;
  }
  get canRedo() {
    return this.#undone.length > 0;
  }

  /** A step of the same key as the last is part of it, until seal(): a drag is one. */
  record(undo, redo, key = null) {
    this.#undone = [];
    const last = this.#done.at(-1);
    const both = key !== null && key === this.#open && last && mergedMaterials(last.redo, redo);
    if (both) {
      last.redo = both;
      last.undo = mergedMaterials(undo, last.undo) ?? last.undo; // what was first
    } else {
      this.#done.push({ undo, redo });
      if (this.#done.length > kMostSteps) this.#done.shift();
    }
    this.#open = key;
  }

  seal() {
    this.#open = null;
  }

  /** The change that takes the last step back; null when there is none. */
  undo() {
    return this.#move(this.#done, this.#undone)?.undo ?? null;
  }
  redo() {
    return this.#move(this.#undone, this.#done)?.redo ?? null;
  }

  clear() {
    this.#done = [];
    this.#undone = [];
    this.#open = null;
  }

  #move(from, to) {
    this.#open = null;
    const step = from.pop();
    if (step) to.push(step);
    return step;
  }
}
