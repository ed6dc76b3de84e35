// One grab from press to release: the tissue under the pointer follows it in the plane of the view, or
// along one of the patient's axes. Esc restores what was, Enter or release keeps.

import {alongAxis} from './camera.js';
import {short, svg} from './elements.js';
import {add, length, times} from './vectors.js';

const kAxes = {'axis-x': [1, 0, 0], 'axis-y': [0, 1, 0], 'axis-z': [0, 0, 1]};
const kNudges = {'nudge-left': [-1, 0], 'nudge-right': [1, 0], 'nudge-up': [0, 1], 'nudge-down': [0, -1]};
const kSizes = [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100];

/// The next larger or smaller radius in mm.
export function nextSize(radius, steps) {
  if (steps > 0) return kSizes.find((size) => size > radius) ?? radius;
  return [...kSizes].reverse().find((size) => size < radius) ?? radius;
}

export class GrabStroke {
  constructor(tools, view, place) {
    Object.assign(this, {tools, view, app: tools.app, session: tools.app.session});
    this.start = view.toPixels(place.x, place.y);
    this.at = this.start;
    this.radius = this.app.settings.radius;
    this.axis = null;
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
      if (this.at !== this.start) this.follow();
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
    this.events.push(this.session.event({kind, ...place, ...(soft > 0 ? {soft} : {}), spare_fixed: true}));
    this.tell();
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
    const to = geometry.gridOfLps(shift).map((mm) => Math.round(mm * 1e4) / 1e4);
    if (to.every((mm, a) => mm === this.to[a])) return;
    this.to = to;
    this.events.push(this.session.event({kind: 'drag', to}, time));
    this.events.splice(0, this.events.length - 50);
    this.tell();
  }

  tell() {
    const {geometry} = this.session;
    const axis = this.axis ? ` along ${{'axis-x': 'left–right', 'axis-y': 'anterior–posterior', 'axis-z': 'superior–inferior'}[this.axis]}` : '';
    this.app.say(`Grabbed ${this.pick.voxel.join(', ')}: ${short(length(geometry.lpsOfGrid(this.to)), 3)} mm${axis}; ` +
                 `handle ${this.radius} mm. Enter keeps, Esc restores, X Y Z constrain, wheel: size`);
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

  act(action, {shiftKey}) {
    if (action in kAxes) {
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
    this.session.event({kind: 'release'});
    this.app.say('Kept. Ctrl+Z takes it back');
    this.end();
  }
  cancel() {
    if (this.pick) this.session.event({kind: 'release', restore: true});
    if (!this.isOver) this.app.say('Restored');
    this.end();
  }
  end() {
    this.isOver = true;
    this.tools.ended(this);
  }
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
