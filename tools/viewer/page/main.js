// The page: joins session, views, tools and panels, and carries out actions. `window.supple` tells tests
// and curious people what is going on; it cannot be written to.

import {SpaceView} from './space_view.js';
import {Slices, SliceView} from './slice_view.js';
import {Layout, makeTabs} from './layout.js';
import {Session} from './session.js';
import {Tools} from './tools.js';
import {Toolbar} from './toolbar.js';
import {Help, listenToKeys} from './keyboard.js';
import {ProgressBar} from './progress.js';
import {Files} from './panels/file_dialogs.js';
import {Dropped} from './dropped.js';
import {Embedded} from './embedded.js';
import {DeformPanel, strokeText} from './panels/deform_panel.js';
import {LookPanel} from './panels/look_panel.js';
import {MaterialPanel} from './panels/material_panel.js';
import {ScenePanel} from './panels/scene_panel.js';
import {exposed} from './exposed.js';
import {Clips} from './clips.js';
import {Curtain} from './curtain.js';
import {PointerValues} from './pointer_values.js';
import {nextSize} from './grab_stroke.js';
import {partsOf, ViewLink} from './link.js';
import {RememberedLooks} from './remembered_looks.js';
import {LeftSession} from './left_session.js';

class App {
  constructor() {
    const {token} = partsOf(location.hash);
    this.token = token;
    const socket = new URL('socket', location.href);  // beside the page, wherever a proxy shows it
    socket.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.session = new Session(socket.href, token);
    this.settings = {radius: 5, soft: 5, joint: 0, push: false, cutDepth: 20, cutAbove: 5, crosshair: true};
    this.settingListeners = [];
    this.slices = new Slices(this.session);
    this.tools = new Tools(this);
    this.pointerValues = new PointerValues(this);
    this.layout = new Layout(this, document.getElementById('views'));
    this.views = [new SliceView(this, 'axial'), new SpaceView(this), new SliceView(this, 'coronal'), new SliceView(this, 'sagittal')];
    this.layout.root.append(...this.views.map((view) => view.root));
    this.clips = new Clips(this);
    this.curtain = new Curtain(this);
    this.active = this.view('3d');
    this.hovered = null;
    this.files = new Files(this);
    this.dropped = new Dropped(this);
    this.progress = new ProgressBar(this.session, this.dropped);
    this.help = new Help();
    this.looks = new RememberedLooks(this);
    const panel = (id) => document.getElementById(id);
    new LookPanel(this, panel('panel-look'));
    new DeformPanel(this, panel('panel-deform'));
    new MaterialPanel(this, panel('panel-deform'));
    new ScenePanel(this, panel('panel-scene'));
    makeTabs(document.querySelector('#panel [role=tablist]'));
    this.toolbar = new Toolbar(this);
    new LeftSession(this);
    this.link = new ViewLink(this);
    this.embedded = new Embedded(this);
    listenToKeys(this);
    this.session.on('connection', (state) => this.connectionChanged(state));
    this.session.on('scene', () => {
      this.toolbar.refresh();
      this.sayAwaited();
    });
    this.session.on('opened', (scene) => this.showNotice(scene?.assumed));
    document.getElementById('notice-close').addEventListener('click', () => this.showNotice());
    this.session.on('slices', () => this.refreshViews());
    this.session.on('log', ({level, text}) => level === 'error' && this.say(text));
    window.addEventListener('focus', () => this.sizesChanged());
    window.addEventListener('online', () => this.session.connection.retry());
    this.activate(this.active);
  }

  view(name) { return this.views.find((view) => view.name === name); }
  /// The view of a key: under the pointer, else with the focus, else the last one.
  viewForTools() {
    if (this.tools.stroke) return this.tools.stroke.view;
    const view = this.hovered ?? this.active;
    return view.isVisible ? view : this.views.find((one) => one.isVisible) ?? view;
  }
  activate(view) {
    this.active = view;
    for (const one of this.views) one.root.classList.toggle('active', one === view);
  }
  refreshViews() { for (const view of this.views) view.refresh(); }

  say(text) {
    this.awaited = null;
    document.getElementById('say').textContent = text;
  }
  /// `text()` once the event `n` is carried out, unless something else is said before.
  sayWhenDone(n, text) {
    this.awaited = {n, text};
  }
  sayAwaited() {
    if (this.awaited && this.session.lastCarriedOut >= this.awaited.n) this.say(this.awaited.text());
  }
  /// Takes a stroke back or makes one again, and says which.
  step(kind, event) {
    const {session} = this;
    if (!session.scene) return;
    const stroke = session.scene[kind]?.at(kind === 'undo' ? -1 : 0);  // the one that is next
    const [done, nothing] = kind === 'undo' ? ['Taken back', 'Nothing is left to take back'] : ['Made again', 'Nothing is left to make again'];
    const n = session.event({kind, all: true, looks: true}, event.timeStamp);
    if (n) this.sayWhenDone(n, () => stroke ? `${done}: ${strokeText(stroke)}` : nothing);
  }
  /// What was assumed when the volume was opened, until it is closed.
  showNotice(text = '') {
    document.getElementById('notice').hidden = !text;
    document.getElementById('notice-text').textContent = text;
  }
  onSettings(listener) { this.settingListeners.push(listener); }
  settingsChanged() { for (const listener of this.settingListeners) listener(); }
  toolChanged() {
    this.toolbar?.refresh();
    this.layout.root.dataset.tool = this.tools.stroke ? 'stroke' : this.tools.name;
  }

  /// The server draws as large as the views are; asked for once sizes have come to rest.
  sizesChanged() {
    clearTimeout(this.sizeTimer);
    this.sizeTimer = setTimeout(() => this.sendSizes(), 60);
  }
  sendSizes() {
    const sizes = Object.fromEntries(this.views.map((view) => [view.name, view.room()]));
    const differs = this.views.some((view) => view.frame && view.isVisible &&
                                    String(view.room()) !== String([view.frame.width, view.frame.height]));
    const key = JSON.stringify(sizes);
    if ((key === this.sizesSent && !differs) || !this.session.connection.isOpen) return;
    this.sizesSent = key;
    this.session.post('size', sizes);
    this.session.timedView = this.view('3d').isVisible ? '3d' : this.views.find((view) => view.isVisible)?.name;
  }

  connectionChanged(state) {
    const banner = document.getElementById('banner');
    banner.hidden = state === 'connected' || state === 'restarted';
    if (!banner.hidden) return this.tellLoss(state);
    for (const view of this.views) view.restart();
    this.sizesSent = null;
    this.sendSizes();
    this.toolbar.refresh();
    if (state === 'restarted') this.say('The server was started again: what was not saved is gone');
  }
  /// Whether the server is gone, has ended, or refuses this page.
  async tellLoss(state) {
    const text = document.getElementById('banner-text');
    this.toolbar.refresh();
    if (state === 'ended') {
      text.textContent = 'The program has ended. Start supple view again and open the address that it prints.';
      return;
    }
    if (!partsOf(location.hash).token) {
      text.textContent = 'The address has no token. Open the address that supple view printed, with all after #.';
      return;
    }
    text.textContent = 'The connection to the program is lost. Trying again…';
    try {
      const answer = await fetch('./', {method: 'HEAD', cache: 'no-store'});
      if (answer.ok && !this.session.connection.isOpen) {
        text.textContent = 'The program answers but refuses this page. If it was started again, open the address that it printed.';
      }
    } catch { /* it does not answer */ }
  }

  /// Carries an action out; false where it has no meaning now.
  act(action, event = new Event('act')) {
    if (this.tools.act(action, event)) return true;
    if (action === 'cancel' && this.curtain.mode) return this.curtain.end() ?? true;
    const {session} = this;
    const view = this.viewForTools();
    const space = this.view('3d');
    const changes = (kind, more = {}) => {
      if (session.scene) session.event({kind, ...more}, event.timeStamp);
    };
    const actions = {
      'undo': () => this.step('undo', event), 'redo': () => this.step('redo', event),
      'relax': () => document.getElementById('relax').click(),
      'let-go': () => changes('release', {all: true}),
      'grab': () => this.tools.start('grab'), 'anchor': () => this.tools.start('anchor'),
      'cut': () => this.tools.start('cut'), 'measure': () => this.tools.start('measure'), 'angle': () => this.tools.start('angle'),
      'window-level': () => this.tools.toggle('window-level'),
      'clear-measures': () => session.scene?.measures.length && changes('measure', {all: true}),
      'curtain': () => this.curtain.toggle(), 'blink': () => event.repeat || this.curtain.blink(),
      'clip-plane': () => this.clips.addPlane(true), 'clip-box': () => this.clips.addVolumeBox(true),
      'deformed': () => this.showDeformed(!(session.scene?.deformed ?? true)),
      'reset-view': () => view.reset(event.timeStamp), 'projection': () => space.toggleProjection(event.timeStamp),
      'maximise': () => this.layout.toggle(view.name), 'next-view': () => this.layout.next(),
      'brush-larger': () => this.resizeBrush(1), 'brush-smaller': () => this.resizeBrush(-1),
      'open': () => this.files.open(), 'screenshot': () => this.files.save('screenshot'),
      'save-state': () => this.files.save('state'), 'link': () => this.link.copy(), 'help': () => this.help.show()};
    if (action.startsWith('side-')) space.lookFrom(action.slice(5), event.timeStamp);
    else if (action in actions) actions[action]();
    else return view.act(action, event.timeStamp);
    return true;
  }
  showDeformed(deformed) {
    if (!this.session.scene) return;
    this.showAmount(Number(deformed));
    this.say(deformed ? 'The deformed body' : 'The body at rest');
  }
  /// Part of the displacement that is shown: as it was asked for last, until the server has said it.
  amount() { return this.askedAmount ?? this.session.scene?.amount ?? 1; }
  async showAmount(amount) {
    this.askedAmount = amount;
    this.toolbar.refresh();
    if (this.isAskingAmount || !this.session.scene) return;
    this.isAskingAmount = true;
    try {
      for (let sent = null; sent !== this.askedAmount;) {
        sent = this.askedAmount;
        await this.session.ask('deformed', sent);
      }
      if (this.session.scene) this.session.scene.amount = this.askedAmount;
    } catch (error) {
      this.say(error.message);
    }
    this.isAskingAmount = false;
    this.askedAmount = null;
    this.toolbar.refresh();
  }
  resizeBrush(steps) {
    this.settings.radius = nextSize(this.settings.radius, steps);
    this.settingsChanged();
    this.refreshViews();
    this.say(`Radius of handles and anchors: ${this.settings.radius} mm`);
  }
}

const app = new App();
Object.defineProperty(window, 'supple', {value: exposed(app)});
