// The material as a table that can be edited: presets, ranges, and curves over density. A change that is
// valid is an event at once.

import {button, element, field, number, section, select} from '../elements.js';
import {iconButton} from '../icons.js';

/// Of single tissues (docs/materials.md); those of whole pictures come from the server.
const kTissues = ['soft-tissue', 'bone', 'brain', 'membrane'];
const kCurves = {
  max_length: ['Longest link', '× rest length'], min_length: ['Shortest link', '× rest length'],
  shear: ['Shear', '× rest length'], shear1: ['Shear, lower axis', '× rest length'], shear2: ['Shear, higher axis', '× rest length'],
  stiffness: ['Stiffness', 'kPa'], density: ['Mass per volume', 'kg/m³'], damping: ['Damping', 'ms'],
  plastic: ['Yield strain', '1']};
const kRanges = {domain: 'Densities of the classes', active: 'Densities that are tissue', rigid: 'Densities that are rigid'};

export class MaterialPanel {
  constructor(app, root) {
    Object.assign(this, {app, session: app.session, table: null});
    this.preset = select([], '', (preset) => preset && this.send({preset}), {id: 'material-preset'});
    this.choices(kTissues);
    this.body = element('div', {class: 'material'});
    this.state = element('p', {class: 'note'});
    root.append(section('Material', false, field('Preset', this.preset), this.state, this.body));
    this.session.on('opened', (scene) => this.load(scene));
    this.session.on('connection', (state) => state !== 'lost' && this.loadPresets());
    this.session.on('scene', (scene) => this.refresh(scene));
  }
  async loadPresets() {
    try {
      const presets = await this.session.ask('materials', true);
      this.choices([...presets.map(({name}) => name), ...kTissues]);
    } catch { /* those of tissues remain */ }
  }
  choices(names) {
    this.preset.replaceChildren(...['', ...names].map((name) => element('option', {value: name}, name || 'Choose…')));
  }

  refresh(scene) {
    this.preset.disabled = !scene;
    const name = scene?.material?.name;
    this.state.textContent = scene?.material ? `${name || 'Own table'}; ${scene.material.fold_free ? 'no cell can fold' : 'cells may fold'}` : '';
    if (name !== this.name && this.name !== undefined) this.load(scene);
    this.name = name;
  }

  async load(scene) {
    this.table = null;
    if (scene) {
      try {
        this.table = await this.session.ask('material', true);
      } catch (error) {
        this.session.addLog({level: 'warning', text: error.message});
      }
    }
    this.draw();
  }

  send(material) {
    this.session.askEvent({kind: 'material', material}).then(() => this.load(this.session.scene), (error) => {
      this.app.say(error.message);
      this.session.addLog({level: 'error', text: error.message});
      this.load(this.session.scene);
    });
    this.preset.value = '';
  }
  change(key, value) {
    const table = {...this.table, [key]: value};
    if (value === undefined) delete table[key];
    this.table = table;
    this.send(table);
  }

  draw() {
    const {table} = this;
    const parts = [];
    for (const key of Object.keys(table ?? {})) {
      if (key in kRanges) parts.push(this.range(key));
      else if (Array.isArray(table[key]) && Array.isArray(table[key][0])) parts.push(this.curve(key));
    }
    const absent = Object.keys(kCurves).filter((key) => table && !(key in table) && !['shear', 'shear1', 'shear2'].includes(key));
    if (absent.length) {
      const add = select([['', 'Add a column…'], ...absent.map((key) => [key, kCurves[key][0]])], '', (key) => {
        if (key) this.change(key, [[table.domain?.[0] ?? 0, {stiffness: 3.25, density: 1060, damping: 10, plastic: 0.05}[key] ?? 1]]);
      }, {'aria-label': 'Add a column'});
      parts.push(element('div', {class: 'row'}, add));
    }
    this.body.replaceChildren(...parts);
  }

  range(key) {
    const [low, high] = this.table[key];
    const input = (value, i) => number(value, (next) => this.change(key, i ? [low, next] : [next, high]),
                                       {'aria-label': `${kRanges[key]}: ${i ? 'to' : 'from'}`});
    return element('fieldset', {}, element('legend', {}, kRanges[key]), element('div', {class: 'pair'}, input(low, 0), '…', input(high, 1)));
  }

  curve(key) {
    const points = this.table[key];
    const axis = /_([ijk])$/.exec(key)?.[1];
    const [title, unit] = kCurves[key] ?? kCurves[key.replace(/_[ijk]$/, '')] ?? [key, ''];
    const name = axis ? `${title}, along ${axis}` : title;
    const set = (i, a) => (value) => this.change(key, points.map((p, k) => k === i ? p.map((v, c) => c === a ? value : v) : p)
      .sort((p, q) => p[0] - q[0]));
    const rows = points.map(([density, value], i) => element('tr', {},
      element('td', {}, number(density, set(i, 0), {'aria-label': `${name}, point ${i + 1}: density`})),
      element('td', {}, number(value, set(i, 1), {'aria-label': `${name}, point ${i + 1}: value`})),
      element('td', {}, iconButton('remove', `${name}: remove point ${i + 1}`, () => this.change(key, points.filter((_, k) => k !== i)),
        {disabled: points.length < 2}))));
    const add = () => {
      const [density, value] = points[points.length - 1];
      this.change(key, [...points, [density + Math.max(1, Math.round(Math.abs(density) / 10)), value]]);
    };
    return element('table', {class: 'curve-table'}, element('caption', {}, name, element('span', {class: 'unit'}, unit)),
      element('thead', {}, element('tr', {}, element('th', {scope: 'col'}, 'Density'), element('th', {scope: 'col'}, 'Value'),
        element('th', {}, button('+', add, {title: 'Add a point', 'aria-label': `${name}: add a point`})))),
      element('tbody', {}, ...rows));
  }
}
