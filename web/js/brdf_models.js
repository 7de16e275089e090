// The factors of the analytic models over one angle, as core/material/brdf_curve has them. A
// material is one of the welcome's `editable`, with what was edited of it.
import { angleAt, gaussLegendre, kBins } from './curve_points.js';

const filled = (value) => [value, value, value];

/** Beckmann's D(θ_h). */
function beckmann(m, angle) {
  const cosine = Math.max(Math.cos(angle), 1e-12);
  const tangent = Math.sin(angle) / (cosine * m);
  return Math.exp(-tangent * tangent - 4 * Math.log(cosine)) / (Math.PI * m * m);
}

function blinnPhong(n, angle) {
  const scale = ((n + 2) * (n + 4)) / (8 * Math.PI * (2 ** (-n / 2) + n));
  return scale * Math.max(0, Math.cos(angle)) ** n;
}

/** Unpolarised, of a complex index eta + i k: as core/material/fresnel has it. */
export function fresnel(eta, k, angle) {
  const c = Math.max(Math.cos(angle), 1e-12);
  const s2 = Math.sin(angle) ** 2;
  const real = eta * eta - k * k - s2;
  const modulus = Math.hypot(real, 2 * eta * k);
  const a = Math.sqrt(Math.max(0, (modulus + real) / 2));
  const b2 = Math.max(0, (modulus - real) / 2);
  const polarised = (a - c) ** 2 + b2;
  const low = (a * c - s2) ** 2 + b2 * c * c;
  const high = (a * c + s2) ** 2 + b2 * c * c;
  const reflectance = (0.5 * polarised * (high + low)) / (((a + c) ** 2 + b2) * high);
  return Number.isFinite(reflectance) ? reflectance : 1;
}

function schlick(normal, angle) {
  const power = (1 - Math.min(1, Math.max(0, Math.cos(angle)))) ** 5;
  return normal + (1 - normal) * power;
}

/** The model's own factor as a function of the angle; null where it has none. */
export function factorOf(material, axis) {
  if (axis === 'half_angle') {
    if (material.model === 'cook_torrance') return (angle) => filled(beckmann(material.roughness, angle));
    if (material.model === 'blinn_phong') return (angle) => filled(blinnPhong(material.exponent, angle));
    return null;
  }
  if (material.model === 'cook_torrance') {
    return (angle) => material.eta.map((eta, c) => fresnel(eta, material.k[c], angle));
  }
  if (material.model === 'ashikhmin_shirley') {
    return (angle) => material.specular.map((normal) => schlick(normal, angle));
  }
  return null;
}

const kNodes = gaussLegendre(8);

/** Its averages in the bins, over solid angle for θ_h; null where the model has no such factor. */
export function factorBins(material, axis) {
  const factor = factorOf(material, axis);
  if (!factor) return null;
  return Array.from({ length: kBins }, (_, bin) => {
    const [begin, end] = [angleAt(axis, bin / kBins), angleAt(axis, (bin + 1) / kBins)];
    const sum = [0, 0, 0];
    let weights = 0;
    for (const { x, weight } of kNodes) {
      const angle = 0.5 * (begin + end + (end - begin) * x);
      const share = weight * (axis === 'half_angle' ? Math.sin(angle) : 1);
      factor(angle).forEach((value, c) => { sum[c] += share * value; });
      weights += share;
    }
    return sum.map((value) => value / weights);
  });
}
