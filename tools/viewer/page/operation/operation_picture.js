// The picture of the microscope, and what the mouse does on it.

import {deeper, shifted} from './hand.js';

const kMmPerNotch = 0.1, kDegreesPerNotch = 5;

export class OperationPicture {
  /// `app` has the session and the hand that leads, if any.
  constructor(app) {
    this.app = app;
    this.root = document.getElementById('picture');
    this.canvas = this.root.querySelector('canvas');
    this.context = this.canvas.getContext('2d', {alpha: false});
    this.decoding = 0;
    this.last = null;  // place of the pointer
    const on = (type, listener) => this.root.addEventListener(type, listener, {passive: false});
    on('pointerdown', (event) => this.down(event));
    // Moves as they come, where the browser tells of them before its next picture.
    on('onpointerrawupdate' in window ? 'pointerrawupdate' : 'pointermove', (event) => this.move(event));
    on('pointerup', (event) => this.up(event));
    on('pointercancel', (event) => this.up(event));
    on('pointerleave', () => { this.last = null; });
    on('wheel', (event) => this.wheel(event));
    on('contextmenu', (event) => event.preventDefault());
    app.session.on('frame', (frame) => this.received(frame));
  }

  /// Width and height of the picture of one eye, and CSS pixels for each of its pixels.
  get size() {
    const {stereo, size} = this.app.session.status.view;
    const {clientWidth, clientHeight} = this.root;
    const width = size[0] * (stereo === 'side_by_side' ? 2 : 1);
    return {size, scale: Math.min(clientWidth / width, clientHeight / size[1]) || 1};
  }
  get camera() { return this.app.session.status.view.camera; }

  down(event) {
    this.root.focus({preventScroll: true});
    this.root.setPointerCapture?.(event.pointerId);
    this.last = [event.clientX, event.clientY];
    if (event.button !== 0) return;
    if (this.app.hand) this.app.hand.hold(true);
    else this.app.take();
  }
  up(event) {
    if (event.button === 0) this.app.hand?.hold(false);
  }

  move(event) {
    const place = [event.clientX, event.clientY];
    const {hand} = this.app;
    if (hand && this.last) this.moveBy(place[0] - this.last[0], place[1] - this.last[1], event);
    this.last = place;
  }
  /// A motion of the pointer in CSS pixels; with the right button it leads into the picture.
  moveBy(dx, dy, {buttons = 0, timeStamp} = {}) {
    const {hand} = this.app;
    const {size, scale} = this.size;
    this.app.inputTime ??= timeStamp;
    const tip = buttons & 2 ? deeper(this.camera, hand.pose.tip, this.mmPerCssPixel * dy)
      : shifted(this.camera, hand.pose.tip, dx / scale, dy / scale, size);
    hand.moveTo(tip);
  }
  get mmPerCssPixel() {
    const {size, scale} = this.size;
    const {position, target, fov} = this.camera;
    return 2 * Math.tan(fov * Math.PI / 360) * Math.hypot(...position.map((p, i) => p - target[i])) / size[1] / scale;
  }

  wheel(event) {
    event.preventDefault();
    const {hand} = this.app;
    if (!hand) return;
    const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
    const notches = -(event.deltaY || event.deltaX) * lines / 100;
    this.app.inputTime = event.timeStamp;
    if (event.shiftKey) hand.roll(notches * kDegreesPerNotch);
    else hand.moveTo(deeper(this.camera, hand.pose.tip, notches * kMmPerNotch));
  }

  async received(frame) {
    let bitmap = null;
    ++this.decoding;
    try {
      bitmap = await createImageBitmap(new Blob([frame.picture], {type: frame.type}));
    } catch {
      this.app.say('A picture could not be decoded');
    }
    if (this.app.session.passes(frame) && bitmap) this.draw(frame, bitmap);
    bitmap?.close();
    --this.decoding;
  }
  draw(frame, bitmap) {
    const {width, height} = frame;
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
    this.context.drawImage(bitmap, 0, 0, width, height);
    requestAnimationFrame(() => this.app.session.pictured(frame));
  }
}
