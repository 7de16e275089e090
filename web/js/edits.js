const kMostUnacknowledged = 3;
const kRemembered = 256;

/** Two edits of materials as one; null when they must go one after the other. */
export function mergedMaterials(first, second) {
  const [parameter, curve, load] = ['parameter', 'curve', 'load'].map((part) => ({ ...first[part] }));
  for (const [name, change] of Object.entries(second.parameter ?? {})) {
    if (parameter[name] === null && change !== null) return null; // taken back, then set
    parameter[name] = change && { ...parameter[name], ...change };
    // The exponent came last: together with a lobe it would not be shown.
    if (change && 'exponent' in change && !('lobe' in change)) delete parameter[name].lobe;
    if (change !== null) continue;
    delete curve[name]; // all that came before is taken back
    delete load[name];
  }
  for (const [name, change] of Object.entries(second.curve ?? {})) {
    curve[name] = { ...curve[name], ...change };
  }
  Object.assign(load, second.load);
  const parts = { parameter, curve, load };
  return Object.fromEntries(Object.entries(parts).filter(([, part]) => Object.keys(part).length > 0));
}

/** Two edits as one; null when they must go one after the other. */
export function merged(first, second) {
  const result = { ...first, ...second };
  if (!first.material || !second.material) return result;
  const material = mergedMaterials(first.material, second.material);
  return material && { ...result, material };
}

/**
 * Sends edits: at most one an animation frame, what comes in between merged, and none while a few
 * wait for their acks. Remembers when each was sent, so that a frame's latency can be told.
 */
export class Edits {
  #send;
  #pending = []; // each to be sent as one
  #scheduled = false;
  #counter = 0;
  #sent = new Map(); // id → time sent, until acknowledged
  #shown = []; // [{revision, time}], acknowledged and not seen in a frame yet, ascending

  /** send(message) answers whether it was sent. */
  constructor(send) {
    this.#send = send;
  }

  /** Whether the server may not have heard all yet. */
  get isBusy() {
    return this.#pending.length > 0 || this.#sent.size > 0;
  }

  /** Sets part of the state: {rotation}, {environment}, {exposure}, {view}, {material}. */
  set(change) {
    const last = this.#pending.pop() ?? {};
    const both = merged(last, change);
    this.#pending.push(...(both ? [both] : [last, change]));
    this.#schedule();
  }

  acknowledged(id, revision) {
    const time = this.#sent.get(id);
    if (time === undefined) return;
    this.#sent.delete(id);
    this.#shown.push({ revision, time });
    if (this.#shown.length > kRemembered) this.#shown.shift();
    this.#schedule();
  }

  refused(id) {
    this.#sent.delete(id);
    this.#schedule();
  }

  /** Milliseconds from the newest edit that the frame is the first to show; null when none. */
  latencyOf(revision, now) {
    let newest = null;
    while (this.#shown.length > 0 && this.#shown[0].revision <= revision) {
      newest = this.#shown.shift();
    }
    return newest && now - newest.time;
  }

  /** After a new welcome: nothing that was sent before will be acknowledged. */
  restart() {
    this.#sent.clear();
    this.#shown = [];
    this.#schedule();
  }

  #schedule() {
    if (this.#scheduled || this.#pending.length === 0) return;
    this.#scheduled = true;
    requestAnimationFrame(() => {
      this.#scheduled = false;
      this.#flush();
    });
  }

  #flush() {
    if (this.#pending.length === 0 || this.#sent.size >= kMostUnacknowledged) return;
    const id = String(++this.#counter);
    if (!this.#send({ type: 'edit', id, ...this.#pending[0] })) return;
    this.#sent.set(id, performance.now());
    this.#pending.shift();
    this.#schedule();
  }
}
