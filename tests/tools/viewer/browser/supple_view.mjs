// `supple view` on a folder of its own, its page in Chromium, and what both write.

import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {sleep} from './chromium.mjs';
import {readPng} from './png.mjs';

export const kSupple = process.env.SUPPLE_BINARY ?? 'build/release/bin/supple';
/// Journals of the sessions of this process.
const kState = mkdtempSync(join(tmpdir(), 'supple-state-'));
process.on('exit', () => rmSync(kState, {recursive: true, force: true}));
const kExamples = join(dirname(kSupple), 'supple-examples');

/// A command's output; fails where it fails.
export function supple(...options) {
  return execFileSync(kSupple, options, {encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], timeout: 60000});
}

/// A folder with the small head phantom and a soft material.
export class Folder {
  constructor() {
    this.path = mkdtempSync(join(tmpdir(), 'supple-view-'));
    execFileSync(kExamples, ['phantom', 'small-head', this.at('head.nhdr')], {stdio: 'ignore'});
    writeFileSync(this.at('soft.toml'), 'preset = "soft-tissue"\n');
  }
  at(name) { return join(this.path, name); }
  /// The phantom's densities, i fastest.
  get densities() { return new Int16Array(new Uint8Array(readFileSync(this.at('head.raw'))).buffer); }
  /// Between its voxels.
  densityAt(index) {
    this.values ??= this.densities;
    const low = index.map(Math.floor);
    let sum = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const at = low.map((v, a) => v + ((corner >> a) & 1));
      const weight = at.reduce((w, v, a) => w * (1 - Math.abs(index[a] - v)), 1);
      sum += weight * this.values[at[0] + 96 * (at[1] + 96 * at[2])];
    }
    return sum;
  }
  remove() { rmSync(this.path, {recursive: true, force: true}); }
}

export class Server {
  static async start(...options) {
    // While one works on the page: SUPPLE_PAGE=tools/viewer/page serves it as it is in the tree.
    const page = process.env.SUPPLE_PAGE ? ['--page', process.env.SUPPLE_PAGE] : [];
    const child = spawn(kSupple, ['view', '--no-browser', ...page, ...options], {stdio: ['ignore', 'pipe', 'pipe'],
      env: {...process.env, XDG_STATE_HOME: process.env.XDG_STATE_HOME ?? kState}});
    const server = new Server(child);
    await server.started;
    return server;
  }
  constructor(child) {
    this.child = child;
    this.errors = '';
    child.stderr.setEncoding('utf8').on('data', (text) => { this.errors += text; });
    this.ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve({code, signal})));
    this.started = new Promise((resolve, reject) => {
      let told = '';
      child.stdout.setEncoding('utf8').on('data', (text) => {
        told += text;
        const found = /http:\/\/\S+#\S+/.exec(told);
        if (found) this.address = found[0];
        if (found) resolve();
      });
      this.ended.then(({code}) => reject(new Error(`supple view ended with ${code}: ${this.errors}`)));
    });
    this.started.catch(() => {});
  }
  get port() { return new URL(this.address).port; }
  async stop(signal = 'SIGINT') {
    this.child.kill(signal);
    return this.ended;
  }
}

/// What the tests ask of a page with `window.supple`.
export class View {
  constructor(page) { this.page = page; }
  get(expression) { return this.page.eval('supple.' + expression); }
  until(what, expression, seconds) { return this.page.until(what, expression.replaceAll('$', 'supple.'), seconds); }

  /// All that was sent is carried out, and the pictures of all views are settled ones of it.
  async settled(seconds = 20) {
    await this.until('all is carried out', '$state === "connected" && $scene && $carriedOut >= $sent && !$scene.settling', seconds);
    // Slices are drawn exactly after the picture in space has settled; of four views one slice is seen, or only one view.
    const n = await this.get('barrier()');
    const slice = await this.page.eval(`['axial', 'coronal', 'sagittal'].find((name) => document.querySelector('#view-' + name + ' .picture').clientWidth > 0)`);
    if (slice) await this.until('the slices settle', `$views.${slice}.event >= ${n} && $views.${slice}.settled && !$decoding`, seconds);
    await this.until('the pictures settle at their sizes', `!$decoding && ['3d', 'axial', 'coronal', 'sagittal'].every((name) => {
      const {clientWidth, clientHeight} = document.querySelector('#view-' + name + ' .picture');
      const {settled, width, height} = $views[name];
      return clientWidth === 0 || (settled && width === Math.round(clientWidth * devicePixelRatio) && height === Math.round(clientHeight * devicePixelRatio));
    })`, seconds);
    if (!slice) await sleep(300);
  }
  /// The picture of a view as it is drawn, without marks.
  async picture(name = '3d') {
    const data = await this.page.eval(`document.querySelector('#view-${name} canvas').toDataURL('image/png')`);
    return readPng(Buffer.from(data.split(',')[1], 'base64'));
  }
  middle(name = '3d') { return this.page.middle(`#view-${name} .picture`); }
  undoTexts() { return this.page.eval('supple.scene.undo.map(({kind}) => kind)'); }

  /// Grabs what is at a place of the page, leads it and keeps it.
  async drag([x, y], [dx, dy]) {
    await this.page.move(x, y);
    await this.page.key('g');
    await this.until('the handle is there', '$scene.grab');
    for (let i = 1; i <= 6; ++i) {
      await this.page.move(x + dx * i / 6, y + dy * i / 6);
      await sleep(20);
    }
    await this.page.key('Enter');
    await this.until('the drag is carried out', '$carriedOut >= $sent && !$scene.grab', 30);
    await this.settled(60);
  }

  /// Saves by the menu and its dialog, as a person does.
  async save(what, name, {folder, force = false, options = {}} = {}) {
    const {page} = this;
    await page.clickOn('#save');
    await page.clickOn(`[data-save=${what}]`);
    await page.until('the dialog is there', `document.querySelector('dialog[open] .files [data-name]')`);
    if (folder) await this.goTo(folder);
    await page.eval(`document.getElementById('save-name').value = ${JSON.stringify(name)}`);
    for (const [label, value] of Object.entries(options)) {
      await page.eval(`(() => { const at = [...document.querySelectorAll('dialog[open] .field')].find((f) => f.textContent.startsWith(${JSON.stringify(label)}));
        at.querySelector('input, select').value = ${JSON.stringify(value)}; })()`);
    }
    if (force) await page.clickOn('#save-force');
    await page.clickOn('dialog[open] button[type=submit]');
  }
  /// To a folder below the one that may be used.
  async goTo(folder) {
    const {page} = this;
    const at = `document.querySelector('dialog[open] .path').textContent`;
    if (await page.eval(at) === folder) return;
    await page.eval(`[...document.querySelectorAll('dialog[open] button')].find((b) => b.textContent === 'Folders').click()`);
    const entry = `[data-name=${JSON.stringify(folder)}]`;
    await page.until('the folder is listed', `document.querySelector(${JSON.stringify('dialog[open] ' + entry)})`);
    await page.clickOn('dialog[open] ' + entry);
    await page.until('the folder is open', `${at} === ${JSON.stringify(folder)}`);
  }
  async saved(what, name, options) {
    await this.save(what, name, options);
    await this.page.until(`${name} is written`, `!document.querySelector('dialog[open]')`, 30);
  }
}

