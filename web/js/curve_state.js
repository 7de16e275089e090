// What a session differs by from the bake: {parameter, curve, load}, each by a material's name.
import { changedMaterial } from './materials.js';

export const kAxes = ['half_angle', 'difference_angle'];
export const kNothing = { parameter: {}, curve: {}, load: {} };

/** `parts` with one name's set, or left out when it is empty. */
function withPart(parts, name, part) {
  const { [name]: _, ...others } = parts;
  const isEmpty = part == null || (typeof part === 'object' && Object.keys(part).length === 0);
  return isEmpty ? others : { ...others, [name]: part };
}

/** What is edited after a change, as the server does it. */
export function applied(edited, change) {
  let { parameter, curve, load } = edited;
  for (const [name, values] of Object.entries(change.parameter ?? {})) {
    if (values === null) {
      [parameter, curve, load] = [parameter, curve, load].map((parts) => withPart(parts, name, null));
    } else {
      parameter = withPart(parameter, name, changedMaterial(parameter[name], values));
    }
  }
  for (const [name, axes] of Object.entries(change.curve ?? {})) {
    const drawn = Object.entries({ ...curve[name], ...axes }).filter(([, one]) => one !== null);
    curve = withPart(curve, name, Object.fromEntries(drawn));
  }
  for (const [name, measured] of Object.entries(change.load ?? {})) load = withPart(load, name, measured);
  return { parameter, curve, load };
}

/** The material as it is shown: as baked, its parameters edited; `measured` names what it loads. */
export function shownMaterial(baked, edited) {
  const measured = edited.load[baked.name] ?? null;
  const model = measured === null ? baked.model : 'measured';
  return { ...baked, ...edited.parameter[baked.name], model, measured };
}

/** The axes that can be drawn of it. */
export function axesOf(material) {
  return material.model === 'measured' ? kAxes : material.axes;
}

/** Three channels with one value: all of them (their largest becomes it, their ratio stays), or one. */
export function withChannel(colour, channel, value, [low, high] = [0, Infinity]) {
  const clamped = (v) => Math.min(high, Math.max(low, v));
  if (channel !== 'all') return colour.map((v, c) => (c === Number(channel) ? clamped(value) : v));
  const most = Math.max(...colour);
  return colour.map((v) => clamped(most > 0 ? (v / most) * value : value));
}
export function channelValue(colour, channel) {
  return channel === 'all' ? Math.max(...colour) : colour[Number(channel)];
}
