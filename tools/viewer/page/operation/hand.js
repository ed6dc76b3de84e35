// A hand that leads one instrument: what mouse and keys do to its pose. Places are mm in the frame of
// the head, as the server has them; pixels are those of one picture.

import {cameraFrame, pixelOf} from '../camera.js';
import {add, dot, minus, times} from '../vectors.js';

const kOpenDegrees = 30;  // of jaws that the scene begins with closed ones
const kClosingMs = 120, kClosingSteps = 6;
const kMoveEveryMs = 8;  // a mouse may tell of a thousand moves a second

/// What a pixel is at the depth of a place, in mm.
export function mmPerPixel(camera, place, size) {
  const {forward} = cameraFrame(camera);
  return 2 * Math.tan(camera.fov * Math.PI / 360) * dot(minus(place, camera.position), forward) / size[1];
}

/// A place moved parallel to the picture, so that it is seen (dx, dy) pixels further right and down.
export function shifted(camera, place, dx, dy, size) {
  const {right, up} = cameraFrame(camera);
  const mm = mmPerPixel(camera, place, size);
  return add(place, add(times(right, dx * mm), times(up, -dy * mm)));
}

/// A place moved away from the viewer, along the line of sight.
export const deeper = (camera, place, mm) => add(place, times(cameraFrame(camera).forward, mm));

export {pixelOf};

/// `send(wish)` takes the parts of the pose that have changed.
export class Hand {
  /// `instrument` is one of the scene, `pose` where it is.
  constructor(instrument, pose, send) {
    Object.assign(this, {instrument, send});
    this.name = instrument.name;
    this.pose = {...pose};
    this.isHeld = false;
    this.opened = instrument.start.opening || kOpenDegrees;
  }

  /// The newest place is sent at once, or as soon as the last one is long enough ago.
  moveTo(tip) {
    this.pose.tip = tip;
    const waitMs = kMoveEveryMs - (performance.now() - (this.movedAt ?? -Infinity));
    if (waitMs <= 0) this.sendTip();
    else this.moveTimer ??= setTimeout(() => this.sendTip(), waitMs);
  }
  sendTip() {
    clearTimeout(this.moveTimer);
    this.moveTimer = null;
    this.movedAt = performance.now();
    this.send({tip: this.pose.tip});
  }
  /// Nothing more is sent.
  end() {
    clearTimeout(this.moveTimer);
    clearInterval(this.timer);
  }
  roll(degrees) {
    this.pose.roll += degrees;
    this.send({roll: this.pose.roll});
  }

  /// Whether there is anything to close or to switch on.
  get acts() { return this.instrument.has_jaws || this.instrument.is_lamp || this.instrument.kind === 'vitrector'; }

  /// Closes jaws or begins to suck, or ends it; a lamp changes at each beginning.
  hold(isHeld) {
    if (isHeld === this.isHeld) return;
    this.isHeld = isHeld;
    const {has_jaws: hasJaws, is_lamp: isLamp} = this.instrument;
    if (hasJaws) return this.turnJaws(isHeld ? 0 : this.opened);
    if (!this.acts || (isLamp && !isHeld)) return;
    this.pose.active = isLamp ? Number(!(this.pose.active > 0)) : Number(isHeld);
    this.send({active: this.pose.active});
  }

  /// Jaws take their time, so that they do not strike what lies between them.
  turnJaws(to) {
    clearInterval(this.timer);
    const by = (to - this.pose.opening) / kClosingSteps;
    let left = kClosingSteps;
    const turn = () => {
      this.pose.opening = --left > 0 ? this.pose.opening + by : to;
      this.send({opening: this.pose.opening});
      if (left <= 0) clearInterval(this.timer);
    };
    turn();
    this.timer = setInterval(turn, kClosingMs / kClosingSteps);
  }
}
