// The page's arithmetic of curves, held to the library's.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { factorBins } from '../../web/js/brdf_models.js';
import { angleAt, binOf, binsOfCurve, binsOfPoints, fittedPoints, gaussLegendre, kBins,
  monotoneInterpolant, positionOf } from '../../web/js/curve_points.js';
import { energyOf } from '../../web/js/energy.js';

const numbers = JSON.parse(readFileSync(process.env.RIMLIGHT_CURVE_NUMBERS, 'utf8'));
const kAxes = ['half_angle', 'difference_angle'];

/** The library's bins are floats: 2⁻²³ of each, and of what it is made of. */
function assertSameBins(found, expected, relative, tiny, what) {
  assert.equal(found.length, kBins, what);
  for (let bin = 0; bin < kBins; ++bin) {
    for (let c = 0; c < 3; ++c) {
      const [a, b] = [found[bin][c], expected[bin][c]];
      assert.ok(Math.abs(a - b) <= relative * Math.abs(b) + tiny, `${what}, bin ${bin}: ${a}, ${b}`);
    }
  }
}

test('curves through points are the library\'s, on both scales', () => {
  assert.ok(numbers.points.length > 20);
  for (const { edit, bins } of numbers.points) {
    assertSameBins(binsOfCurve(edit), bins, 1e-6, 1e-12, JSON.stringify(edit));
  }
});

test('curves never leave what is between their points', () => {
  const [x, y] = [[0, 0.1, 0.15, 0.7, 0.9], [1, 5, 5, 0, 0.5]];
  const curve = monotoneInterpolant(x, y);
  let last = curve(0);
  for (let i = 0; i <= 1000; ++i) {
    const at = i / 1000;
    const value = curve(at);
    const piece = Math.max(0, x.findLastIndex((v) => v <= at));
    const ends = [y[piece], y[Math.min(piece + 1, 4)]];
    assert.ok(value >= Math.min(...ends) && value <= Math.max(...ends), String(at));
    if (at <= 0.1) assert.ok(value >= last);
    last = value;
  }
});

test('angles and positions belong together', () => {
  for (const axis of kAxes) {
    for (const position of [0, 0.01, 0.3, 0.999, 1]) {
      assert.ok(Math.abs(positionOf(axis, angleAt(axis, position)) - position) < 1e-12);
    }
    assert.equal(binOf(axis, angleAt(axis, 100.5 / kBins)), 100);
    assert.equal(binOf(axis, 7), kBins - 1);
  }
  for (const count of [1, 4, 8]) {
    const nodes = gaussLegendre(count);
    const power = 2 * count - 2; // exact up to 2 n − 1
    const integral = nodes.reduce((sum, { x, weight }) => sum + weight * x ** power, 0);
    assert.ok(Math.abs(integral - 2 / (power + 1)) < 1e-12, String(count));
  }
});

test('the factors of the models are the library\'s', () => {
  for (const { material, curves } of numbers.models) {
    for (const axis of kAxes) {
      const found = factorBins(material, axis);
      if (curves[axis] === null) {
        assert.equal(found, null, `${material.model} ${axis}`);
      } else {
        // Of a lobe's tail digits are lost in its exponent; of Fresnel's 0 only rounding is left.
        const [relative, tiny] = axis === 'half_angle' ? [2e-4, 1e-30] : [1e-6, 1e-12];
        assertSameBins(found, curves[axis], relative, tiny, `${material.model} ${axis}`);
      }
    }
  }
});

test('fitted points lead back to their curve', () => {
  for (const { material, curves } of numbers.models.filter(({ curves: c }) => c.half_angle)) {
    for (const scale of ['linear', 'logarithmic']) {
      const points = fittedPoints(curves.half_angle, scale, 14);
      assert.ok(points.length >= 2 && points.length <= 14);
      assert.ok(points.every(([position], i) => i === 0 || position > points[i - 1][0]));
      const again = binsOfPoints(scale, points);
      const largest = Math.max(...curves.half_angle.flat());
      const miss = Math.max(...again.flat().map((v, i) => Math.abs(v - curves.half_angle.flat()[i])));
      assert.ok(miss < 0.15 * largest, `${material.model} ${material.roughness} ${scale}: ${miss / largest}`);
    }
  }
  assert.deepEqual(fittedPoints(Array(kBins).fill([0, 0, 0]), 'logarithmic').length, 2);
});

const bins = (material, curve = {}) => Object.fromEntries(kAxes.map((axis) =>
  [axis, curve[axis] ? binsOfCurve(curve[axis]) : factorBins(material, axis)]));

test('the estimate of the energy is the library\'s to a few percent', () => {
  const cases = [...numbers.models.map((one) => ({ ...one, curve: {} })), ...numbers.drawn];
  assert.ok(cases.length >= 12);
  for (const { material, curve, albedo } of cases) {
    const { albedo: found, lobe } = energyOf(material, bins(material, curve));
    const text = `${material.model} ${material.roughness} ${material.exponent} ${JSON.stringify(Object.keys(curve))}`;
    assert.ok(Math.abs(found - albedo) < 0.05 * albedo, `${text}: ${found}, ${albedo}`);
    assert.ok(lobe <= found);
  }
  const { curves, albedo } = numbers.measured;
  const { albedo: found } = energyOf({ model: 'measured' }, curves, curves.rest);
  assert.ok(Math.abs(found - albedo) < 0.05 * albedo, `measured: ${found}, ${albedo}`);
});

test('no analytic model is warned of, and drawn curves that reflect too much are', () => {
  for (const { material } of numbers.models) {
    assert.ok(energyOf(material, bins(material)).albedo <= 1.02, material.model);
  }
  assert.ok(numbers.drawn.some(({ albedo }) => albedo > 1.5));
  for (const { material, curve, albedo } of numbers.drawn.filter((one) => one.albedo > 1.1)) {
    assert.ok(energyOf(material, bins(material, curve)).albedo > 1.02, String(albedo));
  }
});

test('an Ashikhmin–Shirley lobe reflects about its Fresnel share, whichever way it is brushed', () => {
  const brushed = { model: 'ashikhmin_shirley', albedo: [0, 0, 0], specular: [0.5, 0.5, 0.5],
    exponent: 500, exponent_across: 50 };
  const across = { ...brushed, exponent: 50, exponent_across: 500 };
  const [one, other] = [brushed, across].map((material) => energyOf(material, bins(material)).albedo);
  assert.ok(Math.abs(one - other) < 0.02);
  assert.ok(one > 0.5 && one < 1.02, String(one));
});
