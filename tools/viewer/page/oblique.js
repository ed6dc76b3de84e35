// Slices that are turned: each line of a slice stands for another one, and its dots turn that one about the line
// of sight, through the cross-hair. The session has the axes of turned slices; straight ones follow the grid.

import {svg} from './elements.js';
import {planeInBox} from './geometry.js';
import {Grip} from './grips.js';
import {add, cross, dot, minus, normalized, times, turned} from './vectors.js';

const kSnapDegrees = 0.3;  // to the straight slice
const kGap = 7, kOut = 0.78, kLeastOut = 34, kLeastSize = 200;  // CSS pixels; of the way to the border
/// The slices that upright and level lines stand for where all are straight.
const kLines = {axial: ['sagittal', 'coronal'], coronal: ['sagittal', 'axial'], sagittal: ['coronal', 'axial']};

const squared = ({right, down}) => {
  const across = normalized(right);
  return {right: across, down: normalized(minus(down, times(across, dot(down, across))))};
};
/// Axes turned about a unit vector in LPS, right-handed; null where that is nearly the straight slice.
export function turnedAxes({right, down}, about, degrees, straight) {
  const axes = squared({right: turned(right, about, degrees), down: turned(down, about, degrees)});
  return degreesBetween(axes, straight) < kSnapDegrees ? null : axes;
}
/// Angle of the turn from one slice to another.
export function degreesBetween(a, b) {
  const away = (axes) => cross(axes.right, axes.down);
  const trace = dot(a.right, b.right) + dot(a.down, b.down) + dot(away(a), away(b));
  return Math.acos(Math.min(1, Math.max(-1, (trace - 1) / 2))) * 180 / Math.PI;
}
/// Of a slice of a session: its axes as they were asked for last.
export const axesOf = (app, name) => app.slices.now.turned?.[name] ?? app.session.scene.volume.straight[name];
export const isTurned = (app, name) => Boolean(app.slices.now.turned?.[name]);
export function setTurned(app, name, axes) {
  const {[name]: before, ...others} = app.slices.now.turned ?? {};
  app.slices.set({turned: axes ? {...others, [name]: axes} : others});
}
/// Where turned slices lie along their normal: [least, most] of the volume's box and the cross-hair, in mm, and the unit normal.
export function reachOf(app, name, patientAxis) {
  const {right, down} = axesOf(app, name);
  const away = cross(right, down);
  const normal = times(away, away[patientAxis] < 0 ? -1 : 1);
  const mm = app.session.geometry.corners().map((corner) => dot(corner, normal));
  return {least: Math.min(...mm), most: Math.max(...mm), now: dot(app.slices.cursorLps(), normal), normal};
}
/// The cross-hair led to a turned slice so far along the normal, within the volume.
export function cursorAt(geometry, cursor, {normal, now}, mm) {
  const to = add(cursor, times(normal, mm - now)), index = geometry.indexOfLps(to);
  const isInside = index.every((v, a) => v >= 0 && v <= geometry.dims[a] - 1);
  const corners = isInside ? [] : planeInBox(geometry, to, normal);
  return corners.length ? geometry.indexOfLps(corners.reduce((sum, c) => add(sum, times(c, 1 / corners.length)), [0, 0, 0])) : index;
}

/// The lines of one slice.
export class SliceLines {
  constructor(view) {
    Object.assign(this, {view, app: view.app});
    this.lines = kLines[view.name].map((name) => ({name, grips: [1, -1].map((side) => this.grip(name, side))}));
  }

  grip(name, side) {
    const {app, view} = this;
    let before, middle;
    const turn = (from, degrees) => {
      const straight = app.session.scene.volume.straight[name];
      const axes = turnedAxes(from, view.directions().forward, degrees, straight);
      setTurned(app, name, axes);
      const told = axes ? `turned by ${degreesBetween(axes, straight).toFixed(1)}°` : 'straight';
      app.say(`${name[0].toUpperCase() + name.slice(1)} slice: ${told}`);
    };
    return new Grip(view, {
      look: 'turn ' + name, label: `Turn the ${name} slice`, tabindex: side > 0 ? 0 : -1,
      hint: 'drag, or arrow keys: 1° (Shift: 10°); a double click straightens it',
      begins: () => {
        before = axesOf(app, name);
        middle = view.toCss(view.pixelOf(app.slices.cursorLps()));
      },
      moves: (to, from) => {
        const bearing = ([x, y]) => Math.atan2(y - middle[1], x - middle[0]) * 180 / Math.PI;
        turn(before, Math.round(10 * (bearing(to) - bearing(from))) / 10);
      },
      steps: (right, up) => turn(axesOf(app, name), right - up), twice: () => setTurned(app, name, null)});
  }

  /// Lines in the colours of the slices that they stand for, free in the middle, with their grips.
  marks() {
    const {view, app} = this;
    const {right, up, forward} = view.directions();
    const place = app.slices.cursorLps();
    const [w, h] = [view.picture.clientWidth, view.picture.clientHeight];
    const at = place && app.settings.crosshair ? view.toCss(view.pixelOf(place)) : null;
    return this.lines.flatMap(({name, grips}) => {
      const axes = axesOf(app, name);
      const along = cross(cross(axes.right, axes.down), forward);
      const way = [dot(along, right), -dot(along, up)], size = Math.hypot(...way);
      if (!at || size < 1e-3) {
        for (const grip of grips) grip.place(null);
        return [];
      }
      const degrees = degreesBetween(axes, app.session.scene.volume.straight[name]);
      return grips.map((grip, n) => {
        const [dx, dy] = way.map((v) => v / size * (n ? -1 : 1));
        const point = (far) => [at[0] + dx * far, at[1] + dy * far];
        // The border, or far beyond where the cross-hair is out of sight.
        const border = Math.min(dx > 0 ? (w - at[0]) / dx : dx < 0 ? -at[0] / dx : Infinity,
                                dy > 0 ? (h - at[1]) / dy : dy < 0 ? -at[1] / dy : Infinity);
        const isSeen = at[0] > 0 && at[0] < w && at[1] > 0 && at[1] < h;
        const out = Math.max(kLeastOut, kOut * border);
        grip.place(isSeen && out < border && Math.min(w, h) >= kLeastSize ? point(out) : null, Math.round(degrees), `${degrees.toFixed(1)}°`);
        const [[x1, y1], [x2, y2]] = [point(kGap), point(w + h)];
        return svg('line', {class: 'cross ' + name, x1, y1, x2, y2});
      });
    });
  }
}
