// Asks for the name under which a session is saved.

import {button, checkbox, element, field} from '../elements.js';

export class SaveDialog {
  /// `save(path, force)` fails with an error that says why.
  constructor(save) {
    this.name = element('input', {type: 'text', id: 'save-name', value: 'session.toml', required: true});
    this.force = checkbox('Replace files of this name', false, () => {}, {id: 'save-force'});
    this.error = element('p', {class: 'error', role: 'alert'});
    const form = element('form', {method: 'dialog', onsubmit: (event) => this.submit(event, save)},
      element('h2', {}, 'Save what was done'),
      element('p', {class: 'note'}, 'A scene, and beside it a track of each instrument: supple run does it again, supple view shows it.'),
      field('Name', this.name), this.force, this.error,
      element('div', {class: 'row end'}, button('Cancel', () => this.dialog.close()), element('button', {type: 'submit', class: 'primary'}, 'Save')));
    this.dialog = element('dialog', {class: 'dialog', 'aria-label': 'Save what was done'}, form);
    document.body.append(this.dialog);
  }

  show() {
    this.error.textContent = '';
    this.dialog.showModal();
    this.name.select();
  }
  async submit(event, save) {
    event.preventDefault();
    const path = this.name.value.endsWith('.toml') ? this.name.value : this.name.value + '.toml';
    try {
      await save(path, this.force.querySelector('input').checked);
      this.dialog.close();
    } catch (error) {
      this.error.textContent = error.message;
    }
  }
}
