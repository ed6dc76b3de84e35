// Dialogs that open and save: folders of the server's machine, limited to those of its command line,
// options in the words of the command line's help.

import {button, bytesText, checkbox, element, field, select} from '../elements.js';
import {MaterialChoice} from './material_choice.js';
import {OptionsForm} from './options_form.js';

/// What can be saved: title, name without a better one, extensions.
export const kSaves = {
  state: ['Save state', 'state', ['.vdb']], scene: ['Save scene', 'scene', ['.toml']],
  journal: ['Save journal', 'journal', ['.toml']], measures: ['Save measures', 'measures', ['.csv']], camera: ['Save camera', 'camera', ['.toml']],
  transfer: ['Save transfer function', 'transfer', ['.toml']],
  screenshot: ['Save picture', 'picture', ['.png']], slices: ['Save slices', 'slices', ['.png']],
  turntable: ['Save turntable', 'turn', ['.mp4', '.webm', '_%04d.png']],
  film: ['Save film of the session', 'session', ['.mp4', '.webm', '_%04d.png']],
  warp: ['Export warp', 'warp', ['.nrrd', '.mha', '.nii.gz', '.h5', '.vdb']],
  volume: ['Export deformed volume', 'deformed', ['.nrrd', '.nii.gz', '.mha']]};

/// Options of `save` that each kind has.
const kPictures = ['screenshot', 'turntable', 'film'];
const kOptions = {warp: ['direction'], turntable: ['frames', 'frames_per_second', 'size'],
                  film: ['frames_per_second', 'speed', 'size'], screenshot: ['size']};

const kFolder = 'supple.folder';

class Browser {
  /// A folder's list; `chosen(file, isDouble)` for files, `moved()` in another folder.
  constructor(session, chosen, wanted, moved = () => {}) {
    Object.assign(this, {session, chosen, wanted, moved, path: ''});
    this.where = element('output', {class: 'path'});
    this.up = button('Up', () => this.go(this.parent ?? ''), {title: 'To the folder above'});
    this.roots = button('Folders', () => this.go(''), {title: 'The folders that may be used'});
    this.entries = element('ul', {class: 'files', role: 'listbox', tabindex: 0, 'aria-label': 'Files'});
    this.error = element('p', {class: 'error', role: 'alert'});
    this.entries.addEventListener('keydown', (event) => this.key(event));
    this.root = element('div', {class: 'browser'}, element('div', {class: 'row'}, this.up, this.roots, this.where), this.entries, this.error);
  }

  /// The folder of last time, that of what is open, or the first that may be used.
  async begin() {
    const last = sessionStorage.getItem(kFolder);
    const opened = this.session.scene?.volume.path?.replace(/[^/]*$/, '');
    const {folders} = await this.session.ask('list', {path: ''}).catch(() => ({}));
    for (const path of [last, opened, folders?.[0]].filter(Boolean)) {
      await this.go(path, false);
      if (this.path) return;
    }
    await this.go('');
  }
  /// `tells`: of a folder that cannot be listed.
  async go(path, tells = true) {
    try {
      const listed = await this.session.ask('list', {path});
      Object.assign(this, {path: listed.path ?? path, parent: listed.parent});
      this.error.textContent = '';
      this.fill(listed);
      if (this.path) sessionStorage.setItem(kFolder, this.path);
      this.moved(listed);
    } catch (error) {
      if (!tells) return;
      if (path !== '') await this.go('');
      this.error.textContent = error.message;
    }
  }
  fill({folders, files}) {
    this.where.textContent = this.path || 'Folders that may be used';
    this.up.disabled = !this.path;
    let entries = 0;
    const entry = (cls, text, note, open, file) => element('li', {
      role: 'option', id: `file-${entries++}`, class: cls, 'aria-selected': 'false', 'data-name': text,
      onclick: () => this.pick(text, file, open), ondblclick: () => file && this.chosen(file, true)},
      element('span', {}, text), element('span', {class: 'note'}, note));
    const into = (name) => () => this.go(this.path ? this.path.replace(/\/$/, '') + '/' + name : name);
    this.entries.replaceChildren(
      ...(folders ?? []).map((name) => entry('folder', name, 'folder', into(name))),
      ...(files ?? []).map((file) => entry('file ' + file.kind + (this.wanted(file) ? '' : ' other'), file.name, bytesText(file.bytes), null, file)));
    this.entries.removeAttribute('aria-activedescendant');
    if (!this.entries.children.length) this.entries.append(element('li', {class: 'none'}, 'Empty'));
  }
  pick(name, file, open) {
    if (open) return open();
    for (const one of this.entries.children) one.setAttribute('aria-selected', String(one.dataset.name === name));
    this.chosen(file, false);
  }
  key(event) {
    const all = [...this.entries.querySelectorAll('[role=option]')];
    const at = all.findIndex((one) => one.classList.contains('at'));
    if (event.key === 'Backspace' && this.path) return this.go(this.parent ?? '');
    if (event.key === 'Enter' && at >= 0) {
      event.preventDefault();
      const isAgain = all[at].getAttribute('aria-selected') === 'true';
      return isAgain ? all[at].dispatchEvent(new MouseEvent('dblclick')) : all[at].click();
    }
    const step = {ArrowDown: 1, ArrowUp: -1, Home: -all.length, End: all.length}[event.key];
    if (!step || !all.length) return;
    event.preventDefault();
    all[at]?.classList.remove('at');
    const next = all[Math.min(all.length - 1, Math.max(0, at + step))] ?? all[0];
    next.classList.add('at');
    this.entries.setAttribute('aria-activedescendant', next.id);
    next.scrollIntoView({block: 'nearest'});
  }
}

export class Files {
  constructor(app) {
    Object.assign(this, {app, session: app.session});
    this.dialog = element('dialog', {class: 'dialog', 'aria-labelledby': 'dialog-title'});
    document.body.append(this.dialog);
  }

  /// A dialog with a browser; `accept` gives an error's text to stay open.
  show(title, browser, content, okText, accept) {
    this.dialog.close();
    const ok = element('button', {type: 'submit', class: 'primary'}, okText);
    const form = element('form', {method: 'dialog', onsubmit: async (event) => {
      event.preventDefault();
      ok.disabled = true;
      try {
        await accept();
        this.dialog.close();
      } catch (error) {
        browser.error.textContent = error.message;
      }
      ok.disabled = false;
    }}, element('h2', {id: 'dialog-title'}, title), browser.root, ...content,
      element('div', {class: 'row end'}, button('Cancel', () => {
        if (ok.disabled) this.session.ask('cancel', true).catch(() => {});
        else this.dialog.close();
      }), ok));
    this.dialog.replaceChildren(form);
    this.dialog.showModal();
    (this.dialog.querySelector('#save-name') ?? browser.entries).focus();
    return browser.begin();
  }

  open() {
    let chosen = null, isWhole = false;
    const isWanted = ({kind}) => kind !== 'other';
    const series = button('The whole folder, a DICOM series', () => {
      isWhole = true;
      this.dialog.querySelector('form').requestSubmit();
    }, {id: 'open-folder'});
    const browser = new Browser(this.session, (file, isDouble) => {
      chosen = file;
      if (isDouble) this.dialog.querySelector('form').requestSubmit();
    }, isWanted, ({files}) => {
      chosen = null;
      series.hidden = !(files ?? []).some(({name}) => /\.dcm$|^[^.]+$/i.test(name));
    });
    const material = new MaterialChoice(this.session);
    return this.show('Open a volume, state or scene', browser, [series, ...material.fields], 'Open', async () => {
      const file = isWhole ? '' : chosen?.name;
      isWhole = false;
      if (file === undefined) throw new Error('Choose a file first');
      const name = material.value();
      await this.session.ask('open', {path: browser.path.replace(/\/$/, '') + (file && '/' + file), ...(name ? {material: name} : {})});
      this.app.say(`${file || browser.path} is open`);
    });
  }
  async save(what) {
    if (!this.session.scene) return this.app.say('Nothing is open that could be saved');
    const [title, name, extensions] = kSaves[what];
    this.view = this.app.viewForTools();
    const file = element('input', {type: 'text', value: name + extensions[0], id: 'save-name', required: true});
    const extension = extensions.length > 1 ? select(extensions, extensions[0], (chosen) => {
      const old = extensions.find((one) => file.value.endsWith(one));
      file.value = (old ? file.value.slice(0, -old.length) : file.value) + chosen;
    }, {'aria-label': 'Kind of file'}) : null;
    const force = checkbox('Replace a file of this name', false, () => {}, {id: 'save-force'});
    const browser = new Browser(this.session, (picked) => { file.value = picked.name; },
                                ({name: other}) => extensions.some((one) => other.endsWith(one)));
    const form = new OptionsForm(await this.optionsOf(what));
    const content = [field('Name', element('span', {class: 'pair'}, file, extension)), form.root, force];
    return this.show(title, browser, content, 'Save', async () => {
      if (!browser.path) throw new Error('Choose a folder first');
      if (!form.isValid()) throw new Error('An option is out of its bounds');
      const saved = await this.session.ask('save', {what, path: browser.path.replace(/\/$/, '') + '/' + file.value.trim(),
        force: force.querySelector('input').checked, ...form.values(),
        ...(what === 'screenshot' ? {view: this.view.name} : {}),
        ...(kPictures.includes(what) ? {size: form.value('size')} : {})});
      this.app.embedded.saved({what, ...saved});
      this.app.say(`Saved ${saved.path}, ${bytesText(saved.bytes)}`);
      this.session.addLog({level: 'note', text: `saved ${saved.path}, ${bytesText(saved.bytes)}`});
    });
  }
  /// Pictures are of the view that is at work, as large as it is seen unless told.
  async optionsOf(what) {
    if (!(what in kOptions)) return [];
    const all = await this.session.ask('options', {kind: 'save'}).catch(() => []);
    const size = (what === 'screenshot' ? this.view : this.app.view('3d')).size();
    return all.filter(({name}) => kOptions[what].includes(name))
      .map((option) => option.name === 'size' ? {...option, default: size} : option);
  }
}
