// One grab from press to release: the tissue under the pointer, or the whole bone, follows it in the plane
// of the view, or along one of the patient's axes; a bone turns, too. Esc restores what was, Enter or release keeps.

import {alongAxis} from './camera.js';
import {leadText, short, svg} from './elements.js';
import {PieceRings} from './piece_rings.js';
import {PieceTurn} from './piece_turn.js';
import {stopper} from './stopper.js';
import {add, length, normalized, times} from './vectors.js';

const kAxes = {'axis-x': [1, 0, 0], 'axis-y': [0, 1, 0], 'axis-z': [0, 0, 1]};
/// Of positive and negative amounts along them.
const kWays = {'axis-x': ['left', 'right'], 'axis-y': ['back', 'front'], 'axis-z': ['head', 'feet']};
const kNudges = {'nudge-left': [-1, 0], 'nudge-right': [1, 0], 'nudge-up': [0, 1], 'nudge-down': [0, -1]};
const kStillPixels = 3;  // of a click
const kSizes = [0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100];

/// The next larger or smaller radius in mm.
export function nextSize(radius, steps) {
  if (steps > 0) return kSizes.find((size) => size > radius) ?? radius;
  return [...kSizes].reverse().find((size) => size < radius) ?? radius;
}

/// What the last drag asked for and reached, and who stopped it.
function wayText(session, voxel) {
  const {scene: {drag}, geometry} = session;
  const isWhole = !drag.stopped_by;
  const far = reachedTexts(drag, geometry, isWhole).join(', ');
  return isWhole ? far : `${far}, ${stopper(session, voxel)} it`;
}
/// mm and, of a bone, degrees.
function reachedTexts(drag, geometry, isWhole) {
  const [asked, reached] = [drag.asked, drag.reached].map((mm) => short(length(geometry.lpsOfGrid(mm)), 3));
  const of = (got, wanted, unit) => isWhole || got === wanted ? `${got}${unit}` : `${got} of ${wanted}${unit}`;
  return [of(reached, asked, ' mm'), ...(drag.turn ? [of(drag.turn.reached.toFixed(1), drag.turn.asked.toFixed(1), '°')] : [])];
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
    this.turnOnGrid = [0, 0, 0];  // axis along the grid times degrees
    this.pick = null;
    this.piece = null;            // the bone in hand, and its turn
    this.rings = null;            // about a bone that a click has taken
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
      // A bone that nothing fixes comes as a whole.
      if (hit.rigid && !hit.rigid.fixed && !this.app.settings.push) this.piece = {...hit.rigid, turn: new PieceTurn()};
      if (this.wantsTurn) this.switchTo('turn');
      this.hold();
      if (this.isClicked) this.at = this.start;
      this.follow();
      if (this.isClicked) this.take();
      else if (this.isKept) this.keep();
    } catch (error) {
      this.app.say(error.message);
      this.end();
    }
  }

  hold() {
    const {voxel} = this.pick;
    const kind = this.app.settings.push ? 'push' : 'grab';
    const {soft, joint} = this.app.settings;
    if (this.piece) {
      this.events.push(this.session.event({kind, rigid_at: this.piece.voxel, ...(joint > 0 ? {joint} : {}), slide: true, ...this.plane()}));
      return this.tell();
    }
    const place = this.radius > 0 ? {grab_ball: voxel, radius: this.radius} : {grab: voxel};
    // Beside an anchor the handle takes what the anchor does not hold.
    this.events.push(this.session.event({kind, ...place, ...(soft > 0 ? {soft} : {}), spare_fixed: true, slide: true, ...this.plane()}));
    this.tell();
  }
  /// The directions in which finite elements are to be ready to follow.
  plane() {
    if (!this.session.scene?.under_hand) return {};
    const round = (mm) => Math.round(mm * 1e8) / 1e8;
    return {directions: [this.pick.right, this.pick.down].map((way) => times(normalized(way), 10).map(round))};
  }

  press(place) {
    if (this.rings) return this.rings.press(place);
    this.pressed = place;
    if (place.time > 0) this.move(place);
  }
  move(place) {
    this.at = this.view.toPixels(place.x, place.y);
    if (this.rings) return this.rings.move(place);
    this.follow(place.time);
  }
  lift(place) {
    if (this.rings) {
      if (this.rings.lift()) this.tell();
      else this.keep();
      return;
    }
    this.move(place);
    const {x, y} = this.pressed ?? place;
    const isClick = Math.hypot(place.x - x, place.y - y) < kStillPixels && length(this.to) < 1e-3 && length(this.turnOnGrid) === 0;
    if (isClick && (this.piece || !this.pick)) this.take();
    else this.keep();
  }
  /// A click takes a bone, and rings about it turn it; tissue is let go of.
  take() {
    this.isClicked = !this.pick;
    if (!this.pick) return;
    if (!this.piece) return this.keep();
    this.rings = new PieceRings(this);
    this.tell();
  }
  /// The pointer moves the bone on, from where it is.
  movesFrom({x, y}) {
    this.axis = null;
    this.start = this.view.toPixels(x, y);
    this.nudged = this.session.geometry.lpsOfGrid(this.to);
  }
  lost() { this.cancel(); }

  /// Where the tissue is led to, and a drag event if that is another place.
  follow(time = performance.now()) {
    if (!this.pick) return;
    if (this.piece?.turn.isOn) return this.followTurn(time);
    const {geometry} = this.session;
    const [dx, dy] = [this.at[0] - this.start[0], this.at[1] - this.start[1]];
    const onGrid = add(times(this.pick.right, dx), times(this.pick.down, dy));
    let shift = add(geometry.lpsOfGrid(onGrid), this.nudged);
    if (this.axis) shift = alongAxis(this.view.directions(), shift, kAxes[this.axis]);
    const amount = this.amount();
    if (amount !== null) shift = times(this.wayOf(shift), amount);
    // So fine that what a view leads to stays in its plane.
    const to = geometry.gridOfLps(shift).map((mm) => Math.round(mm * 1e6) / 1e6);
    if (to.every((mm, a) => mm === this.to[a])) return;
    this.to = to;
    this.lead(time);
  }
  lead(time) {
    const turn = length(this.turnOnGrid) > 0 ? {turn: this.turnOnGrid} : {};
    this.events.push(this.session.event({kind: 'drag', to: this.to, ...turn}, time));
    this.events.splice(0, this.events.length - 50);
    this.tell();
  }
  /// The middle of the bone as it is asked for, in pixels.
  middle() { return this.view.pixelOf(this.middleLps()); }
  middleLps() { return add(this.piece.middle, this.session.geometry.lpsOfGrid(this.to)); }
  followTurn(time) {
    const {turn} = this.piece, {geometry} = this.session, middle = this.middle();
    if (middle && !this.rings) turn.sweep(this.at, middle);
    turn.lead(this.view.directions().forward, this.axis && kAxes[this.axis], this.amount());
    const degrees = turn.vector(), along = geometry.gridOfLps(degrees);
    const scale = length(along) > 0 ? length(degrees) / length(along) : 0;
    const onGrid = along.map((value) => Math.round(value * scale * 1e6) / 1e6);
    if (onGrid.every((value, a) => value === this.turnOnGrid[a])) return;
    this.turnOnGrid = onGrid;
    this.lead(time);
  }
  /// From moving to turning and back; what was done stays.
  switchTo(what) {
    if (!this.pick) {
      this.wantsTurn = what === 'turn';
      return;
    }
    if (!this.piece) return this.app.say('Only bones turn that nothing fixes: grab one of them');
    const {turn} = this.piece;
    if (turn.isOn === (what === 'turn') && !this.rings) return;
    this.rings = null;
    turn.end();
    if (what === 'move') {
      this.start = this.at;
      this.nudged = this.session.geometry.lpsOfGrid(this.to);
    } else {
      turn.begin();
      const middle = this.middle();
      if (middle) turn.sweep(this.at, middle);
    }
    this.axis = null;
    this.typed = '';
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

  /// The element whose handle it is.
  voxel() { return this.piece?.voxel ?? this.pick.voxel; }
  /// How far it was led, and how far it came.
  tell() {
    if (!this.pick) return;
    const {scene} = this.session;
    const isKnown = scene?.drag && this.session.lastCarriedOut >= this.events.at(-1);
    const far = isKnown ? wayText(this.session, this.voxel()) : `${short(length(this.session.geometry.lpsOfGrid(this.to)), 3)} mm`;
    const lead = scene?.lead ? `; ${leadText(scene.lead)}` : '';
    if (this.piece) return this.tellPiece(far + lead);
    const axis = this.axis ? ` along ${{'axis-x': 'left–right', 'axis-y': 'anterior–posterior', 'axis-z': 'superior–inferior'}[this.axis]}` : '';
    const way = this.axis && this.amount() ? ` to the ${kWays[this.axis][this.amount() < 0 ? 1 : 0]}` : axis;
    const led = this.typed ? `${this.typed}▏mm${way}${isKnown ? ', ' + far : ''}` : far + axis;
    this.app.say(`Grabbed ${this.pick.voxel.join(', ')}: ${led}${lead}; handle ${this.radius} mm. ` +
                 'Enter keeps, Esc restores, X Y Z and a number constrain, wheel: size');
    this.view.refresh();
  }

  tellPiece(far) {
    const {turn, name} = this.piece;
    const axis = this.axis ? ` ${turn.isOn ? 'about' : 'along'} ${{'axis-x': 'left–right', 'axis-y': 'anterior–posterior', 'axis-z': 'superior–inferior'}[this.axis]}` : '';
    const typed = this.typed ? `${this.typed}▏${turn.isOn ? '°' : ' mm'}${axis}, ` : '';
    if (this.rings) {
      this.app.say(`Bone ${name}: ${typed}${far}. Rings turn, the dot moves it, X Y Z and degrees; Enter keeps, Esc restores`);
      return this.view.refresh();
    }
    this.app.say(`Bone ${name}: ${typed}${far}${this.typed ? '' : axis}. ` +
                 `${turn.isOn ? 'G moves' : 'R turns'}, X Y Z and a number constrain, Enter keeps, Esc restores`);
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
    if (!this.pick || this.piece || radius === this.radius) return;
    this.radius = this.app.settings.radius = radius;
    this.app.settingsChanged();
    this.session.event({kind: 'release', restore: true});
    this.hold();
    if (length(this.to) > 0) this.events.push(this.session.event({kind: 'drag', to: this.to}));
  }

  act(action, {shiftKey, key}) {
    if (action === 'type') {
      this.type(key);
    } else if (action in kAxes && this.rings) {
      this.typed = '';
      this.rings.choose(action);
      this.tell();
    } else if (action in kAxes) {
      this.axis = this.axis === action ? null : action;
      this.follow();
      if (this.pick) this.tell();
    } else if (action === 'turn') {
      this.switchTo('turn');
    } else if (action === 'grab' && (this.piece?.turn.isOn || this.rings)) {
      this.switchTo('move');
    } else if (action in kNudges && this.piece?.turn.isOn) {
      const [right, up] = kNudges[action];
      this.piece.turn.nudge((right || up) * (shiftKey ? 10 : 1));
      this.follow();
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
    if (n) this.app.sayWhenDone(n, () => `Kept: ${madeText(this.session, this.voxel())}. Ctrl+Z takes it back`);
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
    if (this.piece) return this.pieceMarks([x1, y1], [x2, y2]);
    return [svg('line', {class: 'way', x1, y1, x2, y2}), this.tools.brush(this.view, x2, y2, this.radius)];
  }
  turnMarks(middle, at) {
    if (this.rings) return this.rings.marks();
    return this.piece.turn.isOn && middle ? this.piece.turn.marks(this.view.toCss(middle), at) : [];
  }
  /// Where the bone is led, and beside the pointer how far it has come.
  pieceMarks([x1, y1], [x2, y2]) {
    const [x, y] = this.view.toCss(this.at), middle = this.middle();
    const {drag} = this.session.scene, isKnown = drag && this.session.lastCarriedOut >= this.events[0];
    const texts = isKnown ? reachedTexts(drag, this.session.geometry, !drag.stopped_by) : [];
    return [svg('line', {class: 'way', x1, y1, x2, y2}), ...this.turnMarks(middle, [x, y]),
            ...texts.map((words, i) => {
              const made = svg('text', {class: 'hand-text', x: x + 14, y: y - 8 + 16 * i});
              made.textContent = words;
              return made;
            })];
  }
}
