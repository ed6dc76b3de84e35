// Histogram and transfer function in one drawing: opacity as a curve whose points are dragged, colour
// as a strip below. Points are reached by Tab, moved by arrow keys and removed by Delete.

import {button, element, field, number, show, svg, short} from '../elements.js';
import * as transfers from '../transfer.js';

const kWidth = 300, kHeight = 130, kStrip = 16, kPad = 8;

export class TransferEditor {
  /// `changed(transfer)` for every change, many a second while a point is dragged.
  constructor(changed) {
    this.changed = changed;
    this.transfer = null;
    this.histogram = null;
    this.selected = null;  // {list, index}
    this.whole = false;
    this.drawing = svg('svg', {class: 'transfer', viewBox: `0 0 ${kWidth} ${kHeight + kStrip + 14}`,
                               role: 'group', 'aria-label': 'Transfer function'});
    this.makeFields();
    this.root = element('div', {class: 'transfer-editor'}, this.drawing, this.fields);
    this.drawing.addEventListener('pointerdown', (event) => this.down(event));
    this.drawing.addEventListener('pointermove', (event) => this.move(event));
    this.drawing.addEventListener('pointerup', () => { this.dragged = null; });
    this.drawing.addEventListener('pointercancel', () => { this.dragged = null; });
    this.drawing.addEventListener('dblclick', (event) => this.addColour(event));
    this.drawing.addEventListener('keydown', (event) => this.key(event));
  }

  makeFields() {
    this.density = number('', (value) => this.edit({density: value}));
    this.opacity = number('', (value) => this.edit({opacity: value}), {min: 0, max: 1});
    this.colour = element('input', {type: 'color', oninput: () => this.edit({colour: this.colour.value})});
    this.remove = button('Remove point', () => this.removeSelected());
    this.opacityField = field('Opacity', this.opacity);
    this.colourField = field('Colour', this.colour);
    this.fields = element('div', {class: 'point-fields'}, field('Density', this.density),
                          this.opacityField, this.colourField, this.remove);
    this.shift = number(0, (by) => {
      this.shift.value = 0;
      if (this.transfer) this.apply(transfers.shifted(this.transfer, by));
    });
    this.extent = element('input', {type: 'checkbox', onchange: () => {
      this.whole = this.extent.checked;
      this.range = this.rangeOf();
      this.draw();
    }});
    this.extra = element('div', {class: 'row'}, field('Shift all by', this.shift),
                         element('label', {class: 'check'}, this.extent, 'All densities'));
    this.fields.append(this.extra);
  }

  show(transfer) {
    if (this.dragged || JSON.stringify(transfer) === JSON.stringify(this.transfer)) return;
    const other = transfer?.name !== this.transfer?.name;
    this.transfer = transfer;
    if (other || !this.range) this.range = this.rangeOf();
    if (other) this.selected = null;
    this.draw();
  }
  showHistogram(histogram) {
    this.histogram = histogram;
    this.range = this.rangeOf();
    this.draw();
  }

  /// Densities from left to right: those of the key points with room beside them, or all.
  rangeOf() {
    if (!this.transfer) return null;
    let [low, high] = transfers.domain(this.transfer);
    const room = (high - low) * 0.12 || 50;
    [low, high] = [low - room, high + room];
    if (!this.histogram) return [low, high];
    const {lo, hi} = this.histogram;
    return this.whole ? [Math.min(lo, low), Math.max(hi, high)] : [low, high];
  }
  x(density) { return kPad + (density - this.range[0]) / (this.range[1] - this.range[0]) * (kWidth - 2 * kPad); }
  y(opacity) { return kPad + (1 - opacity) * (kHeight - 2 * kPad); }
  place(event) {
    const box = this.drawing.getBoundingClientRect();
    const scale = (kHeight + kStrip + 14) / box.height;
    const x = (event.clientX - box.left) * kWidth / box.width, y = (event.clientY - box.top) * scale;
    return {x, y, density: this.range[0] + (x - kPad) / (kWidth - 2 * kPad) * (this.range[1] - this.range[0]),
            opacity: 1 - (y - kPad) / (kHeight - 2 * kPad)};
  }

  draw() {
    const focus = document.activeElement?.dataset?.point;
    this.fields.hidden = !this.transfer;
    this.drawing.replaceChildren(...(this.transfer ? this.parts() : []));
    if (focus) this.drawing.querySelector(`[data-point="${focus}"]`)?.focus();
    this.showFields();
  }

  parts() {
    const {opacity, colour} = this.transfer;
    const line = [[this.range[0], opacity[0][1]], ...opacity, [this.range[1], opacity[opacity.length - 1][1]]]
      .map(([d, a]) => `${this.x(d)},${this.y(a)}`).join(' ');
    const stops = colour.map(([d, ...rgb]) => svg('stop', {
      offset: (d - this.range[0]) / (this.range[1] - this.range[0]), 'stop-color': transfers.hexOf(rgb)}));
    const at = (points, list, y, label) => points.map(([d, ...values], index) => svg('circle', {
      class: 'point ' + list + (this.isSelected(list, index) ? ' selected' : ''), cx: this.x(d), cy: y(values), r: 5,
      fill: list === 'colour' ? transfers.hexOf(values) : null, tabindex: 0, role: 'button',
      'data-point': `${list}:${index}`, 'aria-label': label(d, values, index)}));
    return [
      svg('defs', {}, svg('linearGradient', {id: 'transfer-colours'}, ...stops)), this.histogramPath(),
      svg('polyline', {class: 'curve', points: line}),
      svg('rect', {class: 'strip', x: kPad, y: kHeight, width: kWidth - 2 * kPad, height: kStrip, fill: 'url(#transfer-colours)'}),
      this.tick(this.range[0], 'start'), this.tick(this.range[1], 'end'),
      ...at(opacity, 'opacity', ([a]) => this.y(a), (d, [a], i) => `Opacity point ${i + 1}: density ${short(d)}, opacity ${short(a, 2)}`),
      ...at(colour, 'colour', () => kHeight + kStrip / 2, (d, rgb, i) => `Colour point ${i + 1}: density ${short(d)}, ${transfers.hexOf(rgb)}`)];
  }
  tick(density, anchor) {
    const made = svg('text', {class: 'tick', x: this.x(density), y: kHeight + kStrip + 11, 'text-anchor': anchor});
    made.textContent = short(density);
    return made;
  }

  /// Counts on a logarithmic scale, as the many voxels of air would hide all others.
  histogramPath() {
    if (!this.histogram) return svg('g');
    const {lo, hi, counts} = this.histogram;
    const step = (hi - lo) / counts.length;
    const bins = counts.map((count, i) => [lo + i * step, lo + (i + 1) * step, Math.log1p(count)])
      .filter(([from, to]) => to > this.range[0] && from < this.range[1]);
    const most = Math.max(1, ...bins.map(([, , height]) => height));
    const clamp = (d) => Math.min(this.range[1], Math.max(this.range[0], d));
    const path = bins.map(([from, to, height]) => `M${this.x(clamp(from))},${this.y(0)}V${this.y(height / most)}H${this.x(clamp(to))}V${this.y(0)}Z`);
    return svg('path', {class: 'histogram', d: path.join('')});
  }

  isSelected(list, index) { return this.selected?.list === list && this.selected.index === index; }
  select(list, index) {
    this.selected = index < 0 ? null : {list, index};
    this.draw();
    if (this.selected) this.drawing.querySelector(`[data-point="${list}:${index}"]`)?.focus({preventScroll: true});
  }
  showFields() {
    const point = this.selected && this.transfer?.[this.selected.list]?.[this.selected.index];
    for (const input of [this.density, this.opacity, this.colour, this.remove]) input.disabled = !point;
    const isColour = this.selected?.list === 'colour';
    this.opacityField.hidden = isColour;
    this.colourField.hidden = !isColour;
    show(this.density, point ? Number(point[0].toFixed(2)) : '');
    show(this.opacity, point && !isColour ? Number(point[1].toFixed(3)) : '');
    if (point && isColour) show(this.colour, transfers.hexOf(point.slice(1)));
  }

  apply(transfer) {
    this.transfer = transfer;
    this.draw();
    this.changed(transfer);
  }
  edit({density, opacity, colour}) {
    if (!this.selected) return;
    const {list, index} = this.selected;
    const point = this.transfer[list][index];
    if (list === 'opacity') this.apply(transfers.opacityMoved(this.transfer, index, density ?? point[0], opacity ?? point[1]));
    else if (colour) this.apply(transfers.recoloured(this.transfer, index, transfers.rgbOf(colour)));
    else this.apply(transfers.colourMoved(this.transfer, index, density));
  }
  removeSelected() {
    if (!this.selected) return;
    const {list, index} = this.selected;
    this.selected = null;
    this.apply(transfers.removed(this.transfer, list, index));
  }

  down(event) {
    if (!this.transfer || event.button !== 0) return;
    const named = event.target.dataset?.point;
    const place = this.place(event);
    if (named) {
      const [list, index] = named.split(':');
      this.dragged = {list, index: Number(index)};
      this.select(list, Number(index));
    } else if (place.y < kHeight - kPad) {
      const {transfer, index} = transfers.inserted(this.transfer, 'opacity', place.density,
                                                   [Math.min(1, Math.max(0, place.opacity))]);
      if (index < 0) return;
      this.dragged = {list: 'opacity', index};
      this.selected = this.dragged;
      this.apply(transfer);
    } else {
      return;
    }
    this.drawing.setPointerCapture(event.pointerId);
    event.preventDefault();
  }
  move(event) {
    if (!this.dragged) return;
    const {list, index} = this.dragged;
    const {density, opacity} = this.place(event);
    this.apply(list === 'opacity' ? transfers.opacityMoved(this.transfer, index, density, opacity)
                                  : transfers.colourMoved(this.transfer, index, density));
  }
  addColour(event) {
    if (!this.transfer || event.target.dataset?.point) return;
    const place = this.place(event);
    if (place.y < kHeight - kPad) return;
    const {transfer, index} = transfers.inserted(this.transfer, 'colour', place.density);
    if (index < 0) return;
    this.selected = {list: 'colour', index};
    this.apply(transfer);
  }

  key(event) {
    const named = event.target.dataset?.point;
    if (!named) return;
    const [list, text] = named.split(':');
    const index = Number(text);
    const ways = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    if (event.key === 'Enter' || event.key === ' ') {
      this.select(list, index);
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      this.selected = {list, index};
      this.removeSelected();
    } else if (event.key in ways) {
      const [right, up] = ways[event.key];
      const [d, a] = this.transfer[list][index];
      const density = d + right * (this.range[1] - this.range[0]) / (event.shiftKey ? 20 : 200);
      this.selected = {list, index};
      this.apply(list === 'opacity' ? transfers.opacityMoved(this.transfer, index, density, a + up * (event.shiftKey ? 0.1 : 0.01))
                                    : transfers.colourMoved(this.transfer, index, density));
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
