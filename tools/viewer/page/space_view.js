// The view in space: a camera turned, moved and rolled by mouse, fingers and keys.

import {angleAround, cameraFrame, framed, heightAtTarget, kSides, orbited, panned, pixelOf, placeInViewPlane, projectedAs, rayAt, rolled,
        rotated, zoomed} from './camera.js';
import {button} from './elements.js';
import {View} from './view.js';

export class SpaceView extends View {
  constructor(app) {
    super(app, '3d', '3D');
    for (const side of Object.keys(kSides)) {
      this.bar.append(button(side[0].toUpperCase(), () => this.lookFrom(side), {
        class: 'side', title: `From ${side}`, 'aria-label': `From ${side}`}));
    }
    this.bar.append(app.layout.button(this));
    this.session.on('opened', () => { this.home = null; });
  }

  get camera() { return this.session.camera(); }
  turn(camera, time) {
    if (!this.session.scene) return;
    this.home ??= this.camera;
    this.session.turnCamera(camera, time);
    this.refresh();
  }

  motionOf({button, shift, ctrl, side, time}) {
    if (!this.camera) return null;
    if (side && button === 0) {  // of the cube
      this.lookFrom(side, time);
      return null;
    }
    if (button === 1 || (button === 0 && shift)) return this.moves;
    if (button === 2) return this.zooms;
    if (button === 0 && ctrl) return this.rolls;
    return button === 0 ? this.rotates : null;
  }
  motionStarts() {}

  /// CSS pixels as pixels of the picture.
  scaled(value) { return value / this.fit().scale; }

  rotates({dx, dy, time}) {
    this.turn(rotated(this.camera, this.scaled(dx), this.scaled(dy), this.size()), time);
  }
  moves({dx, dy, time}) {
    this.turn(panned(this.camera, this.scaled(dx), this.scaled(dy), this.size()), time);
  }
  zooms({dy, time}) {
    this.turn(zoomed(this.camera, 1.1 ** (dy * 10 / this.picture.clientHeight * 2)), time);
  }
  rolls({x, y, dx, dy, time}) {
    const [x1, y1] = this.toPixels(x, y);
    const [x0, y0] = this.toPixels(x - dx, y - dy);
    this.turn(rolled(this.camera, angleAround(x0, y0, x1, y1, this.size())), time);
  }
  pinch({dx, dy, factor, time}) {
    if (!this.camera) return;
    const moved = panned(this.camera, this.scaled(dx), this.scaled(dy), this.size());
    this.turn(zoomed(moved, factor), time);
  }
  wheelTurned({dy, dx, time}) {
    if (this.camera) this.turn(zoomed(this.camera, 1.1 ** -(dx + dy)), time);
  }
  hovers(place) { if (place.shift) this.probes(place); }
  /// Shift and move: the cross-hair goes to the surface under the pointer.
  async probes({x, y}) {
    if (this.isProbing || !this.session.scene) return;
    this.isProbing = true;
    try {
      const hit = await this.session.ask('pick', {view: this.name, at: this.toPixels(x, y)});
      if (hit) this.app.slices.setCursor(hit.index);
    } catch { /* the next move asks again */ }
    this.isProbing = false;
  }

  act(action, time) {
    const camera = this.camera;
    if (!camera) return false;
    const step = this.size()[1] / 20;
    const turns = {
      'turn-left': () => orbited(camera, -5, 0), 'turn-right': () => orbited(camera, 5, 0),
      'turn-up': () => orbited(camera, 0, 5), 'turn-down': () => orbited(camera, 0, -5),
      'pan-left': () => panned(camera, -step, 0, this.size()), 'pan-right': () => panned(camera, step, 0, this.size()),
      'pan-up': () => panned(camera, 0, -step, this.size()), 'pan-down': () => panned(camera, 0, step, this.size()),
      'roll-left': () => rolled(camera, 5), 'roll-right': () => rolled(camera, -5),
      'zoom-in': () => zoomed(camera, 1.1), 'zoom-out': () => zoomed(camera, 1 / 1.1)};
    if (!(action in turns)) return false;
    this.turn(turns[action](), time);
    return true;
  }

  lookFrom(side, time) {
    const [w, h] = this.size();
    if (this.camera) this.turn(framed(this.session.geometry.corners(), w / h, side, this.camera), time);
  }
  reset(time) {
    if (this.home) this.turn(this.home, time);
  }
  toggleProjection(time) {
    if (!this.camera) return;
    const now = this.camera.projection ?? 'perspective';
    this.turn(projectedAs(this.camera, now === 'perspective' ? 'orthographic' : 'perspective'), time);
  }

  /// Directions of the picture that is seen.
  directions() {
    const camera = this.session.shownCamera();
    return camera ? cameraFrame(camera) : null;
  }
  pixelOf(lps) {
    const camera = this.session.shownCamera();
    return camera && lps ? pixelOf(camera, lps, this.size()) : null;
  }
  pixelsPerMm() {
    return this.size()[1] / heightAtTarget(this.session.shownCamera()) * this.fit().scale;
  }
  rayAt(x, y) { return rayAt(this.session.shownCamera(), x, y, this.size()); }
  /// The place under a pixel at the depth of `near`.
  placeBeside(near, x, y) { return placeInViewPlane(this.session.shownCamera(), near, x, y, this.size()); }
}
