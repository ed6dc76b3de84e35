// One grab from press to release: the tissue under the pointer follows it in the plane of the view, or
// along one of the patient's axes. Esc restores what was, Enter or release keeps.

import {alongAxis} from './camera.js';
import {leadText, short, svg} from './elements.js';
import {stopper} from './stopper.js';
import {add, length, normalized, times} from './vectors.js';

const kAxes = {'axis-x': [1, 0, 0], 'axis-y': [0, 1, 0], 'axis-z': [0, 0, 1]};
/// Of positive and negative amounts along them.
const kWays = {'axis-x': ['left', 'right'], 'axis-y': ['back', 'front'], 'axis-z': ['head', 'feet']};
const kNudges = {'nudge-left': [-1, 0], 'nudge-right': [1, 0], 'nudge-up': [0, 1], 'nudge-down': [0, -1]};
const kSizes = [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100];

/// The next larger or smaller radius in mm.
export function nextSize(radius, steps) {
  if (steps > 0) return kSizes.find((size) => size > radius) ?? radius;
  return [...kSizes].reverse().find((size) => size < radius) ?? radius;
}

/// What the last drag asked for and reached, and who stopped it.
function wayText(session, voxel) {
  const {scene: {drag}, geometry} = session;
  const [asked, reached] = [drag.asked, drag.reached].map((mm) => short(length(geometry.lpsOfGrid(mm)), 3));
  return drag.stopped_by ? `${reached} of ${asked} mm, ${stopper(session, voxel)} it` : `${reached} mm`;
}
function madeText(session, voxel) {
  const drag = session.scene?.drag;
  return drag ? `${wayText(session, voxel)}; ${(drag.moved ?? 0).toLocaleString('en')} elements moved` : 'nothing was moved';
}

export class GrabStroke {
  constructor(tools, view, place) {
    Object.assign(this, {tools, view, app: tools.app, session: tools.app.session});
    this.start = view.toPixels(place.x, place.y);
    this.at = this.start;
    this.radius = this.app.settings.radius;
    this.axis = null;
    this.typed = '';          // an amount in mm
    this.nudged = [0, 0, 0];  // LPS mm, by keys
    this.to = [0, 0, 0];      // mm along the grid axes
    this.events = [];
    this.pick = null;
    this.find();
  }

  async find() {
    try {
      const hit = await this.session.ask('pick', {view: this.view.name, at: this.start});
      if (this.isOver) return;
      if (!hit?.element) {
        this.app.say('There is no tissue to grab here');
        return this.end();
      }
      this.pick = hit;
      this.hold();
      this.follow();
      if (this.isKept) this.keep();
    } catch (error) {
      this.app.say(error.message);
      this.end();
    }
  }

  hold() {
    const {voxel} = this.pick;
    const kind = this.app.settings.push ? 'push' : 'grab';
    const {soft} = this.app.settings;
    const place = this.radius > 0 ? {grab_ball: voxel, radius: this.radius} : {grab: voxel};
    // Beside an anchor the handle takes what the anchor does not hold.
    this.events.push(this.session.event({kind, ...place, ...(soft > 0 ? {soft} : {}), spare_fixed: true, slide: true, ...this.plane()}));
    this.tell();
  }
  /// The directions in which finite elements are to be ready to follow.
  plane() {
    if (!this.session.scene?.under_hand) return {};
    const round = (mm) => Math.round(mm * 1e4) / 1e4;
    return {directions: [this.pick.right, this.pick.down].map((way) => times(normalized(way), 10).map(round))};
  }

  press(place) {
    this.isPressed = true;
    if (place.time > 0) this.move(place);
  }
  move({x, y, time}) {
    this.at = this.view.toPixels(x, y);
    this.follow(time);
  }
  lift(place) {
    this.move(place);
    this.keep();
  }
  lost() { this.cancel(); }

  /// Where the tissue is led to, and a drag event if that is another place.
  follow(time = performance.now()) {
    if (!this.pick) return;
    const {geometry} = this.session;
    const [dx, dy] = [this.at[0] - this.start[0], this.at[1] - this.start[1]];
    const onGrid = add(times(this.pick.right, dx), times(this.pick.down, dy));
    let shift = add(geometry.lpsOfGrid(onGrid), this.nudged);
    if (this.axis) shift = alongAxis(this.view.directions(), shift, kAxes[this.axis]);
    const amount = this.amount();
    if (amount !== null) shift = times(this.wayOf(shift), amount);
    const to = geometry.gridOfLps(shift).map((mm) => Math.round(mm * 1e4) / 1e4);
    if (to.every((mm, a) => mm === this.to[a])) return;
    this.to = to;
    this.events.push(this.session.event({kind: 'drag', to}, time));
    this.events.splice(0, this.events.length - 50);
    this.tell();
  }

  /// What was typed, in mm; null: nothing that is a number yet.
  amount() {
    const typed = this.typed.replace(',', '.');
    return /\d/.test(typed) ? Number(typed) : null;
  }
  /// Along the axis; without one the way that was led, or to the right of the picture.
  wayOf(shift) {
    if (this.axis) return kAxes[this.axis];
    return length(shift) > 1e-6 ? normalized(shift) : this.view.directions().right;
  }
  /// A sign goes to the front, and away when it comes again.
  type(key) {
    if (key === 'Backspace') this.typed = this.typed.slice(0, -1);
    else if (key === '-') this.typed = this.typed.startsWith('-') ? this.typed.slice(1) : '-' + this.typed;
    else if (/\d/.test(key) || !/[.,]/.test(this.typed)) this.typed += key;
    this.follow();
    this.tell();
  }

  /// How far it was led, and how far it came.
  tell() {
    if (!this.pick) return;
    const {scene} = this.session;
    const isKnown = scene?.drag && this.session.lastCarriedOut >= this.events.at(-1);
    const far = isKnown ? wayText(this.session, this.pick.voxel) : `${short(length(this.session.geometry.lpsOfGrid(this.to)), 3)} mm`;
    const axis = this.axis ? ` along ${{'axis-x': 'left–right', 'axis-y': 'anterior–posterior', 'axis-z': 'superior–inferior'}[this.axis]}` : '';
    const way = this.axis && this.amount() ? ` to the ${kWays[this.axis][this.amount() < 0 ? 1 : 0]}` : axis;
    const led = this.typed ? `${this.typed}▏mm${way}${isKnown ? ', ' + far : ''}` : far + axis;
    const lead = scene?.lead ? `; ${leadText(scene.lead)}` : '';
    this.app.say(`Grabbed ${this.pick.voxel.join(', ')}: ${led}${lead}; handle ${this.radius} mm. ` +
                 'Enter keeps, Esc restores, X Y Z and a number constrain, wheel: size');
    this.view.refresh();
  }

  wheel({dx, dy}) {
    this.turned = (this.turned ?? 0) - dx - dy;
    if (Math.abs(this.turned) < 0.4) return;  // fine steps of touch pads add up
    this.resize(this.turned);
    this.turned = 0;
  }
  /// Another handle at the same place, led as far.
  resize(steps) {
    const radius = nextSize(this.radius, steps);
    if (!this.pick || radius === this.radius) return;
    this.radius = this.app.settings.radius = radius;
    this.app.settingsChanged();
    this.session.event({kind: 'release', restore: true});
    this.hold();
    if (length(this.to) > 0) this.events.push(this.session.event({kind: 'drag', to: this.to}));
  }

  act(action, {shiftKey, key}) {
    if (action === 'type') {
      this.type(key);
    } else if (action in kAxes) {
      this.axis = this.axis === action ? null : action;
      this.follow();
      if (this.pick) this.tell();
    } else if (action in kNudges) {
      const [right, up] = kNudges[action];
      const directions = this.view.directions();
      const mm = shiftKey ? 10 : 1;
      this.nudged = add(this.nudged, add(times(directions.right, right * mm), times(directions.up, up * mm)));
      this.follow();
    } else if (action === 'larger' || action === 'smaller') {
      this.resize(action === 'larger' ? 1 : -1);
    } else {
      return false;
    }
    return true;
  }

  keep() {
    this.isKept = true;
    if (!this.pick) return;  // as soon as it is known what was grabbed
    const n = this.session.event({kind: 'release'});
    if (n) this.app.sayWhenDone(n, () => `Kept: ${madeText(this.session, this.pick.voxel)}. Ctrl+Z takes it back`);
    else this.app.say(kNotKept);
    this.end();
  }
  cancel() {
    const isSent = !this.pick || this.session.event({kind: 'release', restore: true}) > 0;
    if (!this.isOver) this.app.say(isSent ? 'Restored' : kNotKept);
    this.end();
  }
  end() {
    this.isOver = true;
    this.tools.ended(this);
  }
  sceneChanged() { this.tell(); }
  failed({n, text}) {
    if (!this.events.includes(n)) return;
    this.app.say(text);
    if (this.events[0] === n) this.end();
  }
  /// A server that is back knows nothing of the stroke.
  connectionChanged() {
    if (this.session.state === 'connected') {
      this.app.say('The connection was lost in mid-drag: grab again');
      this.end();
    }
  }

  marks() {
    if (!this.pick) return [];
    const {geometry} = this.session;
    const from = this.view.pixelOf(this.pick.lps);
    const to = this.view.pixelOf(add(this.pick.lps, geometry.lpsOfGrid(this.to)));
    if (!from || !to) return [];
    const [[x1, y1], [x2, y2]] = [this.view.toCss(from), this.view.toCss(to)];
    return [svg('line', {class: 'way', x1, y1, x2, y2}), this.tools.brush(this.view, x2, y2, this.radius)];
  }
}
