// How the body moves: tools, model, limits, relaxation, and what was done, as lists that can be edited.

import {button, checkbox, element, field, leadText, number, section, select, show} from '../elements.js';
import {iconButton} from '../icons.js';
import {MeasureList} from '../measures.js';
import {OptionsForm} from './options_form.js';

/// What a handle or anchor takes hold of.
function selectionText({text, event = {}}) {
  const place = (v) => v.map((x) => Math.round(x * 10) / 10).join(', ');
  if (event.grab) return `voxel ${place(event.grab)}`;
  if (event.grab_ball) return `ball at ${place(event.grab_ball)}, ${event.radius ?? 0} mm`;
  if (event.rigid_at) return `bone at ${place(event.rigid_at)}`;
  if (event.grab_box) return `box ${place(event.grab_box)}`;
  return text;
}
function cutText({text, event}) {
  const curve = event?.curve;
  return curve ? `line of ${curve.points?.length ?? 0} points, ${curve.depth} mm deep` : text;
}

/// A stroke of the history.
export const strokeText = ({text, steps}) => steps > 1 ? `${text} (${steps} steps)` : text;

export class DeformPanel {
  constructor(app, root) {
    Object.assign(this, {app, session: app.session, lists: {}});
    root.append(this.toolSection(), this.modelSection(),
                this.listSection('Handles', 'handles', true), this.listSection('Anchors', 'anchors', true),
                this.listSection('Cuts', 'cuts', false), new MeasureList(app).root, this.historySection());
    this.session.on('scene', (scene) => this.refresh(scene));
    this.session.on('connection', (state) => state !== 'lost' && this.loadOptions());
    app.onSettings(() => this.refreshSettings());
  }

  async loadOptions() {
    if (this.relax) return;
    try {
      this.relax = new OptionsForm(await this.session.ask('options', {kind: 'relax'}));
      this.relaxHome.replaceChildren(this.relax.root);
      for (const {name, title, has_keys: hasKeys} of await this.session.ask('options', {kind: 'models'})) {
        if (![...this.model.options].some((option) => option.value === name)) this.model.append(new Option(title, name));
        if (hasKeys && !this.models[name]) await this.addModel(name, title);
      }
    } catch { /* all then have their defaults */ }
  }

  toolSection() {
    const {settings} = this.app;
    const setting = (name, least) => {
      const input = number(settings[name], (value) => { settings[name] = value; }, {min: least, id: 'setting-' + name});
      // What is typed counts at once: a key over a view may begin a stroke.
      input.addEventListener('input', () => {
        if (input.value === '' || !input.checkValidity()) return;
        settings[name] = input.valueAsNumber;
        this.app.refreshViews();
      });
      return input;
    };
    this.radius = setting('radius', 0);
    return section('Tools', true,
      field('Handle radius', this.radius, 'mm', '0: one voxel. The wheel changes it while grabbing'),
      field('Soft edge', setting('soft', 0), 'mm', 'Tissue around the handle that follows in part'),
      field('Joint around bone', setting('joint', 0), 'mm', 'Tissue around a bone that is grabbed is parted first, wherever another bone is so near; 0: it is not'),
      checkbox('Push: tissue is moved ahead and does not stick', settings.push, (push) => { settings.push = push; }),
      field('Depth of cuts', setting('cutDepth', 0.1), 'mm', 'From the surface inwards; in slices half to each side'),
      field('… and above the line', setting('cutAbove', 0), 'mm', 'Against the direction, to cut what is above the points'));
  }
  refreshSettings() { show(this.radius, this.app.settings.radius); }

  modelSection() {
    this.model = select([['ecm', 'ChainMail (ECM)']], 'ecm', (model) => this.chooseModel(model), {id: 'model'});
    this.limits = select(['box', 'ball', 'tighten'], 'box',
                         (limits) => this.session.event({kind: 'limits', limits}), {id: 'limits'});
    this.relaxHome = element('div');
    this.models = {};
    this.modelHomes = {};
    this.modelForms = element('div');
    this.relaxButton = button('Relax (E)', () => this.startRelaxing(), {id: 'relax'});
    this.relaxStop = button('Stop', () => this.session.ask('cancel', true).catch(() => {}), {id: 'relax-stop', hidden: true});
    this.relaxState = element('p', {class: 'note', role: 'status'});
    return section('Model and relaxation', true, field('Model', this.model), this.modelForms,
                   field('Limits of links', this.limits, null,
                     'box: each component of a link; ball: its length; tighten: box, and narrower across stretched links'), this.relaxHome, element('div', {class: 'row'}, this.relaxButton, this.relaxStop), this.relaxState);
  }
  /// The keys of a model, under its title without what comes after a comma.
  async addModel(name, title) {
    this.models[name] = new OptionsForm(await this.session.ask('options', {kind: name}), () => this.chooseModel(name));
    this.modelHomes[name] = element('details', {hidden: this.session.scene?.model !== name}, element('summary', {}, title.split(',')[0]), this.models[name].root);
    this.modelForms.append(this.modelHomes[name]);
    if (this.session.scene) this.model.value = this.session.scene.model ?? 'ecm';
  }
  chooseModel(choice) {
    const model = choice.split('/')[0];
    const isUnderHand = choice !== model || (model === 'fem' && this.model.value === 'fem/hand');
    if (this.models[model] && !this.models[model].isValid()) return;
    const shown = (name) => { const value = this.models[model]?.value(name); return value ? {[name]: value} : {}; };
    const own = model === 'ecm' ? {} : {[model]: {...shown('accuracy'), ...shown('beyond_limits'), ...this.models[model]?.values()}};
    // ChainMail, which is seen first, keeps what finite elements left beyond its limits.
    if (isUnderHand) own[model] = {beyond_limits: 'keep', ...this.models[model]?.values(), accuracy: 'exact'};
    this.session.event({kind: 'model', model, ...(isUnderHand ? {under_hand: true} : {}), ...own});
  }
  startRelaxing() {
    if (!this.session.scene || (this.relax && !this.relax.isValid())) return;
    this.session.event({kind: 'relax', passes: 20, ...this.relax?.values()});
  }

  listSection(title, name, canRelease) {
    const list = element('ul', {class: 'list', 'aria-label': title});
    this.lists[name] = list;
    const row = canRelease ? element('div', {class: 'row'}, button('Let go of all (Shift+A)', () => this.session.event({kind: 'release', all: true}))) : null;
    return section(title, name === 'handles', list, row);
  }

  refresh(scene) {
    for (const input of [this.model, this.limits, this.relaxButton]) input.disabled = !scene;
    if (scene) {
      this.model.value = scene.under_hand ? `${scene.model}/hand` : scene.model ?? 'ecm';
      for (const [model, home] of Object.entries(this.modelHomes)) home.hidden = scene.model !== model;
      this.limits.value = scene.limits ?? 'box';
    }
    this.relaxStop.hidden = !scene?.settling;
    this.relaxState.textContent = !scene ? '' : scene.lead ? leadText(scene.lead) : scene.relaxing ? `Relaxing: ${scene.relaxing} passes to do at most` : scene.settling ? 'The drag settles'
      : scene.relaxes ? 'The material relaxes every drag after its release' : '';
    this.fill('handles', scene?.handles ?? [], (handle, i) => [
      button(`${i + 1}. ${selectionText(handle)}${handle.is_place ? ': a place in the opened state, which nothing holds now' : ''}`, () => this.app.slices.setCursor(this.session.geometry.indexOfLps(handle.lps)),
             {class: 'link', title: 'Cross-hair there'}), handle.number ? this.removal('handle', i, handle.number) : null].filter(Boolean));
    this.fill('anchors', scene?.anchors ?? [], (anchor, i) => [
      this.placed(selectionText(anchor), anchor.event), anchor.number ? this.removal('anchor', i, anchor.number) : null].filter(Boolean));
    this.fill('cuts', scene?.cuts ?? [], (cut, i) => [`${i + 1}. ${cutText(cut)}`,
      cut.number ? iconButton('remove', `Take out cut ${i + 1}`, () => this.session.event({kind: 'release', cut: cut.number}),
                              {title: 'The body is as if it had not been made; later steps are made again'}) : null].filter(Boolean));
    this.refreshHistory(scene);
  }
  fill(name, items, entry) {
    const key = JSON.stringify(items);
    const list = this.lists[name];
    if (list.dataset.key === key) return;
    list.dataset.key = key;
    list.replaceChildren(...items.map((item, i) => element('li', {}, ...entry(item, i))));
    if (!items.length) list.append(element('li', {class: 'none'}, 'None'));
  }
  /// A text that leads the cross-hair to the middle of what is selected.
  placed(text, event) {
    const middle = event?.grab ?? event?.grab_ball;
    return middle ? button(text, () => this.app.slices.setCursor(middle), {class: 'link', title: 'Cross-hair there'}) : text;
  }
  /// `counted`: its number among all that are held or fixed, whether or not they are listed.
  removal(what, i, counted) {
    return iconButton('remove', `Let go of ${what} ${i + 1}`, () => this.session.event({kind: 'release', [what]: counted}),
                      {title: 'Let go of this one; the others stay as they are'});
  }

  historySection() {
    this.history = element('ol', {class: 'list', id: 'history', 'aria-label': 'Steps that can be taken back'});
    return section('History', true, this.history, element('div', {class: 'row'},
      button('Undo', () => this.app.act('undo'), {'aria-keyshortcuts': 'Control+Z'}),
      button('Redo', () => this.app.act('redo'), {'aria-keyshortcuts': 'Control+Shift+Z'})));
  }
  refreshHistory(scene) {
    const undo = scene?.undo ?? [], redo = scene?.redo ?? [];
    const key = JSON.stringify([undo, redo]);
    if (key === this.historyKey) return;
    this.historyKey = key;
    const step = (kind, count) => () => { for (let i = 0; i < count; ++i) this.session.event({kind, all: true, looks: true}); };
    this.history.replaceChildren(
      ...undo.map((entry, i) => element('li', {}, button(strokeText(entry), step('undo', undo.length - 1 - i),
        {class: 'link', title: 'Go back to after this'}))),
      ...redo.map((entry, i) => element('li', {class: 'undone'}, button(strokeText(entry), step('redo', i + 1),
        {class: 'link', title: 'Make it again'}))));
    if (!undo.length && !redo.length) this.history.append(element('li', {class: 'none'}, 'Nothing was done yet'));
    if (undo.length) this.history.prepend(element('li', {}, button('As it was opened', step('undo', undo.length), {class: 'link'})));
  }
}
