// What is open: the volume, the place under the cross-hair, memory, and the log of warnings.

import {bytesText, element, field, number, section, short, show} from '../elements.js';
import {sidesText} from '../geometry.js';
import {length} from '../vectors.js';

export class ScenePanel {
  constructor(app, root) {
    Object.assign(this, {app, session: app.session});
    this.facts = element('dl', {class: 'facts'});
    this.probed = element('dl', {class: 'facts'});
    this.memory = element('tbody');
    this.memorySum = element('tfoot');
    this.logList = element('ol', {class: 'log'});
    this.logBox = element('div', {class: 'log-box', role: 'log', tabindex: 0, 'aria-label': 'Log'}, this.logList);
    this.cursor = ['i', 'j', 'k'].map((name, a) => number('', (value) => {
      const cursor = [...app.slices.now.cursor];
      cursor[a] = value;
      app.slices.setCursor(cursor);
    }, {'aria-label': `Cross-hair: voxel ${name}`, min: 0}));
    root.append(section('Volume', true, this.facts),
                section('Cross-hair', true, field('Voxel', element('span', {class: 'three'}, ...this.cursor)), this.probed),
                section('Memory', true, element('table', {class: 'memory'}, element('thead', {}, element('tr', {},
                  element('th', {scope: 'col'}, 'Held'), element('th', {scope: 'col'}, 'Size'))), this.memory, this.memorySum)),
                section('Log', true, this.logBox));
    this.session.on('scene', (scene) => this.refresh(scene));
    this.session.on('slices', () => this.refreshCursor());
    this.session.on('log', () => this.refreshLog());
  }

  refresh(scene) {
    const key = JSON.stringify([scene?.volume, scene?.moved, scene?.memory]);
    if (key !== this.key) this.fill(scene);
    this.key = key;
    this.refreshCursor();
  }
  fill(scene) {
    const fact = ([name, value]) => [element('dt', {}, name), element('dd', {}, value)];
    const v = scene?.volume;
    this.facts.replaceChildren(...(v ? [
      ['Name', v.name], ['File', v.path], ['Voxels', v.dims.join(' × ')], ['Spacing', v.spacing.map((mm) => short(mm)).join(' × ') + ' mm'],
      ['Densities', v.density.map((d) => short(d)).join(' … ') + (v.hu ? ' HU' : '')],
      ['Elements', v.elements.toLocaleString('en')], ['Moved last', (scene.moved ?? 0).toLocaleString('en')]] : [['', 'Nothing is open']]).flatMap(fact));
    const memory = scene?.memory ?? [];
    this.memory.replaceChildren(...memory.map(({part, bytes, why}) => element('tr', {},
      element('td', {}, element('strong', {}, part), element('span', {class: 'why'}, why)), element('td', {class: 'bytes'}, bytesText(bytes)))));
    this.memorySum.replaceChildren(...(memory.length ? [element('tr', {}, element('th', {scope: 'row'}, 'Together'),
      element('td', {class: 'bytes'}, bytesText(memory.reduce((sum, {bytes}) => sum + bytes, 0))))] : []));
  }

  refreshCursor() {
    const {cursor} = this.app.slices.now;
    for (const [a, input] of this.cursor.entries()) {
      input.disabled = !cursor;
      show(input, cursor ? Math.round(cursor[a] * 10) / 10 : '');
    }
    const key = JSON.stringify([cursor, this.session.lastCarriedOut]);
    if (!cursor || !this.session.geometry || key === this.cursorKey) return;
    this.cursorKey = key;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.probe(), 150);
  }
  /// Density and displacement at the cross-hair, by a pick where a slice shows it.
  async probe() {
    const lps = this.app.slices.cursorLps();
    const rows = lps ? [['Place', sidesText(lps) + ' mm']] : [];
    const view = ['axial', 'coronal', 'sagittal'].map((name) => this.app.view(name)).find((v) => v.isVisible && v.plane);
    try {
      const hit = view && lps && await this.session.ask('pick', {view: view.name, at: view.pixelOf(lps)});
      if (hit) {
        rows.push(['Density', short(hit.density)], ['Tissue', hit.element ? `voxel ${hit.voxel.join(', ')} at rest` : 'none']);
        if (hit.displacement) rows.push(['Displacement', `${short(length(hit.displacement), 3)} mm (${sidesText(hit.displacement)})`]);
      }
    } catch { /* place alone */ }
    this.probed.replaceChildren(...rows.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
  }

  refreshLog() {
    const atEnd = this.logBox.scrollTop + this.logBox.clientHeight >= this.logBox.scrollHeight - 8;
    this.logList.replaceChildren(...this.session.log.map(({level, text, time, times}) => element('li', {class: level},
      element('time', {}, time.toTimeString().slice(0, 8)), element('span', {class: 'level'}, level), text + (times ? ` (${times}×)` : ''))));
    if (atEnd) this.logBox.scrollTop = this.logBox.scrollHeight;
  }
}
