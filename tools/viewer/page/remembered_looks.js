// The look and the window that a person chose last, one of each modality, in this browser: the next volume of
// that modality begins with them, where neither its file nor anybody since has chosen others, and no link leads to
// a view. The modality is that of the header (DICOM), else CT where densities are HU and MR where they are not.

import {button, element, short} from './elements.js';

const kKey = 'supple.looks';

/// A look and a window with other densities: `of` a density, and `scale` of differences of them.
function withDensities({preset, transfer, window, level}, of, scale) {
  const keys = (list) => list?.map(([density, ...rest]) => [of(density), ...rest]);
  const made = preset ? {preset} : {};
  if (transfer) {
    made.transfer = {...transfer, opacity: keys(transfer.opacity), colour: keys(transfer.colour)};
    if (transfer.gradient_opacity) made.transfer.gradient_opacity = transfer.gradient_opacity.map(([g, o]) => [g * scale, o]);
    if (transfer.full_shading_gradient) made.transfer.full_shading_gradient *= scale;
  }
  return window > 0 ? {...made, window: window * scale, level: of(level)} : made;
}
/// HU are the same everywhere; other densities are kept as parts of a volume's range.
const rangeOf = ({hu, density: [low, high]}) => hu || !(high > low) ? [0, 1] : [low, high - low];
export function keptOf(choice, volume) {
  const [low, size] = rangeOf(volume);
  return withDensities(choice, (density) => (density - low) / size, 1 / size);
}
export function choiceOf(kept, volume) {
  const [low, size] = rangeOf(volume);
  return withDensities(kept, (part) => low + part * size, size);
}

export class RememberedLooks {
  constructor(app) {
    Object.assign(this, {app, session: app.session, kept: {}});
    try {
      this.kept = JSON.parse(localStorage.getItem(kKey)) ?? {};
    } catch { /* nothing is remembered */ }
    this.note = element('span', {class: 'note'});
    this.root = element('div', {class: 'row', id: 'remembered', hidden: true}, this.note,
                        button('Forget', () => this.forget(), {title: 'Back to the look and the window of the program'}));
    this.session.on('chosen', (choice) => this.remember(choice));
    this.session.on('opened', () => this.refresh());
  }

  get volume() { return this.session.scene?.volume; }
  get modality() { return this.volume?.modality?.name; }

  /// What a person chose: `preset` or `transfer`, or `window` and `level`.
  remember(choice) {
    const {volume, modality} = this;
    if (!modality) return;
    const isLook = choice.preset || choice.transfer;
    const {preset, transfer, ...others} = this.kept[modality] ?? {};
    this.keep({...(isLook ? others : this.kept[modality]), ...keptOf(choice, volume)});
  }
  keep(kept) {
    if (kept) this.kept[this.modality] = kept;
    else delete this.kept[this.modality];
    try {
      localStorage.setItem(kKey, JSON.stringify(this.kept));
    } catch { /* until the page is closed */ }
    this.refresh();
  }

  /// A volume that was opened gets them.
  async begin() {
    const kept = this.kept[this.modality];
    if (!kept) return;
    const {preset, transfer, window, level} = choiceOf(kept, this.volume);
    const {first, slices} = this.session.scene;
    const isFirst = slices.window === first.window && slices.level === first.level;
    if (window && isFirst) this.app.slices.set({window, level});
    try {
      const hasBegun = (preset || transfer) && await this.session.ask('begin', preset ? {preset} : {transfer});
      if (hasBegun || (window && isFirst)) this.app.say(`As ${this.modality} was looked at last; Forget in the panel Look goes back`);
    } catch (error) {
      this.session.addLog({level: 'warning', text: `the look that is remembered for ${this.modality}: ${error.message}`});
    }
  }
  forget() {
    const {first, view} = this.session.scene;
    const {window, level, ...look} = first;
    this.app.say(`Nothing is remembered for ${this.modality}: as it was opened`);
    this.keep(null);
    if (look.transfer || look.preset !== view.preset) this.session.event({kind: 'look', ...look});
    this.app.slices.set({window, level});
  }

  refresh() {
    const kept = this.kept[this.modality];
    this.root.hidden = !kept;
    if (!kept) return;
    const {preset, transfer, window, level} = choiceOf(kept, this.volume);
    const look = preset ?? (transfer && (transfer.name || 'own look'));
    const parts = [look, window && `window ${short(window)}, level ${short(level)}`].filter(Boolean);
    const by = this.volume.modality.by === 'header' ? 'by its header' : 'by its densities';
    this.note.textContent = `Remembered for ${this.modality} (${by}): ${parts.join('; ')}`;
  }
}
