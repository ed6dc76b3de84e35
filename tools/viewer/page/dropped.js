// Files that are dropped on the page: a browser gives their bytes and names alone, so they are sent to the
// program, which opens them as a folder of their own.

import {element, bytesText} from './elements.js';

/// The files of a drop, those in dropped folders among them, without hidden ones.
async function filesOf(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.length) return [...transfer.files];
  const files = [];
  for (let entry; (entry = entries.shift());) {
    if (entry.isFile) files.push(await new Promise((resolve, reject) => entry.file(resolve, reject)));
    if (!entry.isDirectory) continue;
    const reader = entry.createReader();
    for (let some; (some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject))).length;) entries.push(...some);
  }
  return files.filter(({name}) => !name.startsWith('.'));
}

export class Dropped {
  constructor(app) {
    Object.assign(this, {app, session: app.session});
    this.hint = element('div', {id: 'drop-hint', hidden: true}, element('p', {}, 'Drop to open: a volume with all its files, a DICOM series, a state, or a scene with its volumes'));
    document.getElementById('views').append(this.hint);
    // Text that is dragged within the page stays the page's.
    const hasFiles = ({dataTransfer}) => dataTransfer?.types.includes('Files');
    window.addEventListener('dragover', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      event.dataTransfer.dropEffect = 'copy';
      this.hint.hidden = false;
    });
    window.addEventListener('dragleave', (event) => { if (!event.relatedTarget) this.hint.hidden = true; });
    window.addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.hint.hidden = true;
      this.open(filesOf(event.dataTransfer));
    });
  }

  get isBusy() { return Boolean(this.request); }
  cancel() { this.request?.abort(); }

  async open(found) {
    if (this.isBusy) return this.app.say('Files are on their way already');
    let group = 0;
    try {
      const files = await found;
      if (!files.length) throw new Error('There are no files in what was dropped');
      group = await this.session.ask('drop', {files: files.map(({name, size}) => ({name, bytes: size}))});
      const all = files.reduce((sum, {size}) => sum + size, 0) || 1;
      let sent = 0;
      this.since = performance.now();
      for (const [i, file] of files.entries()) {
        await this.send(file, `drop/${group}/${i}`, (bytes) => this.tell(`copying ${file.name}, ${bytesText(all)}`, (sent + bytes) / all));
        sent += file.size;
      }
      this.tell(null);
      await this.session.ask('open', {drop: group});
      this.app.say(`${files.length === 1 ? files[0].name : `${files.length} files`}: open, by a copy that goes with the program`);
      return;
    } catch (error) {
      if (group) this.session.ask('drop', {forget: group}).catch(() => {});
      this.app.say(error.message);
      this.session.addLog({level: 'error', text: error.message});
    }
    this.tell(null);
  }

  /// Sends one file; rejects with the program's line.
  send(file, path, told) {
    return new Promise((resolve, reject) => {
      const request = this.request = new XMLHttpRequest();
      const ends = (settle, value) => () => {
        this.request = null;
        settle(value);
      };
      request.open('POST', path);
      request.setRequestHeader('Authorization', 'Bearer ' + this.app.token);
      request.setRequestHeader('Content-Type', 'application/octet-stream');
      request.upload.onprogress = ({loaded}) => told(loaded);
      request.onabort = ends(reject, new Error('Cancelled: nothing was opened'));
      request.onerror = ends(reject, new Error(`${file.name} cannot be sent: the file cannot be read, or the connection ended`));
      request.onload = () => {
        const isThere = request.status === 200;
        (isThere ? ends(resolve) : ends(reject, new Error(request.responseText.trim() || `${file.name} was refused`)))();
      };
      request.send(file);
    });
  }
  tell(what, part) {
    this.session.progress = what && {what, part, ms: performance.now() - this.since};
    this.session.tell('progress', this.session.progress);
  }
}
