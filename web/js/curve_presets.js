// Materials to begin with: parameters of the models that have them, curves for what none describes.
import { positionOf } from './curve_points.js';

const half = (degrees) => positionOf('half_angle', (degrees * Math.PI) / 180);

/** Values over θ_h in degrees; their scale is set by the energy that they may reflect. */
function lobe(scale, ...points) {
  return { scale, points: points.map(([degrees, ...value]) => [half(degrees), ...value]) };
}

const kPresets = {
  matte: { cook_torrance: { roughness: 0.6, eta: 1.4, k: 0 }, blinn_phong: { exponent: 4 },
    ward: { roughness: 0.6, roughness_across: 0.6 },
    ashikhmin_shirley: { exponent: 5, exponent_across: 5 } },
  satin: { cook_torrance: { roughness: 0.3, eta: 1.5, k: 0 }, blinn_phong: { exponent: 25 },
    ward: { roughness: 0.3, roughness_across: 0.3 },
    ashikhmin_shirley: { exponent: 30, exponent_across: 30 } },
  gloss: { cook_torrance: { roughness: 0.06, eta: 1.5, k: 0 }, blinn_phong: { exponent: 600 },
    ward: { roughness: 0.06, roughness_across: 0.06 },
    ashikhmin_shirley: { exponent: 800, exponent_across: 800 } },
  // Copper's index at 630, 530 and 465 nm.
  metal: { cook_torrance: { roughness: 0.15, eta: [0.21, 1.09, 1.24], k: [3.67, 2.58, 2.39] } },
  brushed: { ward: { roughness: 0.08, roughness_across: 0.35 },
    ashikhmin_shirley: { exponent: 800, exponent_across: 20 } },
  pearl: { cook_torrance: { roughness: 0.3, eta: 1.6, k: 0 }, curve: { share: 0.35, half_angle: lobe('logarithmic', [0, 30, 28, 28], [2, 22, 19, 20],
    [5, 3, 2.6, 3.4], [12, 2, 1.9, 2.6], [22, 1.2, 1.3, 1.8], [40, 0.3, 0.35, 0.5],
    [89, 0.01, 0.01, 0.01]) } },
  cloth: { cook_torrance: { roughness: 0.6, eta: 1.5, k: 0 }, curve: { share: 0.2, half_angle: lobe('linear', [0, 0.25, 0.25, 0.25], [15, 0.3, 0.3, 0.3],
    [35, 0.6, 0.6, 0.62], [55, 1, 1, 1.05], [75, 0.8, 0.8, 0.85], [89, 0.3, 0.3, 0.3]) } },
};

/** The presets that say something about a material. */
export function presetNames(material, axes) {
  return Object.keys(kPresets).filter((name) =>
    kPresets[name][material.model] || (kPresets[name].curve && axes.includes('half_angle')));
}

/** One number of an index of refraction is that of all channels. */
function inChannels(parameters) {
  return Object.fromEntries(Object.entries(parameters).map(([name, value]) =>
    [name, name === 'eta' || name === 'k' ? [value, value, value].flat().slice(0, 3) : value]));
}

/**
 * A preset as {parameters, half_angle}: either may be null. `lobeOf(curve, parameters)` tells how
 * much the material's lobe reflects with them.
 */
export function preset(name, material, lobeOf) {
  const { curve, [material.model]: given } = kPresets[name];
  const parameters = given ? inChannels(given) : null;
  if (!curve) return { parameters, half_angle: null };
  const { scale, points } = curve.half_angle;
  const factor = curve.share / lobeOf(curve.half_angle, parameters ?? {});
  if (!(factor > 0 && factor < 1e5)) return { parameters, half_angle: curve.half_angle };
  const scaled = points.map(([position, ...value]) => [position, ...value.map((v) => v * factor)]);
  return { parameters, half_angle: { scale, points: scaled } };
}
