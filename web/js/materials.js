// Materials of a scene that has them: a choice, and what it may be edited to.

const kLeastExponent = 1;
const kMostExponent = 1000;

/** One channel, linear 0 … 1, to sRGB 0 … 255 and back (IEC 61966-2-1). */
export function encoded(linear) {
  const v = Math.min(1, Math.max(0, linear));
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
}
export function linear(byte) {
  const v = byte / 255;
  return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
}

export function toHex(colour) {
  return `#${colour.map((v) => encoded(v).toString(16).padStart(2, '0')).join('')}`;
}
export function fromHex(text) {
  return [1, 3, 5].map((at) => linear(parseInt(text.slice(at, at + 2), 16)));
}

/** The exponent of a slider's place, 0 … 100, and back: evenly in its logarithm. */
export function exponentOf(place) {
  return kLeastExponent * (kMostExponent / kLeastExponent) ** (place / 100);
}
export function placeOf(exponent) {
  const within = Math.min(kMostExponent, Math.max(kLeastExponent, exponent));
  return (100 * Math.log(within / kLeastExponent)) / Math.log(kMostExponent / kLeastExponent);
}

/** A highlight of another strength, its hue kept; white where it had none. */
export function scaledHighlight(colour, strength) {
  const most = Math.max(...colour);
  return colour.map((v) => (most > 0 ? (v / most) * strength : strength));
}

/** Shapes of a highlight, by the angle from the mirror direction; null is Phong's by its exponent. */
const kLobeValues = 37; // 2.5° apart
function sampledLobe(valueAt) {
  return Array.from({ length: kLobeValues }, (_, i) => valueAt((90 * i) / (kLobeValues - 1)));
}
/** A half cosine from 1 at `from` to 0 at `to`, in degrees; to 10⁻⁴, as messages carry it. */
function fallOff(angle, from, to) {
  const share = Math.min(1, Math.max(0, (angle - from) / (to - from)));
  return Math.round(1e4 * (0.5 + 0.5 * Math.cos(Math.PI * share))) / 1e4;
}
export const kLobes = {
  phong: null,
  disc: sampledLobe((angle) => fallOff(angle, 15, 35)),
  ring: sampledLobe((angle) => fallOff(Math.abs(angle - 30), 0, 15)),
};

/** Its name among them; "other" for one that is not. */
export function nameOfLobe(lobe) {
  const text = JSON.stringify(lobe ?? null);
  return Object.keys(kLobes).find((name) => JSON.stringify(kLobes[name]) === text) ?? 'other';
}

/** What was edited of a material, and then changed: as the server does it. */
export function changedMaterial(edited, change) {
  const result = { ...edited, ...change };
  const isReplaced = 'exponent' in change && !('lobe' in change);
  if (isReplaced || result.lobe === null) delete result.lobe;
  return result;
}

/** The panel. Calls onChange({material: {parameter: {NAME: {…} or null}}}). */
export class Materials {
  #panel = document.getElementById('materials');
  #choice = document.getElementById('material-choice');
  #albedo = document.getElementById('material-albedo');
  #highlight = document.getElementById('material-highlight');
  #highlightValue = document.getElementById('material-highlight-value');
  #lobe = document.getElementById('material-lobe');
  #exponent = document.getElementById('material-exponent');
  #exponentValue = document.getElementById('material-exponent-value');
  #baked = new Map(); // name → {albedo, highlight, exponent}
  #edited = {}; // by name: what the session differs by
  #onChange;

  constructor(onChange) {
    this.#onChange = onChange;
    this.#choice.addEventListener('change', () => this.#showChosen());
    this.#albedo.addEventListener('input', () => this.#set({ albedo: fromHex(this.#albedo.value) }));
    this.#highlight.addEventListener('input', () => this.#set({
      highlight: scaledHighlight(this.#shown().highlight, this.#highlight.valueAsNumber) }));
    this.#lobe.addEventListener('change', () => this.#set({ lobe: kLobes[this.#lobe.value] }));
    this.#exponent.addEventListener('input', () => this.#set({
      exponent: exponentOf(this.#exponent.valueAsNumber) }));
    document.getElementById('reset-material').addEventListener('click', () => this.#reset());
  }

  /** What the scene has, as it was baked; none hides the panel. */
  setMaterials(materials) {
    this.#panel.hidden = materials.length === 0;
    const names = materials.map(({ name }) => name);
    const known = [...this.#baked.keys()];
    this.#baked = new Map(materials.map((material) => [material.name, material]));
    if (JSON.stringify(names) === JSON.stringify(known)) return;
    this.#choice.replaceChildren(...names.map((name) => new Option(name, name)));
    this.#showChosen();
  }

  /** Shows a state that came from the server. */
  show(edited) {
    this.#edited = edited;
    this.#showChosen();
  }

  #shown() {
    const name = this.#choice.value;
    return { ...this.#baked.get(name), ...this.#edited[name] };
  }

  #set(change) {
    const name = this.#choice.value;
    this.#edited = { ...this.#edited, [name]: changedMaterial(this.#edited[name], change) };
    this.#showChosen();
    this.#onChange({ material: { parameter: { [name]: change } } });
  }

  #reset() {
    const { [this.#choice.value]: mine, ...others } = this.#edited;
    this.#edited = others;
    this.#showChosen();
    this.#onChange({ material: { parameter: { [this.#choice.value]: null } } });
  }

  #showChosen() {
    if (!this.#baked.has(this.#choice.value)) return;
    const { albedo, highlight, exponent, lobe } = this.#shown();
    this.#albedo.value = toHex(albedo);
    this.#highlight.value = Math.max(...highlight);
    this.#highlightValue.textContent = `${Math.round(100 * Math.max(...highlight))} %`;
    this.#lobe.value = nameOfLobe(lobe);
    this.#exponent.value = placeOf(exponent);
    this.#exponentValue.textContent = exponent < 10 ? exponent.toFixed(1) : String(Math.round(exponent));
  }
}
