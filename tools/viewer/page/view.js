// One of the four views: its canvas, the marks over it, and what mouse and fingers do there. Places are
// pixels of the picture; where another page gave it another shape, the picture stands in the middle.

import {element, svg} from './elements.js';
import {Gestures} from './gestures.js';
import {drawMarks} from './marks.js';
import {decodedOf, paint} from './picture.js';

export class View {
  /// `app` joins session, tools and layout (main.js).
  constructor(app, name, title) {
    Object.assign(this, {app, name, title});
    this.session = app.session;
    this.canvas = element('canvas', {'aria-hidden': 'true'});
    this.marks = svg('svg', {class: 'marks', 'aria-hidden': 'true'});
    this.empty = element('p', {class: 'empty'});
    this.picture = element('div', {
      class: 'picture', tabindex: 0, role: 'application', 'aria-label': title,
      'aria-describedby': 'view-help'}, this.canvas, this.marks, this.empty);
    this.bar = element('header', {class: 'view-bar'}, element('span', {class: 'view-name'}, title));
    this.root = element('section', {class: 'view', id: 'view-' + name, 'aria-label': title},
                        this.bar, this.picture);
    this.frame = null;
    this.shown = {count: 0, event: 0, frame: 0, settled: false, wentBack: 0};
    this.decoding = 0;
    this.pointer = null;
    this.gestures = new Gestures(this.picture, this);
    this.observer = new ResizeObserver(() => app.sizesChanged());
    this.observer.observe(this.picture);
    this.picture.addEventListener('focus', () => app.activate(this));
    this.session.on('frame', (frame) => frame.view === name && !frame.isAtRest && this.received(frame));
    this.session.on('scene', () => this.refresh());
  }

  get isVisible() { return this.picture.clientWidth > 0 && this.picture.clientHeight > 0; }

  /// Pixels of the screen that a picture may fill.
  room() {
    if (!this.isVisible) return [0, 0];
    const ratio = window.devicePixelRatio || 1;
    return [this.picture.clientWidth, this.picture.clientHeight].map((css) => Math.round(css * ratio));
  }

  /// Width and height of the picture.
  size() { return this.frame ? [this.frame.width, this.frame.height] : this.room(); }

  /// CSS pixels per pixel of the picture, and where the picture begins.
  fit() {
    const [w, h] = this.size();
    const scale = Math.min(this.picture.clientWidth / w, this.picture.clientHeight / h) || 1;
    return {scale, left: (this.picture.clientWidth - w * scale) / 2,
            top: (this.picture.clientHeight - h * scale) / 2};
  }
  toPixels(x, y) {
    const {scale, left, top} = this.fit();
    return [(x - left) / scale, (y - top) / scale];
  }
  toCss([x, y]) {
    const {scale, left, top} = this.fit();
    return [x * scale + left, y * scale + top];
  }

  async received(frame) {
    ++this.decoding;
    const bitmap = await decodedOf(this.session, frame);
    if (bitmap) this.draw(frame, bitmap);
    bitmap?.close();
    --this.decoding;
  }

  draw(frame, bitmap) {
    paint(this.canvas, frame, bitmap);
    if (frame.frame < this.shown.frame || frame.event < this.shown.event) ++this.shown.wentBack;
    this.frame = frame;
    this.frame.picture = null;
    Object.assign(this.shown, {count: this.shown.count + 1, event: frame.event, frame: frame.frame,
                               settled: frame.settled, serverMs: frame.serverMs,
                               pictureWidth: bitmap.width, width: frame.width, height: frame.height});
    this.refresh();
    // The screen shows what is drawn now with its next frame.
    requestAnimationFrame(() => this.session.pictured(this.name, frame));
  }

  /// The numbers of events and frames begin again with a connection.
  restart() {
    this.shown.event = this.shown.frame = 0;
  }

  refresh() {
    const scene = this.session.scene;
    this.empty.hidden = Boolean(scene && this.frame);
    this.empty.textContent = scene ? 'The picture is being made' : 'Nothing is open';
    if (this.marksRequested) return;
    this.marksRequested = true;
    requestAnimationFrame(() => {
      this.marksRequested = false;
      drawMarks(this);
    });
  }

  // What pointers do: a tool at work takes it, else the view itself (its motion* functions).
  press(place) {
    this.app.activate(this);
    this.app.sizesChanged();
    this.pointer = place;
    this.app.pointerValues.clear();
    if (this.app.tools.press(this, place)) return;
    this.motion = this.motionOf(place);
    this.motionStarts(place);
  }
  drag(place) {
    this.pointer = place;
    if (this.app.tools.move(this, place) || !this.motion) return;
    this.motion(place);
  }
  lift(place) {
    if (!this.app.tools.lift(this, place)) this.motionEnds?.(place);
    this.motion = null;
  }
  lost() {
    this.app.tools.lost(this);
    this.motion = null;
  }
  hover(place) {
    this.pointer = place;
    this.app.hovered = this;
    if (this.app.tools.move(this, place)) return this.app.pointerValues.clear();
    this.hovers(place);
    this.app.pointerValues.moved(this, place);
  }
  leave() {
    this.pointer = null;
    this.app.pointerValues.clear();
    if (this.app.hovered === this) this.app.hovered = null;
    this.refresh();
  }
  longPress(place) {
    this.app.activate(this);
    this.app.tools.grabAt(this, place);
  }
  doubleClick(place) {
    if (!this.app.tools.doubleClick(this, place)) this.app.layout.toggle(this.name);
  }
  wheel(place) {
    if (!this.app.tools.wheel(this, place)) this.wheelTurned(place);
  }

  /// Where a tool is to act that a key starts: under the pointer, or at the cross-hair.
  placeForKeys() {
    if (this.pointer) return this.pointer;
    const pixel = this.pixelOf(this.app.slices.cursorLps());
    const [x, y] = pixel ? this.toCss(pixel) : [this.picture.clientWidth / 2, this.picture.clientHeight / 2];
    return {x, y, time: performance.now()};
  }
}
