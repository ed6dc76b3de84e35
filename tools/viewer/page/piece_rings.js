// Three rings about the middle of a bone that a click has taken: each turns it about one of the patient's axes, the
// dot in the middle moves it. A press elsewhere keeps it.

import {svg} from './elements.js';
import {add, cross, dot, minus, normalized, times} from './vectors.js';

const kRings = {'axis-x': [1, 0, 0], 'axis-y': [0, 1, 0], 'axis-z': [0, 0, 1]};
const kRadius = 64, kNear = 9;  // CSS pixels
const kSides = 90;
const kEdgeOn = 0.25;  // of a ring's axis along the line of sight; below it the pointer goes along the ring's tangent

export class PieceRings {
  /// `stroke` has the bone in hand (grab_stroke.js).
  constructor(stroke) {
    Object.assign(this, {stroke, view: stroke.view, drag: null, near: null});
  }
  get turn() { return this.stroke.piece.turn; }

  middle() { return this.stroke.middleLps(); }
  at(lps) {
    const pixel = this.view.pixelOf(lps);
    return pixel && this.view.toCss(pixel);
  }
  /// A place on the ring about an axis, by an angle.
  placeOn(axis, radians) {
    const [u, v] = this.spanned(axis);
    const radius = kRadius / this.view.pixelsPerMm();
    return add(this.middle(), add(times(u, radius * Math.cos(radians)), times(v, radius * Math.sin(radians))));
  }
  spanned(axis) {
    const u = axis[0] ? [0, 1, 0] : [1, 0, 0];
    return [u, cross(axis, u)];
  }
  points(axis) {
    return Array.from({length: kSides}, (_, n) => this.at(this.placeOn(axis, 2 * Math.PI * n / kSides)));
  }
  /// The ring under the pointer, 'middle', or null.
  under({x, y}) {
    const far = (point) => point ? Math.hypot(point[0] - x, point[1] - y) : Infinity;
    if (far(this.at(this.middle())) < kNear + 3) return 'middle';
    const [name, near] = Object.entries(kRings).map(([name, axis]) => [name, Math.min(...this.points(axis).map(far))])
      .reduce((best, one) => one[1] < best[1] ? one : best);
    return near < kNear ? name : null;
  }

  /// The angle about a ring's axis at which the pointer's ray meets its plane.
  angleAt(axis, x, y) {
    const {origin, direction} = this.view.rayAt(...this.view.toPixels(x, y));
    const to = minus(add(origin, times(direction, dot(minus(this.middle(), origin), axis) / dot(direction, axis))), this.middle());
    const [u, v] = this.spanned(axis);
    return Math.atan2(dot(to, v), dot(to, u));
  }
  /// Degrees by which the pointer has led a ring since it was pressed.
  led(name, {x, y}) {
    const axis = kRings[name], {forward} = this.view.directions(), {from} = this.drag;
    if (Math.abs(dot(axis, forward)) > kEdgeOn) {
      const degrees = (this.angleAt(axis, x, y) - this.angleAt(axis, from.x, from.y)) * 180 / Math.PI;
      return (degrees - this.drag.degrees + 540) % 360 - 180 + this.drag.degrees;  // more than half a turn, too
    }
    const [way, back] = [0.02, -0.02].map((step) => this.at(this.placeOn(axis, this.drag.radians + step)));
    const tangent = [way[0] - back[0], way[1] - back[1]], size = dot([...tangent, 0], [...tangent, 0]);
    return ((x - from.x) * tangent[0] + (y - from.y) * tangent[1]) / size * 0.04 * 180 / Math.PI;
  }
  /// The nearest place of the ring in front, as an angle.
  radiansUnder(axis, {x, y}) {
    const {forward} = this.view.directions();
    const cost = (n) => {
      const lps = this.placeOn(axis, 2 * Math.PI * n / kSides), point = this.at(lps);
      return (point ? Math.hypot(point[0] - x, point[1] - y) : Infinity) + (dot(minus(lps, this.middle()), forward) > 0 ? kNear : 0);
    };
    const best = Array.from({length: kSides}, (_, n) => n).reduce((a, b) => cost(b) < cost(a) ? b : a);
    return 2 * Math.PI * best / kSides;
  }

  /// A ring that keys choose: a number is degrees about it.
  choose(name) {
    this.turn.end();
    this.stroke.axis = name;
    this.turn.begin();
  }
  press(place) {
    const what = this.under(place);
    this.drag = {what, from: place, degrees: 0};
    this.stroke.typed = '';
    if (what === 'middle') return this.stroke.movesFrom(place);
    if (!what) return;
    this.drag.radians = this.radiansUnder(kRings[what], place);
    this.choose(what);
  }
  move(place) {
    this.near = this.drag?.what ?? this.under(place);
    if (this.drag?.what in kRings) {
      this.drag.degrees = this.led(this.drag.what, place);
      const sense = dot(kRings[this.drag.what], this.view.directions().forward) < 0 ? -1 : 1;
      this.turn.swept = this.drag.degrees * sense;
    }
    if (this.drag?.what) this.stroke.follow(place.time);
    this.view.refresh();
  }
  /// False where the press was beside all of it.
  lift() {
    const what = this.drag?.what;
    this.drag = null;
    this.turn.end();
    this.stroke.axis = null;
    return Boolean(what);
  }

  marks() {
    const middle = this.at(this.middle());
    if (!middle) return [];
    const rings = Object.entries(kRings).flatMap(([name, axis]) => {
      const points = this.points(axis);
      const isLed = this.near === name || this.stroke.axis === name;
      return points.every(Boolean) ? [svg('polygon', {class: `ring ${name}${isLed ? ' led' : ''}`, points: points.map((p) => p.join(',')).join(' ')})] : [];
    });
    return [...rings, svg('circle', {class: 'handle', cx: middle[0], cy: middle[1], r: 6})];
  }
}
