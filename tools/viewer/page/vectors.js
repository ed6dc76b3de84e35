// Vectors of three numbers as arrays: what cameras and planes need, no more.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const normalized = (a) => times(a, 1 / length(a));
export const distance = (a, b) => length(minus(a, b));

/// Turned about a unit axis, right-handed (Rodrigues' formula).
export function turned(a, axis, degrees) {
  const angle = degrees * Math.PI / 180;
  const c = Math.cos(angle);
  return add(add(times(a, c), times(cross(axis, a), Math.sin(angle))),
             times(axis, dot(axis, a) * (1 - c)));
}

/// A number of so many significant digits, without noise such as 0.30000000000000004.
export const rounded = (value, digits = 9) => Number(value.toPrecision(digits));
