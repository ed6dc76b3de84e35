// What a volume is made of, chosen at opening: a card with a picture for each kind.

import {element, field, svg} from '../elements.js';

const shape = (tag, attributes) => svg(tag, attributes);
const path = (kind, d) => shape('path', {class: kind, d});
const ellipse = (kind, cx, cy, rx, ry) => shape('ellipse', {class: kind, cx, cy, rx, ry});
const kHead = 'M24 4C12 4 7 12 8 22L5 29l4 2v7q1 4 8 3v4h14q1-6 5-10 5-6 5-14Q41 4 24 4Z';
/// Drawn on a square of 48.
const kPictures = {
  '': () => [path('skin', kHead), path('line', 'M18 19q0-6 6-6t6 5q0 4-6 7v4M24 34v1')],
  'ct-head': () => [path('skin', kHead), path('bone', 'M24 8C15 8 12 14 13 21l4 4-1 6 8 1-1 5-6-1v3l8 1 3-7 4-3q5-5 5-10Q36 8 24 8Z'),
    ellipse('air', 17.5, 22.5, 2.5, 2)],
  'ct-body': () => [ellipse('skin', 24, 24, 21, 15), ellipse('air', 14.5, 21, 6.5, 8), ellipse('air', 33.5, 21, 6.5, 8),
    path('bone', 'M24 29l4 3-1 4h-6l-1-4ZM8 13q-4 9 0 21l-2-1q-3-9 0-19ZM40 13q4 9 0 21l2-1q3-9 0-19ZM22 10h4v3h-4Z')],
  'mr-brain': () => [ellipse('skin', 24, 24, 17, 21), ellipse('air', 24, 24, 14.5, 18.5), ellipse('brain', 24, 24, 13, 17),
    path('line', 'M24 8v32M17 13q4 4 0 7t1 8-1 7M31 13q-4 4 0 7t-1 8 1 7M13 21l4 2M35 21l-4 2')],
  'elastic-tissue': () => [path('brain', 'M6 12q18 9 36 0-5 12 0 24-18-9-36 0 5-12 0-24Z'),
    path('line', 'M17 15q1 9 0 17M31 15q-1 9 0 17M9 20q15 4 30 0M9 28q15-4 30 0')],
  'uniform': () => [path('brain', 'M4 4h40v40H4Z'), path('line', kHead)],
  'table': () => [path('sheet', 'M10 4h20l8 8v32H10Z'), path('line', 'M30 4v8h8M15 20h18M15 27h18M15 34h18M24 17v20')]};
const kWords = {
  '': ['suggested', 'by the modality or the densities of the volume'],
  'ct-head': ['ct-head', 'CT of a head: bone rigid, no air, no headrest'],
  'ct-body': ['ct-body', 'CT of a trunk: bone rigid, no air, no table'],
  'mr-brain': ['mr-brain', 'MRI of a head: soft, without the background'],
  'elastic-tissue': ['elastic-tissue', 'everything as soft tissue that keeps its volume'],
  'uniform': ['uniform', 'all voxels alike, air too'],
  'table': ['a table of my own…', 'limits over density, from a .toml']};
const kTable = 'table';

export class MaterialChoice {
  constructor(session) {
    this.path = element('input', {type: 'text', id: 'material-path', placeholder: 'a path of a .toml'});
    this.row = field('Table', this.path);
    this.row.hidden = true;
    this.cards = element('div', {class: 'cards'});
    const group = element('fieldset', {id: 'open-material'}, element('legend', {}, 'Material'), this.cards,
      element('p', {class: 'note'}, 'Air, tissue and bone differ by their material. States and scenes bring their own.'));
    this.fields = [group, this.row];
    this.fill([]);
    session.ask('materials', true).then((presets) => this.fill(presets.map(({name}) => name)), () => {});
  }
  fill(presets) {
    const chosen = this.chosen();
    this.cards.replaceChildren(...['', ...presets, 'uniform', kTable].map((name) => this.card(name, name === chosen)));
  }
  card(name, checked) {
    const [title, about] = kWords[name] ?? [name, ''];
    const draw = kPictures[name] ?? kPictures.uniform;
    return element('label', {class: 'card'},
      element('input', {type: 'radio', name: 'material', value: name, checked, onchange: () => { this.row.hidden = this.chosen() !== kTable; }}),
      svg('svg', {viewBox: '0 0 48 48', 'aria-hidden': 'true'}, ...draw()),
      element('span', {}, element('b', {}, title), element('span', {class: 'note'}, about)));
  }
  chosen() { return this.cards.querySelector('input:checked')?.value ?? ''; }
  /// A preset, the path of a table, or nothing, which is what fits the volume.
  value() { return this.chosen() === kTable ? this.path.value.trim() : this.chosen(); }
}
