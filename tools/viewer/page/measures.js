// Distances and angles that stay: the tool that places them, their marks and their list. They belong to the
// session and follow tissue, so that the page knows of them what the scene tells.

import {button, element, section, short, svg} from './elements.js';
import {iconButton} from './icons.js';
import {LineStroke} from './line_strokes.js';
import {distance, dot, length, minus} from './vectors.js';

const kClickPixels = 5;
const kUnits = {mm: ' mm', degrees: '°'};

/// mm between two places, or degrees at the second of three.
export function valueOf(places) {
  if (places.length === 2) return distance(...places);
  const [a, b] = [minus(places[0], places[1]), minus(places[2], places[1])];
  return Math.acos(Math.max(-1, Math.min(1, dot(a, b) / (length(a) * length(b))))) * 180 / Math.PI;
}
const textOf = (value, unit) => (unit === 'mm' ? short(value, 4) : value.toFixed(1)) + kUnits[unit];

/// The value now and, where tissue has changed it, at rest.
export function measureText({now, at_rest: atRest, unit}) {
  const text = textOf(now, unit), before = textOf(atRest, unit);
  return text === before ? text : `${text}, at rest ${before}`;
}

const besideLine = ([[x1, y1], [x2, y2]]) => ({x: (x1 + x2) / 2, y: (y1 + y2) / 2 - 8, 'text-anchor': 'middle'});
/// Outside of the corner, against the middle of its sides.
function besideCorner([a, corner, b]) {
  const side = ([x, y]) => {
    const far = Math.hypot(x - corner[0], y - corner[1]) || 1;
    return [(x - corner[0]) / far, (y - corner[1]) / far];
  };
  const [u, v] = [side(a), side(b)];
  const out = [-u[0] - v[0], -u[1] - v[1]], far = Math.hypot(...out) || 1;
  return {x: corner[0] + 10 * out[0] / far, y: corner[1] + 4 + 14 * out[1] / far,
          'text-anchor': out[0] / far < -0.4 ? 'end' : out[0] / far > 0.4 ? 'start' : 'middle'};
}

/// Marks of places in LPS mm; none where one is not seen.
export function measureMarks(view, places, words) {
  const pixels = places.map((place) => view.pixelOf(place));
  if (!pixels.every(Boolean)) return [];
  const at = pixels.map((pixel) => view.toCss(pixel));
  const text = svg('text', {class: 'measure-text', ...(at.length === 2 ? besideLine(at) : besideCorner(at))});
  text.textContent = words;
  return [svg('polyline', {class: 'measure', points: at.map((place) => place.join(',')).join(' ')}),
          ...at.map(([cx, cy]) => svg('circle', {class: 'measure-end', cx, cy, r: 3})), text];
}

/// `isNear` tells whether a place in LPS mm lies in the view's plane.
export function allMeasures(view, isNear) {
  return (view.session.scene.measures ?? []).flatMap((measure) =>
    measure.lps.every(isNear) ? measureMarks(view, measure.lps, measureText(measure)) : []);
}

/// Places one after the other: by a click, or where a drag begins and ends.
export class MeasureStroke extends LineStroke {
  constructor(tools, view) {
    super(tools, view);
    this.count = tools.name === 'angle' ? 3 : 2;
    this.places = [];  // {lps, rest}
    this.finding = Promise.resolve();
  }
  press({x, y}) {
    this.begin = [x, y];
    this.add(x, y);
  }
  move({x, y}) {
    const last = this.places.at(-1);
    if (!last) return;
    this.to = this.view.placeBeside(last.lps, ...this.view.toPixels(x, y));
    this.view.refresh();
  }
  lift({x, y}) {
    if (Math.hypot(x - this.begin[0], y - this.begin[1]) >= kClickPixels) this.add(x, y);
  }
  keep() {
    if (this.places.length === this.count - 1 && this.to) this.place({lps: this.to, rest: this.to});
    else this.cancel();
  }
  /// Places are found in the order in which they were asked for.
  add(x, y) {
    const found = this.placeAt(x, y);
    this.finding = this.finding.then(async () => this.place(await found, x, y));
  }
  place(found, x, y) {
    if (this.isOver) return;
    const last = this.places.at(-1);
    if (!found && !last) {
      this.app.say('There is nothing to measure from here');
      return this.end();
    }
    const beside = () => this.view.placeBeside(last.lps, ...this.view.toPixels(x, y));
    const place = found ?? {lps: beside(), rest: beside()};
    if (last && distance(place.rest, last.rest) === 0) return;
    this.places.push(place);
    this.to = null;
    if (this.places.length === this.count) this.done();
    else if (this.places.length > 1) this.app.say('Angle: the third place');
    this.view.refresh();
  }
  done() {
    const places = this.places.map(({lps}) => lps);
    this.session.event({kind: 'measure', points: this.places.map(({rest}) => rest)});
    this.app.say(textOf(valueOf(places), this.count === 2 ? 'mm' : 'degrees'));
    this.end();
  }
  /// The place as it is and was at rest; in slices outside of the volume it lies in the plane.
  async placeAt(x, y) {
    const at = this.view.toPixels(x, y);
    try {
      const hit = await this.pick(at, this.app.curtain.keysAt(this.view, x));
      if (hit) return {lps: hit.lps, rest: hit.rest_lps};
    } catch { /* nothing is known of it */ }
    if (this.view.name === '3d') return null;
    const lps = this.view.plane.lpsOf(...at);
    return {lps, rest: lps};
  }
  marks() {
    const places = [...this.places.map(({lps}) => lps), ...(this.to ? [this.to] : [])];
    if (places.length < 2) return [];
    const words = places.length === this.count ? textOf(valueOf(places), this.count === 2 ? 'mm' : 'degrees') : '';
    return measureMarks(this.view, places, words);
  }
}

/// The list in the panel.
export class MeasureList {
  constructor(app) {
    Object.assign(this, {app, session: app.session});
    this.list = element('ul', {class: 'list', 'aria-label': 'Measures'});
    this.row = element('div', {class: 'row'},
      button('Save as a table…', () => app.files.save('measures'), {id: 'save-measures'}),
      button('Take all away (Shift+M)', () => app.act('clear-measures')));
    this.root = section('Measures', true, this.list, this.row);
    this.session.on('scene', (scene) => this.refresh(scene?.measures ?? []));
    this.refresh([]);
  }
  refresh(measures) {
    const key = JSON.stringify(measures);
    if (key === this.key) return;
    this.key = key;
    this.row.hidden = !measures.length;
    this.list.replaceChildren(...measures.map((measure, i) => element('li', {},
      button(`${i + 1}. ${measure.name ? measure.name + ': ' : ''}${measureText(measure)}`,
             () => this.app.slices.setCursor(this.session.geometry.indexOfLps(measure.lps[measure.lps.length - 2])),
             {class: 'link', title: 'Cross-hair there'}),
      iconButton('remove', `Remove measure ${i + 1}`, () => this.session.event({kind: 'measure', remove: i + 1})))));
    if (!measures.length) this.list.append(element('li', {class: 'none'}, 'None: M measures a distance, N an angle'));
  }
}
