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
  #pending = []; // {gesture, change}, each to be sent as one, or {command}
  #scheduled = false;
  #counter = 0;
  #sent = new Map(); // id → {time sent, entry}, until acknowledged
  #gesture;
  #shown = []; // [{revision, time}], acknowledged and not seen in a frame yet, ascending

  /** send(message) answers whether it was sent; gesture() names what the hand is doing. */
  constructor(send, gesture = () => '') {
    this.#send = send;
    this.#gesture = gesture;
  }

  /** Whether the server may not have heard all yet. */
  get isBusy() {
    return this.#pending.length > 0 || this.#sent.size > 0;
  }

  /** Sets part of the state: {rotation}, {environment}, {exposure}, {view}, {material}. */
  set(change) {
    const gesture = this.#gesture();
    const last = this.#pending.at(-1);
    const both = last?.change && last.gesture === gesture && merged(last.change, change);
    if (both) {
      last.change = both;
    } else {
      this.#pending.push({ gesture, change });
    }
    this.#schedule();
  }

  /** Sends another message that makes a revision, after the edits before it. */
  command(message) {
    this.#pending.push({ command: message });
    this.#schedule();
  }

  acknowledged(id, revision) {
    const sent = this.#sent.get(id);
    if (sent === undefined) return;
    this.#sent.delete(id);
    this.#shown.push({ revision, time: sent.time });
    if (this.#shown.length > kRemembered) this.#shown.shift();
    this.#schedule();
  }

  /** The type of the message that was. */
  refused(id) {
    const { command, change } = this.#sent.get(id)?.entry ?? {};
    this.#sent.delete(id);
    this.#schedule();
    return command?.type ?? (change && 'edit');
  }

  /** Milliseconds from the newest edit that the frame is the first to show; null when none. */
  latencyOf(revision, now) {
    let newest = null;
    while (this.#shown.length > 0 && this.#shown[0].revision <= revision) {
      newest = this.#shown.shift();
    }
    return newest && now - newest.time;
  }

  /**
   * After a new welcome: nothing that was sent before will be acknowledged. Edits may be lost: they go again, which
   * changes nothing where they are not.
   */
  restart() {
    const unanswered = [...this.#sent.values()].map(({ entry }) => entry);
    this.#pending.unshift(...unanswered.filter(({ change }) => change));
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
    const [entry] = this.#pending;
    const message = entry.command ?? { type: 'edit', gesture: entry.gesture, ...entry.change };
    if (!this.#send({ id, ...message })) return;
    this.#sent.set(id, { time: performance.now(), entry });
    this.#pending.shift();
    this.#schedule();
  }
}
