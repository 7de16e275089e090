// What the page keeps of edited materials, and how edits become one.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { applied, axesOf, channelValue, kNothing, shownMaterial, withChannel } from '../../web/js/curve_state.js';
import { preset, presetNames } from '../../web/js/curve_presets.js';
import { merged, mergedMaterials } from '../../web/js/edits.js';

const baked = { name: 'pearl', model: 'cook_torrance', roughness: 0.3, exponent: 50, eta: [1.5, 1.5, 1.5],
  k: [0, 0, 0], albedo: [0.5, 0.5, 0.5], specular: [1, 1, 1], axes: ['half_angle', 'difference_angle'] };
const flat = { scale: 'linear', points: [[0, 1, 1, 1]] };
const steep = { scale: 'logarithmic', points: [[0, 9, 9, 9], [1, 0, 0, 0]] };
const set = (values) => ({ parameter: { pearl: values } });
const draw = (axes) => ({ curve: { pearl: axes } });
const load = (measured) => ({ load: { pearl: measured } });
const kChanges = [set({ roughness: 0.1 }), set({ eta: 2, k: [1, 2, 3] }), draw({ half_angle: flat }),
  draw({ half_angle: steep, difference_angle: flat }), draw({ half_angle: null }), load('gold'),
  load(null), set(null), { ...set(null), ...load('gold') }, { ...set({ roughness: 0.9 }), ...draw({ half_angle: flat }) }];

test('a change is applied as the server does it', () => {
  const all = [set({ roughness: 0.1 }), draw({ half_angle: flat, difference_angle: steep }), load('gold'),
    draw({ difference_angle: null })].reduce(applied, kNothing);
  assert.deepEqual(all, { parameter: { pearl: { roughness: 0.1 } }, curve: { pearl: { half_angle: flat } },
    load: { pearl: 'gold' } });
  assert.deepEqual(applied(all, set(null)), kNothing);
  assert.deepEqual(applied(all, { ...set(null), ...load('silk') }), { ...kNothing, load: { pearl: 'silk' } });
  assert.deepEqual(applied(all, draw({ half_angle: null })).curve, {});
});

test('edits of one frame become one that does the same', () => {
  let count = 0;
  for (const first of kChanges) {
    for (const second of kChanges) {
      const both = mergedMaterials(first, second);
      const expected = applied(applied(kNothing, first), second);
      if (both === null) {
        assert.ok(first.parameter.pearl === null && second.parameter.pearl !== null);
        continue;
      }
      assert.deepEqual(applied(kNothing, both), expected, JSON.stringify([first, second]));
      count += 1;
    }
  }
  assert.ok(count > 80);
  const light = merged({ exposure: 1, material: draw({ half_angle: flat }) }, { exposure: 2 });
  assert.deepEqual(light, { exposure: 2, material: draw({ half_angle: flat }) });
  assert.deepEqual(merged({ material: draw({ half_angle: flat }) }, { material: set(null) }).material, set(null));
});

test('a channel is set alone, and all of them in their ratio', () => {
  assert.deepEqual(withChannel([1, 2, 4], 'all', 2), [0.5, 1, 2]);
  assert.deepEqual(withChannel([0, 0, 0], 'all', 3), [3, 3, 3]);
  assert.deepEqual(withChannel([1, 2, 4], '1', 9, [0, 5]), [1, 5, 4]);
  assert.equal(channelValue([1, 2, 4], 'all'), 4);
  assert.equal(channelValue([1, 2, 4], '0'), 1);
  assert.deepEqual(axesOf({ model: 'ward', axes: [] }), []);
  assert.equal(axesOf(shownMaterial({ ...baked, axes: [] }, applied(kNothing, load('gold')))).length, 2);
});

test('presets fit what they are for', () => {
  assert.deepEqual(presetNames({ model: 'lambert' }, []), []);
  assert.ok(presetNames(baked, baked.axes).includes('pearl'));
  assert.ok(!presetNames({ model: 'ward' }, []).includes('cloth'));
  assert.ok(presetNames({ model: 'ward' }, []).includes('brushed'));
  const { half_angle: { points } } = preset('pearl', baked, () => 7);
  assert.ok(points.every(([position], i) => i === 0 || position > points[i - 1][0]));
  const [, highest] = points[0];
  assert.ok(Math.abs(preset('pearl', baked, () => 14).half_angle.points[0][1] / highest - 0.5) < 1e-12);
  assert.equal(preset('gloss', baked).parameters.roughness, 0.06);
});
