// A slice: cross-hair, scrolling, zoom, window and level. What the slices share (cursor, window, zoom)
// is kept here as it was last asked for, until the server has said it.

import {element, show} from './elements.js';
import {PixelPlane} from './geometry.js';
import {iconButton} from './icons.js';
import {axesOf, cursorAt, degreesBetween, isTurned, reachOf, setTurned, SliceLines} from './oblique.js';
import {add, cross, dot, minus, normalized, times} from './vectors.js';
import {View} from './view.js';

/// Planes by the patient's axis that they are across, in 3D Slicer's colours (style.css).
export const kPlanes = {axial: 2, coronal: 1, sagittal: 0};

/// The verb `slices`: values asked for are sent once per frame of the screen.
export class Slices {
  constructor(session) {
    this.session = session;
    this.asked = {};
    this.unanswered = 0;
    session.on('connection', () => {
      this.asked = {};
      this.unanswered = 0;
    });
  }
  get now() { return {...this.session.scene?.slices, ...this.asked}; }

  set(values) {
    if (!this.session.scene) return;
    if (values.centre) values.centre = {...this.now.centre, ...values.centre};
    Object.assign(this.asked, values);
    this.unsent = {...this.unsent, ...values};
    this.request ??= requestAnimationFrame(() => this.send());
    this.session.tell('slices', this.now);
  }

  async send() {
    const values = this.unsent;
    this.request = this.unsent = null;
    ++this.unanswered;
    try {
      const slices = await this.session.ask('slices', values);
      if (this.session.scene) this.session.scene.slices = {...this.session.scene.slices, ...slices};
    } catch (error) {
      this.session.addLog({level: 'error', text: error.message});
    }
    this.unanswered = Math.max(0, this.unanswered - 1);
    if (!this.unanswered && !this.request) this.asked = {};
    this.session.tell('slices', this.now);
  }

  /// A window by a person, which is remembered.
  chooseWindow(values) {
    this.set(values);
    const {window, level} = this.now;
    this.session.tell('chosen', {window, level});
  }

  setCursor(index) { this.set({cursor: this.session.geometry.clamped(index)}); }
  cursorLps() {
    const cursor = this.now.cursor;
    return cursor && this.session.geometry ? this.session.geometry.lpsOfIndex(cursor) : null;
  }
}

export class SliceView extends View {
  constructor(app, name) {
    super(app, name, name[0].toUpperCase() + name.slice(1));
    this.slider = element('input', {
      type: 'range', min: 0, max: 0, step: 1, value: 0, disabled: true,
      'aria-label': `${this.title} slice`, oninput: () => this.goTo(this.slider.valueAsNumber)});
    this.offset = element('output', {class: 'offset'});
    this.bar.append(this.slider, this.offset, iconButton('fit', `Fit the ${name} slice`, () => this.centre(), {class: 'fit'}), app.layout.button(this));
    this.lines = new SliceLines(this);
    this.session.on('slices', () => this.refresh());
  }

  get axis() { return this.session.geometry.axisNearest(kPlanes[this.name]); }
  get plane() { return this.frame ? new PixelPlane(this.frame.plane) : null; }

  refresh() {
    super.refresh();
    const {geometry} = this.session;
    const cursor = this.app.slices?.now.cursor;
    this.slider.disabled = !(geometry && cursor);
    if (this.slider.disabled) return;
    if (isTurned(this.app, this.name)) return this.refreshTurned();
    Object.assign(this.slider, {min: 0, max: geometry.dims[this.axis] - 1, step: 1});
    show(this.slider, Math.round(cursor[this.axis]));
    const mm = geometry.lpsOfIndex(cursor)[kPlanes[this.name]];
    const letter = ['LR', 'PA', 'SI'][kPlanes[this.name]][mm < 0 ? 1 : 0];
    this.offset.textContent = `${letter} ${Math.abs(mm).toFixed(1)} mm`;
    this.slider.setAttribute('aria-valuetext', this.offset.textContent);
  }

  /// Of a turned slice: mm along its normal, and the angle.
  refreshTurned() {
    const {least, most, now} = this.reach;
    Object.assign(this.slider, {min: least, max: most, step: Math.min(...this.session.geometry.spacing) / 2});
    show(this.slider, now);
    const degrees = degreesBetween(axesOf(this.app, this.name), this.session.scene.volume.straight[this.name]);
    this.offset.textContent = `turned ${degrees.toFixed(1)}°`;
    this.slider.setAttribute('aria-valuetext', `${now.toFixed(1)} mm, ${this.offset.textContent}`);
  }
  get reach() { return reachOf(this.app, this.name, kPlanes[this.name]); }

  goTo(value) {
    if (isTurned(this.app, this.name)) {
      const {geometry} = this.session, {reach} = this;
      const mm = Math.min(reach.most, Math.max(reach.least, value));
      return this.app.slices.setCursor(cursorAt(geometry, this.app.slices.cursorLps(), reach, mm));
    }
    const cursor = [...this.app.slices.now.cursor];
    cursor[this.axis] = value;
    this.app.slices.setCursor(cursor);
  }
  /// `steps` slices towards left, posterior or superior.
  scroll(steps) {
    const {geometry} = this.session;
    if (!geometry) return;
    if (isTurned(this.app, this.name)) return this.goTo(this.reach.now + steps * Math.min(...geometry.spacing));
    const cursor = this.app.slices.now.cursor;
    const up = Math.sign(geometry.axes[this.axis][kPlanes[this.name]]);
    this.goTo(Math.round(cursor[this.axis]) + up * steps);
  }

  motionOf({button, shift, ctrl}) {
    if (!this.plane) return null;
    if (button === 1 || (button === 0 && (shift || ctrl))) return this.moves;
    if (button === 2) return this.zooms;
    if (button !== 0) return null;
    return this.app.tools.name === 'window-level' ? this.windows : this.crosshair;
  }
  motionStarts(place) {
    if (this.motion === this.crosshair) this.crosshair(place);
  }
  crosshair({x, y}) {
    const {geometry} = this.session;
    this.app.slices.setCursor(geometry.indexOfLps(this.onSlice(x, y)));
  }
  /// The place under the pointer; across the slice it is where the slice is.
  onSlice(x, y) { return this.plane.lpsOf(...this.toPixels(x, y)); }
  hovers(place) {
    if (place.shift && this.plane) this.crosshair(place);
  }

  zooms({dy}) { this.zoomBy(1.1 ** (dy * 20 / this.picture.clientHeight)); }
  zoomBy(factor) {
    this.app.slices.set({zoom: Math.min(64, Math.max(0.1, (this.app.slices.now.zoom ?? 1) * factor))});
  }
  moves({dx, dy}) {
    const {plane} = this;
    const {geometry} = this.session;
    const [px, py] = this.toPixels(this.picture.clientWidth / 2 - dx, this.picture.clientHeight / 2 - dy);
    const sent = this.app.slices.now.centre?.[this.name];
    const from = geometry.indexOfLps(plane.lpsOf(...this.toPixels(this.picture.clientWidth / 2, this.picture.clientHeight / 2)));
    const to = geometry.indexOfLps(plane.lpsOf(px, py));
    const centre = (sent ?? from).map((value, a) => value + to[a] - from[a]);
    this.app.slices.set({centre: {[this.name]: centre}});
  }
  windows({dx, dy}) {
    const {window, level} = this.app.slices.now;
    const [low, high] = this.session.scene.volume.density;
    const step = (high - low) / 1000;
    this.app.slices.chooseWindow({window: Math.max(step, window + dx * step), level: level + dy * step});
  }
  pinch({dx, dy, factor}) {
    if (!this.plane) return;
    this.moves({dx, dy});
    this.zoomBy(factor);
  }
  wheelTurned({dx, dy, ctrl}) {
    if (ctrl) return this.zoomBy(1.1 ** -(dx + dy));
    const turned = (this.wheelRest ?? 0) - (dx + dy);
    const whole = Math.trunc(turned) || Math.sign(turned) * (Math.abs(turned) >= 0.25 ? 1 : 0);
    this.wheelRest = whole ? 0 : turned;
    if (whole) this.scroll(whole);
  }

  act(action) {
    if (!this.session.scene) return false;
    const cursors = {'crosshair-left': [-1, 0], 'crosshair-right': [1, 0], 'crosshair-up': [0, -1], 'crosshair-down': [0, 1]};
    if (action === 'slice-next') this.scroll(1);
    else if (action === 'slice-previous') this.scroll(-1);
    else if (action === 'zoom-in') this.zoomBy(1.1);
    else if (action === 'zoom-out') this.zoomBy(1 / 1.1);
    else if (action in cursors && this.plane) this.stepCursor(...cursors[action]);
    else return false;
    return true;
  }
  /// By a voxel along the grid axis that the picture's direction lies nearest to; within a turned slice as far.
  stepCursor(right, down) {
    const {geometry} = this.session;
    const way = right ? times(this.plane.right, right) : times(this.plane.down, down);
    if (isTurned(this.app, this.name)) {
      const step = times(normalized(way), Math.min(...geometry.spacing));
      return this.app.slices.setCursor(geometry.indexOfLps(add(this.app.slices.cursorLps(), step)));
    }
    const along = geometry.axes.map((axis) => dot(normalized(axis), normalized(way)));
    const axis = along.reduce((best, value, a) => Math.abs(value) > Math.abs(along[best]) ? a : best, 0);
    const cursor = this.app.slices.now.cursor.map(Math.round);
    cursor[axis] += Math.sign(along[axis]);
    this.app.slices.setCursor(cursor);
  }
  centre() {
    const {geometry} = this.session;
    if (!geometry) return;
    this.app.slices.set({zoom: 1, centre: {[this.name]: geometry.dims.map((n) => (n - 1) / 2)}});
  }
  reset() {
    this.centre();
    if (isTurned(this.app, this.name)) setTurned(this.app, this.name, null);
  }

  directions() {
    const {plane} = this;
    if (!plane) return null;
    const right = normalized(plane.right), up = normalized(times(plane.down, -1));
    return {right, up, forward: cross(up, right)};
  }
  pixelOf(lps) { return this.plane && lps ? this.plane.pixelOf(lps) : null; }
  pixelsPerMm() { return this.fit().scale / this.plane.mmPerPixel(); }
  /// mm from the slice to a place.
  distanceOf(lps) { return Math.abs(dot(minus(lps, this.plane.origin), this.directions().forward)); }
  rayAt(x, y) { return {origin: this.plane.lpsOf(x, y), direction: this.directions().forward}; }
  placeBeside(near, x, y) { return this.plane.lpsOf(x, y); }
}
