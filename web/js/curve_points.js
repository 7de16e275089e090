// Curves of BRDFs in 256 bins, and through points: as core/material/curve_points has them.

export const kBins = 256;
export const kLargestValue = 1e6;
const kSmallestValue = 1e-9; // on the logarithmic scale; a result at it is 0

/** The angle, in radians, at a position of 0 … 1 over the bins, and back. */
export function angleAt(axis, position) {
  return (Math.PI / 2) * (axis === 'half_angle' ? position * position : position);
}
export function positionOf(axis, angle) {
  const share = Math.min(1, Math.max(0, angle / (Math.PI / 2)));
  return axis === 'half_angle' ? Math.sqrt(share) : share;
}
export function binOf(axis, angle) {
  return Math.min(kBins - 1, Math.floor(kBins * positionOf(axis, angle)));
}

/** Nodes and weights on [−1, 1] (Newton's method on the Legendre polynomial). */
export function gaussLegendre(count) {
  return Array.from({ length: count }, (_, i) => {
    let x = Math.cos((Math.PI * (i + 0.75)) / (count + 0.5));
    let slope = 1;
    for (let step = 0; step < 8; ++step) {
      let [last, value] = [1, x];
      for (let n = 2; n <= count; ++n) [last, value] = [value, ((2 * n - 1) * x * value - (n - 1) * last) / n];
      slope = (count * (x * value - last)) / (x * x - 1);
      x -= value / slope;
    }
    return { x, weight: 2 / ((1 - x * x) * slope * slope) };
  });
}

/** The slope at an end: three points, kept from overshooting. */
function endSlope(h, nextH, secant, nextSecant) {
  const slope = ((2 * h + nextH) * secant - h * nextSecant) / (h + nextH);
  if (!(slope * secant > 0)) return 0;
  if (secant * nextSecant <= 0 && Math.abs(slope) > 3 * Math.abs(secant)) return 3 * secant;
  return slope;
}

/** Fritsch and Butland's weighted harmonic means. */
function monotoneSlopes(x, y) {
  const count = x.length;
  if (count < 2) return [0];
  const h = x.slice(1).map((next, i) => next - x[i]);
  const secant = h.map((width, i) => (y[i + 1] - y[i]) / width);
  if (count === 2) return [secant[0], secant[0]];
  const slope = x.map((_, i) => {
    if (i === 0 || i === count - 1 || !(secant[i - 1] * secant[i] > 0)) return 0;
    const [before, after] = [2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]];
    return (before + after) / (before / secant[i - 1] + after / secant[i]);
  });
  slope[0] = endSlope(h[0], h[1], secant[0], secant[1]);
  slope[count - 1] = endSlope(h[count - 2], h[count - 3], secant[count - 2], secant[count - 3]);
  return slope;
}

/** The monotone piecewise cubic through points at rising x, as a function; constant beyond them. */
export function monotoneInterpolant(x, y) {
  const slope = monotoneSlopes(x, y);
  const last = x.length - 1;
  return (at) => {
    if (!(at > x[0])) return y[0];
    if (!(at < x[last])) return y[last];
    let i = 0;
    while (x[i + 1] <= at) ++i;
    const h = x[i + 1] - x[i];
    const t = (at - x[i]) / h;
    const s = 1 - t;
    const value = s * s * ((1 + 2 * t) * y[i] + t * h * slope[i]) +
      t * t * ((1 + 2 * s) * y[i + 1] - s * h * slope[i + 1]);
    return Math.min(Math.max(y[i], y[i + 1]), Math.max(Math.min(y[i], y[i + 1]), value));
  };
}

/** One channel's interpolant through [position, r, g, b] points, on the scale. */
function channelCurve(scale, points, channel) {
  const onScale = (value) => (scale === 'linear' ? value : Math.log(Math.max(value, kSmallestValue)));
  const curve = monotoneInterpolant(points.map(([position]) => position),
    points.map((point) => onScale(point[channel + 1])));
  if (scale === 'linear') return curve;
  const floor = Math.log(kSmallestValue) + 1e-12;
  return (position) => {
    const value = curve(position);
    return value > floor ? Math.exp(value) : 0;
  };
}

const kNodes = gaussLegendre(4);

/** The curve's average in each bin, [[r, g, b] × 256]. */
export function binsOfPoints(scale, points) {
  const curves = [0, 1, 2].map((channel) => channelCurve(scale, points, channel));
  return Array.from({ length: kBins }, (_, bin) => curves.map((curve) => kNodes.reduce(
    (sum, { x, weight }) => sum + 0.5 * weight * curve((bin + 0.5 * (1 + x)) / kBins), 0)));
}

/** A curve of an edit, {scale, points} or {values}, in bins. */
export function binsOfCurve(curve) {
  return curve.values ?? binsOfPoints(curve.scale, curve.points);
}

/**
 * A few points through which bins can be drawn: greedily where they are missed most. Values below
 * 10⁻⁴ of the largest do not count on the logarithmic scale.
 */
export function fittedPoints(bins, scale, most = 10) {
  const largest = Math.max(...bins.flat(), kSmallestValue);
  const onScale = (v) => (scale === 'linear' ? v / largest : Math.log10(Math.max(v / largest, 1e-4)) / 4);
  const pointAt = (bin) => [(bin + 0.5) / kBins, ...bins[bin]];
  const chosen = [0, kBins - 1];
  while (chosen.length < most) {
    const curves = [0, 1, 2].map((c) => channelCurve(scale, chosen.map(pointAt), c));
    let [worst, where] = [0.005, -1];
    for (let bin = 0; bin < kBins; ++bin) {
      const miss = Math.max(...curves.map((curve, c) =>
        Math.abs(onScale(curve((bin + 0.5) / kBins)) - onScale(bins[bin][c]))));
      if (miss > worst) [worst, where] = [miss, bin];
    }
    if (where < 0 || chosen.includes(where)) break;
    chosen.push(where);
    chosen.sort((a, b) => a - b);
  }
  return chosen.map(pointAt);
}
