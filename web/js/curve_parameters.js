// Sliders for the parameters of an analytic model.
import { channelValue, withChannel } from './curve_state.js';
import { numberText } from './curve_plot.js';
import { fromHex, toHex } from './materials.js';

/** A slider's place, 0 … 100, over a range: evenly in the logarithm, or with more room below. */
function logarithmic(low, high) {
  return { low, high, of: (place) => low * (high / low) ** (place / 100),
    place: (value) => (100 * Math.log(Math.max(low, value) / low)) / Math.log(high / low) };
}
function cubic(high) {
  return { low: 0, high, of: (place) => high * (place / 100) ** 3, place: (value) => 100 * Math.cbrt(value / high) };
}
const even = { low: 0, high: 1, of: (place) => place / 100, place: (value) => 100 * value };

const kRoughness = logarithmic(1e-4, 1);
const kExponent = logarithmic(1, 1e5);
const kParameters = {
  specular: { label: 'Specular', range: even },
  roughness: { label: 'Roughness', range: kRoughness },
  roughness_across: { label: 'Roughness across', range: kRoughness },
  exponent: { label: 'Exponent', range: kExponent },
  exponent_across: { label: 'Exponent across', range: kExponent },
  eta: { label: 'Index n', range: logarithmic(0.05, 100) },
  k: { label: 'Extinction k', range: cubic(100) },
};
const kOfModel = {
  lambert: [],
  phong: ['specular', 'exponent'],
  blinn_phong: ['specular', 'exponent'],
  cook_torrance: ['specular', 'roughness', 'eta', 'k'],
  ward: ['specular', 'roughness', 'roughness_across'],
  ashikhmin_shirley: ['specular', 'exponent', 'exponent_across'],
};

/** onChange(name, value) as it moves. */
export class CurveParameters {
  #container;
  #onChange;
  #model = null;
  #material = null;
  #channel = 'all';
  #rows = new Map(); // name → {input, output}
  #albedo;

  constructor(container, { onChange }) {
    this.#container = container;
    this.#onChange = onChange;
  }

  show(material, channel) {
    this.#material = material;
    this.#channel = channel;
    if (material.model !== this.#model) this.#build(material.model);
    if (this.#albedo) this.#albedo.value = toHex(material.albedo);
    for (const [name, { input, output }] of this.#rows) {
      const value = [material[name]].flat();
      const shown = value.length === 3 ? channelValue(value, channel) : value[0];
      input.value = kParameters[name].range.place(shown);
      output.textContent = numberText(shown);
      input.setAttribute('aria-valuetext', output.textContent);
    }
  }

  #build(model) {
    this.#model = model;
    this.#rows.clear();
    this.#albedo = null;
    this.#container.replaceChildren();
    if (!(model in kOfModel)) return; // a measured BRDF has none
    this.#albedo = this.#row('albedo', 'Colour', { type: 'color' }, (input) => fromHex(input.value)).input;
    for (const name of kOfModel[model]) {
      const { label, range } = kParameters[name];
      this.#rows.set(name, this.#row(name, label, { type: 'range', min: 0, max: 100, step: 0.25 },
        (input) => this.#valueOf(name, range, input.valueAsNumber)));
    }
  }

  #valueOf(name, range, place) {
    const value = Math.min(range.high, Math.max(range.low, range.of(place)));
    const now = this.#material[name];
    return Array.isArray(now) ? withChannel(now, this.#channel, value, [range.low, range.high]) : value;
  }

  #row(name, text, attributes, read) {
    const label = document.createElement('label');
    const words = document.createElement('span');
    words.textContent = text;
    const input = Object.assign(document.createElement('input'), attributes);
    input.id = `curve-${name}`;
    const output = document.createElement('output');
    output.htmlFor = input.id;
    label.append(words, input, output);
    this.#container.append(label);
    input.addEventListener('input', () => this.#onChange(name, read(input)));
    return { input, output };
  }
}
