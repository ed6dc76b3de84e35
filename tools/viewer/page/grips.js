// Grips over a picture, which a pointer drags and keys move: what planes, boxes and slices are led by.

import {element} from './elements.js';

const kSteps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
const kLarge = 10;  // with Shift

export class Grip {
  /// `begins(place)`, then `moves(place, from)`, each [x, y] in CSS pixels of the view, `ends()`; `steps(right, up)` by
  /// an arrow key; `removes()` by Delete; `twice()` by a double click.
  constructor(view, {look, label, hint, tabindex = 0, ...does}) {
    Object.assign(this, {view, label, does, from: null});
    this.root = element('div', {
      class: 'grip ' + look, role: 'slider', tabindex, hidden: true, 'aria-label': label, title: `${label}: ${hint}`, 'aria-valuenow': 0,
      onpointerdown: (event) => this.press(event), onpointermove: (event) => this.drag(event),
      onpointerup: (event) => this.lift(event), onpointercancel: (event) => this.lift(event),
      onkeydown: (event) => this.key(event), ondblclick: (event) => this.twice(event)});
    view.picture.append(this.root);
  }

  /// Where it is seen, in CSS pixels, with its value and how people read it; null: nowhere.
  place(at, value = 0, text = '') {
    this.root.hidden = !at || !at.every(Number.isFinite);
    if (this.root.hidden) return;
    this.root.style.left = `${at[0]}px`;
    this.root.style.top = `${at[1]}px`;
    this.root.setAttribute('aria-valuenow', value);
    this.root.setAttribute('aria-valuetext', text);
    if (!this.isWanted) return;
    this.isWanted = false;
    this.focus();
  }
  /// Gets the focus, as soon as it is seen.
  focus() {
    this.isWanted = this.root.hidden;
    if (!this.isWanted) this.root.focus({preventScroll: true});
  }
  remove() { this.root.remove(); }

  placeOf({clientX, clientY}) {
    const {left, top} = this.view.picture.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }
  press(event) {
    if (event.button !== 0 || this.view.app.tools.stroke) return;
    event.stopPropagation();
    this.root.setPointerCapture(event.pointerId);
    this.view.app.activate(this.view);
    this.from = this.placeOf(event);
    this.does.begins?.(this.from);
  }
  drag(event) {
    if (!this.from) return;
    event.stopPropagation();
    this.does.moves(this.placeOf(event), this.from, event.timeStamp);
  }
  lift(event) {
    if (!this.from) return;
    event.stopPropagation();
    this.from = null;
    this.does.ends?.();
  }
  twice(event) {
    event.stopPropagation();
    this.does.twice?.();
  }
  key(event) {
    const step = kSteps[event.key];
    const removes = event.key === 'Delete' && this.does.removes;
    if (event.ctrlKey || event.metaKey || event.altKey || !(step || removes) || this.view.app.tools.stroke) return;
    if (step) this.does.steps(...step.map((part) => part * (event.shiftKey ? kLarge : 1)), event.timeStamp);
    else this.does.removes();
    event.preventDefault();
    event.stopPropagation();
  }
}
