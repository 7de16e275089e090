// The panel of materials whose BRDFs are edited: their curves, parameters and presets.
import { CurveLibrary } from './curve_library.js';
import { CurveParameters } from './curve_parameters.js';
import { CurvePlot, numberText, roundTop, shareOf, valueAt } from './curve_plot.js';
import { binsOfPoints, kBins, kLargestValue } from './curve_points.js';
import { preset, presetNames } from './curve_presets.js';
import { applied, channelValue, kAxes, kNothing, withChannel } from './curve_state.js';
import { CurveView } from './curve_view.js';

const kLeastGap = 1 / 1024; // between points
const kMostPoints = kBins;
const kEnergyWarning = 1.02; // the estimate is right to a few percent
const kChannelNames = ['Red', 'Green', 'Blue'];
const element = (id) => document.getElementById(`curve-${id}`);

function setOptions(select, options) {
  const isSame = select.length === options.length && options.every(([key], i) => select[i].value === key);
  if (isSame) return; // it may be open
  const value = select.value;
  select.replaceChildren(...options.map(([key, text]) => new Option(text, key)));
  if (options.some(([key]) => key === value)) select.value = value;
}

/** Calls onChange({material: …}), onDrop() when a hand lets go, and onError(text). */
export class CurveEditor {
  #panel = document.getElementById('curves');
  #onChange;
  #onDrop;
  #library;
  #plot;
  #parameters;
  #baked = new Map();
  #measured = [];
  #edited = kNothing;
  #scales = { half_angle: 'logarithmic', difference_angle: 'linear' }; // of curves not drawn
  #held = null; // while a point moves: {top, colour}

  constructor({ headers, onChange, onDrop, onError }) {
    this.#onChange = onChange;
    this.#onDrop = onDrop;
    this.#library = new CurveLibrary({ headers, onArrival: () => this.#render(), onError });
    this.#plot = new CurvePlot(element('plot'), {
      onGrab: (index) => this.#hold(index),
      onMove: (index, position, value) => this.#movePoint(index, position, value),
      onDrop: () => this.#drop(),
      onAdd: (position, value) => this.#addPoint(position, value),
      onAddAfter: (index) => this.#addAfter(index),
      onRemove: (index) => this.#removePoint(index),
      onNudge: (...step) => this.#nudge(...step),
    });
    this.#parameters = new CurveParameters(element('parameters'), {
      onChange: (name, value) => this.#set({ parameter: { [name]: value } }),
    });
    for (const id of ['material', 'channel', 'compare']) {
      element(id).addEventListener('change', () => this.#render());
    }
    for (const axis of kAxes) element(axis).addEventListener('change', () => this.#render());
    element('scale').addEventListener('change', () => this.#setScale(element('scale').value));
    element('load').addEventListener('change', () => this.#set({ load: element('load').value || null }));
    element('preset').addEventListener('change', () => this.#usePreset());
    element('own').addEventListener('click', () => this.#set({ curve: { [this.#axis]: null } }));
    element('reset').addEventListener('click', () => this.#set({ parameter: null }));
  }

  get isDragging() {
    return this.#plot.isGrabbed;
  }

  /** What the scene has, as it was baked; none hides the panel. */
  setScene(scene, editable, measured) {
    this.#panel.hidden = editable.length === 0;
    this.#library.setScene(scene);
    const isSame = JSON.stringify([...this.#baked.values()]) === JSON.stringify(editable);
    this.#baked = new Map(editable.map((material) => [material.name, material]));
    this.#measured = measured;
    if (isSame) return;
    setOptions(element('material'), editable.map(({ name }) => [name, name]));
    setOptions(element('load'), [['', 'Its model'], ...measured.map((name) => [name, name])]);
    setOptions(element('compare'), [['none', 'Nothing'], ['baked', 'As baked'],
      ...measured.map((name) => [`measured ${name}`, name])]);
    element('load').disabled = measured.length === 0;
    this.#render();
  }

  /** Shows a state that came from the server. */
  show({ parameter, curve, load }) {
    this.#edited = { parameter, curve, load };
    this.#render();
  }

  get #name() {
    return element('material').value;
  }
  get #axis() {
    return kAxes.find((axis) => element(axis).checked) ?? kAxes[0];
  }
  get #channel() {
    return element('channel').value;
  }
  get #view() {
    return new CurveView(this.#baked.get(this.#name), this.#edited, this.#library);
  }
  get #scale() {
    return this.#edited.curve[this.#name]?.[this.#axis]?.scale ?? this.#scales[this.#axis];
  }

  /** Sets parts of the chosen material: {parameter, curve, load}. */
  #set(parts) {
    const name = this.#name;
    const change = Object.fromEntries(Object.entries(parts).map(([part, value]) => [part, { [name]: value }]));
    this.#edited = applied(this.#edited, change);
    this.#render();
    this.#onChange({ material: change });
  }

  #usePreset() {
    const name = element('preset').value;
    element('preset').value = '';
    if (!name) return;
    const view = this.#view;
    const chosen = preset(name, view.material, (half_angle, parameters) => {
      const curve = { [this.#name]: { half_angle } };
      const parameter = { [this.#name]: parameters };
      const edited = applied({ ...this.#edited, curve }, { parameter });
      return new CurveView(this.#baked.get(this.#name), edited, this.#library).energy()?.lobe ?? 0;
    });
    const parts = {};
    if (chosen.parameters) parts.parameter = chosen.parameters;
    if (view.axes.length > 0) {
      parts.curve = Object.fromEntries(view.axes.map((axis) => [axis, null]));
      if (chosen.half_angle) parts.curve.half_angle = chosen.half_angle;
    }
    this.#set(parts);
  }

  #setScale(scale) {
    this.#scales[this.#axis] = scale;
    const drawn = this.#edited.curve[this.#name]?.[this.#axis];
    if (drawn?.points) {
      this.#set({ curve: { [this.#axis]: { ...drawn, scale } } });
    } else {
      this.#render();
    }
  }

  // Points.

  #setPoints(points) {
    this.#set({ curve: { [this.#axis]: { scale: this.#scale, points } } });
  }

  get #points() {
    return this.#view.points(this.#axis, this.#scale);
  }

  #hold(index) {
    this.#held ??= { top: this.#top(this.#view), colour: this.#points[index].slice(1) };
  }

  #drop() {
    this.#held = null;
    this.#render();
    this.#onDrop();
  }

  #movePoint(index, position, value) {
    const points = [...this.#points];
    const least = index > 0 ? points[index - 1][0] + kLeastGap : 0;
    const most = index + 1 < points.length ? points[index + 1][0] - kLeastGap : 1;
    const colour = withChannel(this.#held?.colour ?? points[index].slice(1), this.#channel, value, [0, kLargestValue]);
    points[index] = [least <= most ? Math.min(most, Math.max(least, position)) : points[index][0], ...colour];
    this.#setPoints(points);
  }

  #nudge(index, right, up, isLarge) {
    this.#hold(index);
    const { top } = this.#held;
    const [position, ...colour] = this.#points[index];
    const share = shareOf(this.#scale, top, channelValue(colour, this.#channel));
    const value = up === 0 ? channelValue(colour, this.#channel)
      : valueAt(this.#scale, top, share + up * (isLarge ? 0.1 : 0.01));
    this.#movePoint(index, position + (right * (isLarge ? 8 : 1)) / kBins, value);
  }

  #addPoint(position, value = null) {
    const points = this.#points;
    if (points.length === 0 || points.length >= kMostPoints) return;
    if (points.some((point) => Math.abs(point[0] - position) < kLeastGap)) return;
    const bins = binsOfPoints(this.#scale, points);
    const colour = bins[Math.min(kBins - 1, Math.floor(position * kBins))];
    const point = [position, ...(value === null ? colour : withChannel(colour, this.#channel, value, [0, kLargestValue]))];
    this.#setPoints([...points, point].sort((a, b) => a[0] - b[0]));
    this.#plot.focusPoint(this.#points.findIndex((one) => one[0] === position));
  }

  #addAfter(index) {
    const points = this.#points;
    const neighbour = index + 1 < points.length ? index + 1 : index - 1;
    const other = points[neighbour]?.[0] ?? (points[index][0] < 0.5 ? 1 : 0);
    this.#addPoint((points[index][0] + other) / 2);
  }

  #removePoint(index) {
    const points = this.#points;
    if (points.length <= 1) return;
    this.#setPoints(points.filter((_, i) => i !== index));
    this.#plot.focusPoint(index);
  }

  // What is seen.

  #compared(view) {
    const choice = element('compare').value;
    if (choice === 'none') return null;
    const curves = this.#library.get(view.material.name,
      choice === 'baked' ? null : choice.slice('measured '.length));
    return curves?.[this.#axis] ?? null;
  }

  #top(view) {
    const most = Math.max(1e-9, ...[view.bins(this.#axis), this.#compared(view)].flat(2).map((v) => v ?? 0));
    return this.#scale === 'linear' ? roundTop(1.15 * most) : 10 ** Math.ceil(Math.log10(most) + 1e-9);
  }

  #render() {
    if (!this.#baked.has(this.#name)) return;
    const view = this.#view;
    for (const axis of kAxes) element(axis).disabled = !view.axes.includes(axis);
    if (view.axes.length > 0 && !view.axes.includes(this.#axis)) element(view.axes[0]).checked = true;
    for (const id of ['plot', 'shape']) element(id).classList.toggle('absent', view.axes.length === 0);
    this.#renderPlot(view);
    this.#renderChoices(view);
    this.#parameters.show(view.material, this.#channel);
    this.#renderEnergy(view);
  }

  #renderPlot(view) {
    const axis = this.#axis;
    const text = (colour) => (this.#channel === 'all' ? colour.map(numberText).join(', ')
      : `${kChannelNames[this.#channel]} ${numberText(colour[this.#channel])}`);
    this.#plot.show({ axis, scale: this.#scale, top: this.#held?.top ?? this.#top(view), bins: view.bins(axis),
      compare: this.#compared(view), isDrawn: Boolean(view.drawn[axis]),
      points: this.#points.map(([position, ...colour]) =>
        [position, channelValue(colour, this.#channel), text(colour)]) });
  }

  #renderChoices(view) {
    element('scale').value = this.#scale;
    element('load').value = view.material.measured ?? '';
    setOptions(element('preset'), [['', 'Preset…'], ...presetNames(view.material, view.axes).map((name) => [name, name])]);
    element('own').disabled = !view.drawn[this.#axis];
    const fit = view.measuredCurves?.fit_error;
    element('fit').textContent = fit ? `Fitted to ${(100 * Math.max(...fit.relative)).toFixed(1)} %` : '';
  }

  #renderEnergy(view) {
    const energy = view.energy();
    const percent = energy ? `${Math.round(100 * energy.albedo)} %` : '–';
    element('energy').textContent = `Reflects up to ${percent}`;
    const tooMuch = energy !== null && energy.albedo > kEnergyWarning;
    element('warning').hidden = !tooMuch;
    if (tooMuch) element('warning').textContent = 'More light than it gets: no real material does this.';
  }
}
