// Before and after in all views: pictures of the body at rest over those of the body as it is, up to a
// divider, or in turn with them. The server makes those at rest, for the same camera and slices, while a
// curtain is drawn.

import {element} from './elements.js';
import {decodedOf, paint} from './picture.js';

const kStep = 0.02, kLargeStep = 0.1;
const kNotes = {before: 'At rest', after: 'Deformed'};

/// The picture of one view at rest and the divider over it.
class RestPane {
  constructor(curtain, view) {
    Object.assign(this, {curtain, view, count: 0, shown: null});
    this.canvas = element('canvas', {class: 'at-rest', 'aria-hidden': 'true', hidden: true});
    view.canvas.after(this.canvas);
    this.divider = element('div', {
      class: 'divider', hidden: true, role: 'separator', tabindex: 0, 'aria-orientation': 'vertical', 'aria-valuemin': 0, 'aria-valuemax': 100,
      'aria-label': 'Curtain: at rest on its left, deformed on its right', title: 'At rest on the left, deformed on the right. Drag, or arrow keys',
      onpointerdown: (event) => this.press(event), onpointermove: (event) => this.drag(event), onpointerup: (event) => event.stopPropagation(),
      onkeydown: (event) => this.key(event), ondblclick: (event) => this.centre(event)},
    element('span', {class: 'left'}, kNotes.before), element('span', {class: 'right'}, kNotes.after));
    this.note = element('div', {class: 'blink-note', hidden: true});
    view.picture.append(this.divider, this.note);
    view.session.on('frame', (frame) => frame.isAtRest && frame.view === view.name && this.received(frame));
  }

  async received(frame) {
    const bitmap = await decodedOf(this.view.session, frame);
    if (!bitmap) return;
    paint(this.canvas, frame, bitmap);
    bitmap.close();
    ++this.count;
    this.shown = {event: frame.event, settled: frame.settled, width: frame.width, height: frame.height};
    this.refresh();
  }
  forget() {
    this.shown = null;
    this.refresh();
  }

  refresh() {
    const {mode, position} = this.curtain;
    const isDivided = mode === 'curtain';
    const part = isDivided ? position : Number(mode === 'before');
    this.canvas.hidden = !this.shown || part === 0;
    this.canvas.style.clipPath = `inset(0 ${100 * (1 - part)}% 0 0)`;
    this.divider.hidden = !isDivided;
    this.divider.style.left = `${100 * position}%`;
    this.divider.setAttribute('aria-valuenow', Math.round(100 * position));
    this.note.hidden = !(mode in kNotes);
    this.note.textContent = kNotes[mode] ?? '';
  }

  press(event) {
    if (event.button !== 0) return;
    event.stopPropagation();
    this.divider.setPointerCapture(event.pointerId);
    this.grip = event.clientX - this.divider.getBoundingClientRect().left;
  }
  drag(event) {
    if (!this.divider.hasPointerCapture(event.pointerId)) return;
    event.stopPropagation();
    const {left, width} = this.view.picture.getBoundingClientRect();
    const middle = this.divider.getBoundingClientRect().width / 2;
    this.curtain.moveTo((event.clientX - this.grip + middle - left) / width);
  }
  centre(event) {
    event.stopPropagation();
    this.curtain.moveTo(0.5);
  }
  key(event) {
    const {curtain} = this;
    const step = event.shiftKey ? kLargeStep : kStep;
    const to = {ArrowLeft: curtain.position - step, ArrowRight: curtain.position + step, Home: 0, End: 1}[event.key];
    if (to === undefined) return;
    curtain.moveTo(to);
    event.preventDefault();
    event.stopPropagation();
  }
}

export class Curtain {
  /// Over all views of the page.
  constructor(app) {
    Object.assign(this, {app, session: app.session, mode: null, position: 0.5, asked: 0});
    this.panes = app.views.map((view) => new RestPane(this, view));
    this.session.on('scene', (scene) => this.heard(scene));
    this.session.on('connection', () => { this.asked = 0; });
    this.session.on('opened', () => this.panes.forEach((pane) => pane.forget()));
  }

  /// A curtain that another page has drawn or taken away counts here, too.
  heard(scene) {
    if (this.session.lastCarriedOut < this.asked) return;
    if (!scene?.curtain) this.show(null);
    else if (!this.mode) this.show('curtain');
  }
  show(mode) {
    if (mode === this.mode) return;
    this.mode = mode;
    if (!mode) this.panes.forEach((pane) => pane.forget());
    this.refresh();
  }
  refresh() {
    for (const pane of this.panes) pane.refresh();
    this.app.toolbar?.refresh();
    this.app.pointerValues.again();
  }
  /// Asks for pictures at rest where there are none.
  draw(mode) {
    if (!this.session.scene) return;
    if (!this.mode === Boolean(mode)) this.asked = this.session.post('curtain', Boolean(mode));
    this.show(mode);
  }

  toggle() {
    this.draw(this.mode === 'curtain' ? null : 'curtain');
    this.app.say(this.mode ? 'Curtain: at rest on the left, deformed on the right of the line; V blinks, C ends' : 'The curtain is gone');
  }
  /// At rest and deformed in turn.
  blink() {
    this.draw(this.mode === 'before' ? 'after' : 'before');
    this.app.say(`${kNotes[this.mode]}: V shows the other one, C a curtain, Esc ends`);
  }
  end() { this.draw(null); }
  moveTo(position) {
    this.position = Math.min(1, Math.max(0, position));
    this.refresh();
  }

  /// True where a view shows the body at rest, x in CSS pixels of its picture.
  covers(view, x) {
    if (this.mode === 'curtain') return x < this.position * view.picture.clientWidth;
    return this.mode === 'before';
  }
  /// Of a question about what is seen there.
  keysAt(view, x) { return this.covers(view, x) ? {at_rest: true} : {}; }
  told() {
    const {mode, position, panes} = this;
    return {mode, position, views: Object.fromEntries(panes.map(({view, count, shown}) => [view.name, {count, ...shown}]))};
  }
}
