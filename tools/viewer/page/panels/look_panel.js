// How the body looks: preset and transfer function, slices, clips.

import {button, checkbox, choose, element, field, number, section, select, show} from '../elements.js';
import {iconButton} from '../icons.js';
import {TransferEditor} from './transfer_editor.js';

/// Window and level in HU, as radiologists have them.
const kWindows = [['Soft tissue', 400, 40], ['Bone', 2000, 500], ['Brain', 80, 40], ['Lung', 1500, -600], ['Angiography', 600, 200]];

export class LookPanel {
  constructor(app, root) {
    Object.assign(this, {app, session: app.session});
    this.editor = new TransferEditor((transfer) => this.send(transfer));
    this.preset = select([], undefined, (name) => this.choosePreset(name), {id: 'preset'});
    root.append(section('Volume rendering', true, field('Preset', this.preset), this.editor.root,
                        element('div', {class: 'row'}, button('Save as file…', () => app.files.save('transfer'))), app.looks.root),
                this.sliceSection(), this.clipSection());
    this.session.on('opened', (scene) => scene && this.opened());
    this.session.on('scene', (scene) => this.refresh(scene));
    this.session.on('slices', () => this.refreshSlices());
    this.session.on('connection', (state) => state !== 'lost' && this.loadPresets());
  }

  async loadPresets() {
    try {
      this.presets = await this.session.ask('presets', true);
      this.refresh(this.session.scene);
    } catch { /* comes with the next connection */ }
  }
  async opened() {
    try {
      this.editor.showHistogram(await this.session.ask('histogram', {bins: 256}));
    } catch (error) {
      this.session.addLog({level: 'warning', text: error.message});
    }
    this.windows.hidden = !this.session.scene?.volume.hu;  // HU mean nothing elsewhere
  }

  choosePreset(preset) {
    this.session.event({kind: 'look', preset});
    this.session.tell('chosen', {preset});
  }
  /// One event per frame of the screen while a point is dragged.
  send(transfer) {
    this.unsent = transfer;
    this.request ??= requestAnimationFrame((time) => {
      this.request = null;
      this.sent = this.session.event({kind: 'look', transfer: this.unsent}, time);
      this.session.tell('chosen', {transfer: this.unsent});
    });
  }

  refresh(scene) {
    const names = (this.presets ?? []).map(({name}) => name);
    const now = scene?.view.preset ?? '';
    const own = names.includes(now) ? [] : [['', now || 'Own']];
    const choices = [...own, ...names];
    const key = JSON.stringify([choices, now]);
    if (key !== this.key) choose(this.preset, choices, own.length ? '' : now);
    this.key = key;
    this.preset.disabled = !scene;
    // The editor leads while its own changes are under way.
    if (!this.request && !(this.sent && this.session.lastCarriedOut < this.sent)) {
      this.editor.show(scene?.view.transfer ?? null);
    }
    this.refreshSlices();
    this.refreshClips(scene?.view.clips ?? []);
  }

  sliceSection() {
    const {app} = this;
    const set = (values) => app.slices.set(values);
    this.window = number('', (window) => app.slices.chooseWindow({window}), {min: 0});
    this.level = number('', (level) => app.slices.chooseWindow({level}));
    this.windowChoice = select([['', 'Choose…'], ...kWindows.map(([name]) => name)], '', (name) => {
      const found = kWindows.find(([n]) => n === name);
      if (found) app.slices.chooseWindow({window: found[1], level: found[2]});
      this.windowChoice.value = '';
    });
    this.windows = field('Window preset', this.windowChoice);
    this.overlay = select([['none', 'None'], ['displacement', 'Displacement'], ['det_f', 'det F'], ['energy', 'Strain energy']], 'none',
                          (overlay) => set({overlay}), {id: 'overlay'});
    this.overlayInSpace = checkbox('Overlay in the view in space, too', false, (on) => set({overlay_in_space: on}), {id: 'overlay-in-space'});
    this.outline = checkbox('Outline of the body at rest', true, (outline) => set({outline}));
    this.outlineInSpace = checkbox('Outline in the view in space, too', false, (on) => set({outline_in_space: on}), {id: 'outline-in-space'});
    this.cross = checkbox('Cross-hair', true, (crosshair) => {
      app.settings.crosshair = crosshair;
      app.refreshViews();
    });
    return section('Slices', true, this.windows, field('Window', this.window), field('Level', this.level),
                   field('Overlay', this.overlay, null, 'Displacement in mm, the change of volume (det F), or the strain energy in kPa by the material\'s modulus'), this.overlayInSpace, this.outline,
                   this.outlineInSpace, this.cross);
  }
  refreshSlices() {
    const {window, level, overlay, overlay_in_space: inSpace, outline, outline_in_space: outlineInSpace} = this.app.slices.now;
    show(this.window, window === undefined ? '' : Number(window.toPrecision(5)));
    show(this.level, level === undefined ? '' : Number(level.toPrecision(5)));
    this.overlay.value = overlay ?? 'none';
    this.overlayInSpace.querySelector('input').checked = inSpace ?? false;
    this.outline.querySelector('input').checked = outline ?? true;
    this.outlineInSpace.querySelector('input').checked = outlineInSpace ?? false;
    for (const input of [this.window, this.level, this.overlay, this.windowChoice]) input.disabled = !this.session.scene;
  }

  clipSection() {
    const {clips} = this.app;
    this.clips = element('ul', {class: 'list clips', 'aria-label': 'Clips'});
    const add = element('div', {class: 'row'},
      button('Box around the cross-hair', () => clips.addOctant()), button('Whole volume', () => clips.addVolumeBox()),
      button('Plane at the cross-hair, towards the viewer', () => clips.addPlane()));
    return section('Clips', false, this.clips, add);
  }
  refreshClips(clips) {
    const key = JSON.stringify(clips);
    if (key === this.clipKey || this.clips.contains(document.activeElement) && clips.length === this.clips.children.length) return;
    this.clipKey = key;
    this.clips.replaceChildren(...clips.map((clip, i) => this.clipEntry(clip, i)));
    if (!clips.length) this.clips.append(element('li', {class: 'none'}, 'None'));
  }
  clipEntry(clip, i) {
    const change = (changed) => this.app.clips.change(i, changed);
    const name = clip.box ? 'Box' : 'Plane';
    const values = clip.box ?? [...clip.plane.point, ...clip.plane.normal];
    const labels = clip.box ? ['i from', 'j from', 'k from', 'i to', 'j to', 'k to']
                            : ['point L', 'point P', 'point S', 'normal L', 'normal P', 'normal S'];
    const inputs = values.map((value, a) => number(value, (next) => {
      const all = values.map((v, k) => k === a ? next : v);
      change(clip.box ? {...clip, box: all} : {...clip, plane: {point: all.slice(0, 3), normal: all.slice(3)}});
    }, {'aria-label': `${name} ${i + 1}: ${labels[a]}`, title: labels[a]}));
    const kept = clip.box ? select(['inside', 'outside'], clip.keep ?? 'inside', (keep) => change({...clip, keep}),
                                   {'aria-label': `Box ${i + 1}: keep`}) : null;
    const space = select([['deformed', 'fixed in space'], ['source', 'moves with the tissue']], clip.space ?? 'deformed',
                         (s) => change({...clip, space: s}), {'aria-label': `${name} ${i + 1}: space`});
    return element('li', {class: 'clip'}, element('div', {class: 'row'}, `${i + 1}. ${name}`, kept, space,
      iconButton('remove', `Remove clip ${i + 1}`, () => this.app.clips.remove(i))),
      element('div', {class: 'six'}, ...inputs));
  }
}
