// The bar on top: files, history, tools, and how the page itself looks.

import {button} from './elements.js';
import {iconButton} from './icons.js';
import {kSaves} from './panels/file_dialogs.js';
import {makeTheme} from './theme.js';
import {kTools} from './tools.js';

export class Toolbar {
  constructor(app) {
    this.app = app;
    const at = (id) => document.getElementById(id);
    this.undo = at('undo');
    this.redo = at('redo');
    this.deformed = at('deformed');
    at('open').addEventListener('click', () => app.files.open());
    this.undo.addEventListener('click', () => app.act('undo'));
    this.redo.addEventListener('click', () => app.act('redo'));
    this.deformed.addEventListener('click', () => app.act('deformed'));
    this.amount = at('amount');
    this.amount.addEventListener('input', () => app.showAmount(this.amount.valueAsNumber / 100));
    this.curtain = iconButton('curtain', 'Curtain', () => app.curtain.toggle(), {
      id: 'curtain', 'aria-pressed': 'false', 'aria-keyshortcuts': 'C', title: 'Curtain between at rest and deformed (C); V blinks'});
    at('amount-home').append(this.curtain);
    at('help').addEventListener('click', () => app.help.show());
    at('banner-retry').addEventListener('click', () => app.session.connection.retry());
    this.panelButton = at('toggle-panel');
    this.panelButton.addEventListener('click', () => this.togglePanel());
    // A small screen begins with the pictures.
    if (window.matchMedia('(max-width: 56rem)').matches) this.togglePanel();
    this.makeSaveMenu(at('save'), at('save-menu'));
    this.makeTools(at('tools'));
    makeTheme(at('theme'));
    this.speed = at('speed');
    app.session.on('shown', () => this.tellSpeed());
    this.refresh();
  }

  togglePanel() {
    const hidden = document.body.classList.toggle('panel-hidden');
    this.panelButton.setAttribute('aria-expanded', String(!hidden));
    this.app.sizesChanged();
  }

  makeSaveMenu(opener, menu) {
    const {app} = this;
    const close = (focus) => {
      menu.hidden = true;
      opener.setAttribute('aria-expanded', 'false');
      if (focus) opener.focus();
    };
    for (const [what, [title]] of Object.entries(kSaves)) {
      menu.append(button(title + '…', () => {
        close(false);
        app.files.save(what);
      }, {role: 'menuitem', tabindex: -1, 'data-save': what}));
    }
    menu.append(button('Link to this view (L)', () => {
      close(true);
      app.act('link');
    }, {role: 'menuitem', tabindex: -1, id: 'copy-link'}));
    const items = [...menu.children];
    opener.addEventListener('click', () => {
      menu.hidden = !menu.hidden;
      opener.setAttribute('aria-expanded', String(!menu.hidden));
      if (!menu.hidden) items[0].focus();
    });
    menu.addEventListener('keydown', (event) => {
      const at = items.indexOf(document.activeElement);
      const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
      if (step) items[(at + step + items.length) % items.length].focus();
      else if (event.key === 'Home' || event.key === 'End') items.at(event.key === 'Home' ? 0 : -1).focus();
      else if (event.key === 'Escape' || event.key === 'Tab') close(event.key === 'Escape');
      else return;
      if (event.key !== 'Tab') event.preventDefault();
      event.stopPropagation();
    });
    document.addEventListener('pointerdown', (event) => {
      if (!menu.hidden && !menu.contains(event.target) && !opener.contains(event.target)) close(false);
    });
  }

  makeTools(group) {
    this.tools = kTools.map(([name, title, key]) => iconButton(name, title, () => this.app.tools.choose(name), {
      'data-tool': name, 'aria-pressed': 'false', title: key ? `${title} (${key})` : title,
      'aria-keyshortcuts': key || null}));
    group.append(...this.tools);
  }

  refresh() {
    const {session, tools} = this.app;
    const {scene} = session;
    this.undo.disabled = !scene?.undo?.length;
    this.redo.disabled = !scene?.redo?.length;
    this.deformed.disabled = !scene;
    this.deformed.setAttribute('aria-pressed', String(scene?.deformed ?? true));
    const amount = this.app.amount();
    this.deformed.textContent = scene && !scene.deformed ? 'At rest' : 'Deformed';
    this.amount.disabled = this.curtain.disabled = !scene;
    this.curtain.setAttribute('aria-pressed', String(this.app.curtain.mode !== null));
    this.amount.value = Math.round(100 * amount);
    document.getElementById('amount-text').textContent = `${Math.round(100 * amount)} %`;
    for (const tool of this.tools) {
      tool.setAttribute('aria-pressed', String(tool.dataset.tool === tools.name));
      tool.disabled = !scene;
    }
    document.title = scene ? `${scene.volume.name} – Supple` : 'Supple';
    document.getElementById('name').textContent = scene ? scene.volume.name : '';
    document.getElementById('welcome').hidden = Boolean(scene) || session.state !== 'connected';
  }

  /// Pictures a second and the time from input to picture, once a second.
  tellSpeed() {
    this.frames = (this.frames ?? 0) + 1;
    this.timer ??= setTimeout(() => {
      const {latencies} = this.app.session;
      const last = latencies.percentile(0.95, latencies.ms.slice(-60));
      this.speed.textContent = last === null ? '' : `${this.frames} pictures/s, ${Math.round(last)} ms`;
      this.frames = 0;
      this.timer = null;
    }, 1000);
  }
}
