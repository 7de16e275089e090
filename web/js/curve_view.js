// What there is to show of one material's curves: in bins, in points, and their energy.
import { factorBins } from './brdf_models.js';
import { binsOfCurve, fittedPoints } from './curve_points.js';
import { axesOf, kAxes, shownMaterial } from './curve_state.js';
import { energyOf } from './energy.js';

const kMostKept = 64;

/** Keeps the last results of a function of its key. */
function kept(make) {
  const results = new Map();
  return (key, ...rest) => {
    if (!results.has(key)) {
      if (results.size >= kMostKept) results.clear();
      results.set(key, make(...rest));
    }
    return results.get(key);
  };
}

const modelBins = kept((material, axis) => factorBins(material, axis));
const curveBins = kept((curve) => binsOfCurve(curve));
const pointsOf = kept((bins, scale) => fittedPoints(bins, scale));

function ownKey({ model, roughness, exponent, eta, k, specular }, axis) {
  return JSON.stringify([model, roughness, exponent, eta, k, specular, axis]);
}

/** One material of the session: `baked` of the welcome, `edited` by the session, `library` of curves. */
export class CurveView {
  constructor(baked, edited, library) {
    this.material = shownMaterial(baked, edited);
    this.axes = axesOf(this.material);
    this.drawn = edited.curve[baked.name] ?? {};
    this.library = library;
  }

  /** The factors of the measured BRDF that is shown; null for a model, or until they are here. */
  get measuredCurves() {
    const { model, name, measured } = this.material;
    return model === 'measured' ? this.library.get(name, measured) : null;
  }

  /** The material's own factor, nothing drawn; null when it has none, or it is not here yet. */
  ownBins(axis) {
    if (!this.axes.includes(axis)) return null;
    if (this.material.model === 'measured') return this.measuredCurves?.[axis] ?? null;
    return modelBins(ownKey(this.material, axis), this.material, axis);
  }

  bins(axis) {
    const drawn = this.axes.includes(axis) ? this.drawn[axis] : null;
    return drawn ? curveBins(JSON.stringify(drawn), drawn) : this.ownBins(axis);
  }

  /** Points to drag: those drawn, else some through the curve on that scale. */
  points(axis, scale) {
    if (this.drawn[axis]?.points) return this.drawn[axis].points;
    const bins = this.bins(axis);
    return bins ? pointsOf(`${scale} ${JSON.stringify(bins)}`, bins, scale) : [];
  }

  /** {albedo, lobe}; null until all is here. */
  energy() {
    if (this.material.model === 'measured' && !this.measuredCurves) return null;
    const bins = Object.fromEntries(kAxes.map((axis) => [axis, this.bins(axis)]));
    return energyOf(this.material, bins, this.measuredCurves?.rest);
  }
}
