// Values of what is under the pointer, in a corner of its view: one question at a time, always about
// the newest place.

import {element, short} from './elements.js';
import {sidesText} from './geometry.js';
import {length} from './vectors.js';

const kMostTimes = 2000;

/// Lines about a hit of `pick`.
export function valueLines(hit, volume) {
  const lines = [`voxel ${hit.index.map((i) => Math.round(i)).join(', ')}`, `${sidesText(hit.lps)} mm`];
  const density = hit.density === undefined ? [] : [short(hit.density) + (volume.hu ? ' HU' : '')];
  if (hit.label) density.push(`label ${hit.label}`);
  if (density.length) lines.push(density.join(', '));
  const moved = hit.displacement ? length(hit.displacement) : 0;
  if (hit.displacement) lines.push(`moved ${moved.toFixed(2)} mm` + (moved > 0 && hit.voxel ? ` from ${hit.voxel.join(', ')}` : ''));
  const tissue = hit.det_f === undefined ? [] : [`det F ${hit.det_f.toFixed(3)}`];
  if (hit.stress_kpa !== undefined) tissue.push(`${short(hit.stress_kpa, 3)} kPa`);
  if (tissue.length) lines.push(tissue.join(', '));
  return lines;
}

export class PointerValues {
  constructor(app) {
    Object.assign(this, {app, session: app.session, place: null, isAsking: false});
    this.told = {lines: [], hit: null, at: null, times: []};
    this.box = element('div', {class: 'pointer-values', 'aria-hidden': 'true'});
    this.session.on('scene', () => this.again());
    this.session.on('connection', () => this.clear());
  }

  /// The pointer of a view, whose place has the time of its event.
  moved(view, place) {
    this.now = {view, place};
    this.place = this.now;
    this.ask();
  }
  /// Values under the pointer may have changed.
  again() {
    if (!this.now || this.app.tools.stroke) return;
    this.place = {...this.now, isAgain: true};
    this.ask();
  }
  clear() {
    this.now = this.place = this.told.at = this.told.hit = null;
    this.box.remove();
  }

  async ask() {
    if (this.isAsking || !this.place) return;
    const {view, place, isAgain} = this.place;
    this.place = null;
    if (!this.session.scene || !view.frame) return;
    this.isAsking = true;
    try {
      const hit = await this.session.ask('pick', {view: view.name, at: view.toPixels(place.x, place.y), values: true, ...this.app.curtain.keysAt(view, place.x)});
      this.show(view, place, hit);
      if (!isAgain) this.note(performance.now() - place.time);
    } catch { /* the next move asks again */ }
    this.isAsking = false;
    this.ask();
  }
  show(view, place, hit) {
    if (!this.now || this.now.view !== view) return;
    const lines = hit ? valueLines(hit, this.session.scene.volume) : [];
    const {left, top} = view.picture.getBoundingClientRect();
    Object.assign(this.told, {lines, hit, at: [left + place.x, top + place.y]});
    if (!hit) return this.box.remove();
    this.box.replaceChildren(...lines.map((line) => element('div', {}, line)));
    if (this.box.parentElement !== view.picture) view.picture.append(this.box);
  }
  note(ms) {
    this.told.times.push(ms);
    if (this.told.times.length > kMostTimes) this.told.times.shift();
  }
}
