// Lines drawn in a view: a cut swept from the line into the tissue.

import {short, svg} from './elements.js';
import {simplified, strokeLength} from './strokes.js';
import {add, minus} from './vectors.js';

const kMostPoints = 32, kClickPixels = 5;

export class LineStroke {
  constructor(tools, view) {
    Object.assign(this, {tools, view, app: tools.app, session: tools.app.session});
    this.points = [];  // pixels of the picture
  }
  cancel() {
    if (!this.isOver) this.app.say('Nothing was drawn');
    this.end();
  }
  end() {
    this.isOver = true;
    this.tools.ended(this);
  }
  connectionChanged() { this.end(); }
  pick(at, more = {}) { return this.session.ask('pick', {view: this.view.name, at, ...more}); }
}

export class CutStroke extends LineStroke {
  press({x, y}) {
    this.isPressed = true;
    this.begin = this.view.toPixels(x, y);
    this.points.push(this.begin);
    this.view.refresh();
  }
  move({x, y}) {
    this.at = this.view.toPixels(x, y);
    if (this.isPressed) this.points.push(this.at);
    this.view.refresh();
  }
  lift() {
    this.isPressed = false;
    const since = this.points.slice(this.points.lastIndexOf(this.begin));
    const isClick = strokeLength(since) * this.view.fit().scale < kClickPixels;
    if (!isClick) return this.keep();
    this.points.splice(this.points.lastIndexOf(this.begin) + 1);
    this.app.say('Cut: click the next point, Enter or double click cuts, Esc cancels');
  }

  /// The line as it was drawn, in few points.
  line() {
    const scale = this.view.fit().scale;
    let tolerance = 1.5;
    let points = simplified(this.points, tolerance / scale);
    while (points.length > kMostPoints) points = simplified(this.points, (tolerance *= 1.5) / scale);
    return points.filter(([x, y], i) => i === 0 || Math.hypot(x - points[i - 1][0], y - points[i - 1][1]) * scale >= 1);
  }

  async keep() {
    const line = this.line();
    if (line.length < 2 || this.isBusy) return this.app.say('A cut needs a line of at least two points');
    this.isBusy = true;
    try {
      const curve = this.view.name === '3d' ? await this.intoTissue(line) : await this.acrossSlice(line);
      if (this.isOver) return;
      if (curve) {
        this.session.event({kind: 'cut', curve});
        this.app.say(`Cut along ${curve.points.length} points, ${short(curve.depth, 3)} mm deep`);
      } else {
        this.app.say('There is no tissue under the line');
      }
    } catch (error) {
      this.app.say(error.message);
    }
    this.end();
  }

  /// From the surface under the line away from the viewer. Cuts are made in the body at rest; beside the
  /// tissue the line goes on at the depth of the nearest place that was hit.
  async intoTissue(line) {
    const hits = await Promise.all(line.map((at) => this.pick(at)));
    const known = hits.flatMap((hit, i) => hit ? [i] : []);
    if (!known.length) return null;
    const points = hits.map((hit, i) => {
      if (hit) return hit.rest_lps;
      const near = hits[known.reduce((best, k) => Math.abs(k - i) < Math.abs(best - i) ? k : best)];
      const beside = this.view.placeBeside(near.lps, ...line[i]);
      return add(beside, minus(near.rest_lps, near.lps));
    });
    const middle = hits[known[Math.floor(known.length / 2)]];
    const {cutDepth, cutAbove} = this.app.settings;
    return {points, direction: middle.ray.direction, depth: cutDepth, above: cutAbove, straight: true};
  }

  /// Across the slice, half of the depth to each side.
  async acrossSlice(line) {
    const hits = await Promise.all(line.map((at) => this.pick(at)));
    const points = line.map(([x, y], i) => hits[i]?.rest_lps ?? this.view.plane.lpsOf(x, y));
    if (!hits.some((hit) => hit?.element)) return null;
    const half = this.app.settings.cutDepth / 2;
    return {points, direction: this.view.directions().forward, depth: half, above: half, straight: true};
  }

  marks() {
    const points = this.at && !this.isPressed ? [...this.points, this.at] : this.points;
    const places = points.map((point) => this.view.toCss(point).join(',')).join(' ');
    const dots = this.points.length < 40 && !this.isPressed ? this.points : [this.points[0]];
    return [svg('polyline', {class: 'cut-line', points: places}), ...dots.map((point) => {
      const [cx, cy] = this.view.toCss(point);
      return svg('circle', {class: 'cut-point', cx, cy, r: 3});
    })];
  }
}
