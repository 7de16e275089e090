// Unit quaternions [x, y, z, w], and vectors [x, y, z]; right-handed, as in the protocol.

export const identity = Object.freeze([0, 0, 0, 1]);

/** First b, then a. */
export function multiply(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

export function normalized(v) {
  const length = Math.hypot(...v);
  return v.map((x) => x / length);
}

/** The turn by `radians` about a unit axis. */
export function axisAngle(axis, radians) {
  const s = Math.sin(radians / 2);
  return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(radians / 2)];
}

export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** A vector turned by a unit quaternion. */
export function rotated(q, v) {
  const t = cross(q, v).map((x) => 2 * x);
  const u = cross(q, t);
  return v.map((x, i) => x + q[3] * t[i] + u[i]);
}

/** The shortest turn that takes unit vector a to unit vector b. */
export function between(a, b) {
  const axis = cross(a, b);
  const cosine = dot(a, b);
  if (cosine < -0.999999) return axisAngle(normalized(Math.abs(a[0]) < 0.9 ? cross(a, [1, 0, 0]) : cross(a, [0, 1, 0])), Math.PI);
  return normalized([axis[0], axis[1], axis[2], 1 + cosine]);
}
