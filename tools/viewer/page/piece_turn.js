// Turning of a bone in hand: the pointer sweeps an angle about the middle of the bone as it is seen,
// about the line of sight or one of the patient's axes; a number is an amount in degrees.

import {svg} from './elements.js';
import {add, cross, dot, length, normalized, times} from './vectors.js';

/// Quaternions [w, [x, y, z]] of turns.
const kNone = [1, [0, 0, 0]];
const product = ([w, v], [w2, v2]) => [w * w2 - dot(v, v2), add(add(times(v2, w), times(v, w2)), cross(v, v2))];
export function quaternion(axis, degrees) {
  const half = degrees * Math.PI / 360;
  return [Math.cos(half), times(normalized(axis), Math.sin(half))];
}
/// Axis times angle in degrees, 0 to 180.
export function turnVector([w, v]) {
  const sine = length(v);
  if (sine < 1e-12) return [0, 0, 0];
  return times(v, 2 * Math.atan2(sine, Math.abs(w)) * 180 / Math.PI * (w < 0 ? -1 : 1) / sine);
}

export class PieceTurn {
  constructor() {
    this.before = kNone;  // turns that ended before this one
    this.isOn = false;
    this.restart();
  }
  restart() {
    this.swept = 0;  // degrees clockwise, as seen
    this.now = kNone;
    this.bearing = null;
  }
  begin() {
    this.isOn = true;
    this.restart();
  }
  /// What was turned so far stays; the next one begins there.
  end() {
    if (this.isOn) this.before = product(this.now, this.before);
    this.isOn = false;
    this.restart();
  }
  nudge(degrees) { this.swept += degrees; }

  /// The pointer at a place beside the middle of the bone, both in pixels.
  sweep([x, y], [mx, my]) {
    if (Math.hypot(x - mx, y - my) < 3) return;  // there it has no bearing
    const bearing = Math.atan2(y - my, x - mx) * 180 / Math.PI;
    if (this.bearing !== null) this.swept += (bearing - this.bearing + 540) % 360 - 180;
    this.bearing = bearing;
  }
  /// Turns about an axis in LPS, else about the line of sight, by an amount where one was typed.
  lead(forward, axis, amount) {
    const sense = axis && dot(axis, forward) < 0 ? -1 : 1;
    this.degrees = amount ?? Math.round(this.swept * sense * 10) / 10;
    this.now = quaternion(axis ?? forward, this.degrees);
  }
  /// LPS axis times degrees of the whole turn.
  vector() { return turnVector(product(this.now, this.before)); }

  /// The angle about the middle, in CSS pixels.
  marks([mx, my], [x, y]) {
    const radius = Math.max(12, Math.hypot(x - mx, y - my));
    const from = (this.bearing - this.swept) * Math.PI / 180;
    return [svg('circle', {class: 'brush', cx: mx, cy: my, r: radius}),
            svg('line', {class: 'way', x1: mx, y1: my, x2: mx + radius * Math.cos(from), y2: my + radius * Math.sin(from)}),
            svg('line', {class: 'way', x1: mx, y1: my, x2: x, y2: y})];
  }
}
