// What the page makes of a file before it sends it; no browser needed.
import assert from 'node:assert/strict';
import test from 'node:test';

import { environmentName, isUploaded, LARGEST_UPLOAD, reasonOf, uploadFault } from '../../web/js/environment_upload.js';

test('a file becomes a name that URLs have', () => {
  assert.equal(environmentName('grace_probe.hdr'), 'grace_probe');
  assert.equal(environmentName('Große Halle (2).exr'), 'Gro_e_Halle_2_');
  assert.equal(environmentName('naïve.hdr'), 'nai_ve');
  assert.equal(environmentName('日本.hdr'), 'environment');
  assert.equal(environmentName('../../etc/passwd.hdr'), '.._.._etc_passwd');
  assert.equal(environmentName('a.b.hdr'), 'a.b');
  for (const file of ['x'.repeat(300), '...', '', 'a/b?c#d&e=f%00.exr']) {
    assert.match(environmentName(file), /^[A-Za-z0-9._-]{1,64}$/, file);
    assert.match(environmentName(file), /[A-Za-z0-9]/, file);
  }
});

test('other files and larger ones are not sent', () => {
  assert.equal(uploadFault({ name: 'a.hdr', size: LARGEST_UPLOAD }), '');
  assert.equal(uploadFault({ name: 'A.EXR', size: 1 }), '');
  assert.match(uploadFault({ name: 'a.hdr', size: LARGEST_UPLOAD + 1 }), /larger than 32 MiB/);
  assert.match(uploadFault({ name: 'a.jpg', size: 1 }), /a\.jpg is no/);
});

test('only what was uploaded is offered to be deleted', () => {
  assert.equal(isUploaded('probe', ['sunny', 'studio']), true);
  assert.equal(isUploaded('sunny', ['sunny', 'studio']), false);
  assert.equal(isUploaded('probe', null), false); // nothing is known of the scene yet
  assert.equal(isUploaded('', ['sunny']), false);
});

test('a refusal says its reason, in JSON or in words', () => {
  assert.equal(reasonOf('{"type":"error","reason":"in use"}'), 'in use');
  assert.equal(reasonOf('nothing is here\n'), 'nothing is here');
});
