// How much of its light a material reflects: an estimate, coarse enough to follow a drag.
import { fresnel } from './brdf_models.js';
import { angleAt, binOf, kBins } from './curve_points.js';

const kCosines = [1, 0.65, 0.35, 0.1, 0.02]; // of θ_o
const kTurns = 12; // of φ_h, over half a circle
const kQuarter = Math.PI / 2;

/** What a Cook–Torrance lobe leaves to the Lambert part below it, as core/material/cook_torrance. */
function undercoat(eta, k, specular) {
  if (!(specular > 0)) return { base: 1, slope: 0 };
  if (k > 0 || eta < 1) return { base: 0, slope: 0 };
  const normal = fresnel(eta, 0, 0);
  return { base: 1 - specular, slope: specular * (1 - (normal + 0.035 * (1 - normal))) };
}

/** The albedo of the Lambert part towards cos θ_o, by channel. */
function diffuse(material, cosine) {
  const { model, albedo, specular } = material;
  if (model === 'measured') return [0, 0, 0];
  if (model === 'ashikhmin_shirley') return albedo.map((v, c) => v * (1 - specular[c]));
  if (model !== 'cook_torrance') return albedo;
  return albedo.map((v, c) => {
    const { base, slope } = undercoat(material.eta[c], material.k[c], specular[c]);
    return v * (base + slope * (1 - (1 - cosine) ** 5));
  });
}

/** P of a measured BRDF at a cosine: linear in its logarithm between knots. */
function restAt(rest, cosine) {
  const place = (Math.acos(Math.min(1, cosine)) / kQuarter) * (rest.length - 1);
  const i = Math.min(rest.length - 2, Math.floor(place));
  return rest[i].map((low, c) => low * (rest[i + 1][c] / low) ** (place - i));
}

/** The lobe without its factors over θ_h and θ_d, for directions and angles in `at`. */
function quotientOf(material, rest) {
  const { model, specular } = material;
  if (model === 'measured') {
    const knots = Array.from({ length: kBins + 1 }, (_, i) => restAt(rest, i / kBins));
    const near = (cosine) => knots[Math.round(cosine * kBins)];
    return ({ cosineIn, cosineOut }) => near(cosineIn).map((v, c) => v * near(cosineOut)[c]);
  }
  if (model === 'cook_torrance') {
    return ({ cosineIn, cosineOut, cosineHalf, cosineDifference }) => {
      const edge = (2 * cosineHalf) / cosineDifference;
      const cavity = Math.min(1 / Math.min(cosineIn, cosineOut), edge) / (4 * Math.max(cosineIn, cosineOut));
      return specular.map((v) => v * cavity);
    };
  }
  if (model === 'blinn_phong') return () => specular;
  const [nx, ny] = [material.exponent, material.exponent_across];
  const scale = Math.sqrt((nx + 1) * (ny + 1)) / (8 * Math.PI);
  return ({ cosineIn, cosineOut, cosineHalf, cosineDifference, cosineTurn }) => {
    const exponent = ny + (nx - ny) * cosineTurn * cosineTurn;
    const value = (scale * cosineHalf ** exponent) / (cosineDifference * Math.max(cosineIn, cosineOut));
    return [value, value, value];
  };
}

/** ∫ f cos θ_i dω_i of the lobe, over half vectors in the bins of θ_h: dω_i = 4 cos θ_d dω_h. */
function lobeAlbedo(quotient, halfBins, differenceBins, cosineOut, turned) {
  const sineOut = Math.sqrt(1 - cosineOut * cosineOut);
  const sum = [0, 0, 0];
  for (let bin = 0; bin < kBins; ++bin) {
    const [begin, end] = [angleAt('half_angle', bin / kBins), angleAt('half_angle', (bin + 1) / kBins)];
    const half = halfBins?.[bin] ?? [1, 1, 1];
    if (!(Math.max(...half) > 0)) continue;
    // cos begin − cos end, with the digits of small angles.
    const ring = 2 * Math.sin((begin + end) / 2) * Math.sin((end - begin) / 2);
    const weight = (2 * Math.PI * ring) / kTurns;
    const angle = (begin + end) / 2;
    const [sineHalf, cosineHalf] = [Math.sin(angle), Math.cos(angle)];
    for (let turn = 0; turn < kTurns; ++turn) {
      const cosineTurn = Math.cos((Math.PI * (turn + 0.5)) / kTurns);
      const cosineDifference = sineOut * sineHalf * cosineTurn + cosineOut * cosineHalf;
      const cosineIn = 2 * cosineDifference * cosineHalf - cosineOut;
      if (!(cosineDifference > 0 && cosineIn > 0)) continue;
      const about = turned ? Math.sqrt(1 - cosineTurn * cosineTurn) : cosineTurn;
      const value = quotient({ cosineIn, cosineOut, cosineHalf, cosineDifference, cosineTurn: about });
      const difference = differenceBins?.[binOf('difference_angle', Math.acos(Math.min(1, cosineDifference)))];
      const share = 4 * cosineDifference * cosineIn * weight;
      for (let c = 0; c < 3; ++c) sum[c] += share * value[c] * half[c] * (difference?.[c] ?? 1);
    }
  }
  return sum;
}

/**
 * The largest share of its light that a material reflects to one side, of all channels, and the
 * part of it that the lobe has: {albedo, lobe}. `bins` are its factors, {half_angle,
 * difference_angle}, drawn or its own, null where it has none; `rest` is a measured BRDF's. Of
 * models without such a factor their bound.
 */
export function energyOf(material, bins, rest = null) {
  if (material.model === 'lambert') return { albedo: Math.max(...material.albedo), lobe: 0 };
  if (material.model === 'phong' || material.model === 'ward') {
    return { albedo: Math.max(...material.albedo.map((v, c) => v + material.specular[c])),
      lobe: Math.max(...material.specular) };
  }
  const quotient = quotientOf(material, rest);
  const sides = material.model === 'ashikhmin_shirley' ? [false, true] : [false];
  let largest = { albedo: 0, lobe: 0 };
  for (const cosine of kCosines) {
    const base = diffuse(material, cosine);
    for (const turned of sides) {
      const lobe = lobeAlbedo(quotient, bins.half_angle, bins.difference_angle, cosine, turned);
      lobe.forEach((v, c) => {
        if (v + base[c] > largest.albedo) largest = { albedo: v + base[c], lobe: v };
      });
    }
  }
  return largest;
}
