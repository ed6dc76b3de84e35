// The page of an operation: joins session, picture, panel and keys. `window.supple` tells tests and
// curious people what is going on; it cannot be written to.

import {Hand, deeper, shifted, pixelOf} from './operation/hand.js';
import {OperationSession} from './operation/operation_session.js';
import {OperationPicture} from './operation/operation_picture.js';
import {OperationPanel, isAlarm} from './operation/operation_panel.js';
import {OperationHelp, bindingOf} from './operation/operation_keys.js';
import {SaveDialog} from './operation/save_dialog.js';
import {makeTheme} from './theme.js';

const kStepMm = 0.05, kLargeStepMm = 0.5;
const kZoomStep = 1.25, kFocusStepMm = 0.2;
const kAlarmMs = 1500;

const at = (id) => document.getElementById(id);

class OperationApp {
  constructor() {
    const socket = new URL('socket', location.href);  // beside the page, wherever a proxy shows it
    socket.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.session = new OperationSession(socket.href, location.hash.slice(1));
    this.chosen = 0;
    this.hand = null;
    this.touches = new Set();  // of which alarms tell
    this.picture = new OperationPicture(this);
    this.panel = new OperationPanel(this);
    this.help = new OperationHelp();
    this.saving = new SaveDialog((path, force) => this.save(path, force));
    makeTheme(at('theme'));
    for (const id of ['pause', 'restart', 'save', 'zoom-in', 'zoom-out', 'focus-tip', 'help']) {
      at(id).addEventListener('click', () => this.act(id));
    }
    at('stereo').addEventListener('change', () => this.session.view({stereo: at('stereo').value}));
    at('banner-retry').addEventListener('click', () => this.session.connection.retry());
    document.addEventListener('keydown', (event) => this.keyDown(event));
    document.addEventListener('keyup', (event) => event.key === ' ' && this.hand?.hold(false));
    window.addEventListener('blur', () => this.hand?.hold(false));
    this.session.on('connection', (state) => this.connectionChanged(state));
    this.session.on('scene', (scene) => this.sceneChanged(scene));
    this.session.on('status', (status) => this.statusChanged(status));
    this.session.on('log', ({text}) => this.say(text));
    this.session.on('shown', () => this.tellSpeed());
  }

  get instruments() { return this.session.scene?.instruments ?? []; }
  get instrument() { return this.instruments[this.chosen]; }

  say(text) { at('say').textContent = text; }

  sceneChanged(scene) {
    document.title = scene ? `${scene.name} – Supple` : 'Supple';
    at('name').textContent = scene?.name ?? '';
    // What can be moved most usefully: the first one that is no lamp.
    const first = this.instruments.findIndex(({is_lamp: isLamp}) => !isLamp);
    if (!this.instrument || this.instrument.is_lamp) this.chosen = Math.max(0, first);
    this.tellHint();
  }

  statusChanged(status) {
    at('clock').textContent = `${status.time_s.toFixed(1)} s`;
    at('pause').setAttribute('aria-pressed', String(status.is_paused));
    at('pause').textContent = status.is_paused ? 'Go on' : 'Pause';
    if (document.activeElement !== at('stereo')) at('stereo').value = status.view.stereo;
    if (!this.hand) return;
    if (this.session.instrument(this.hand.name)?.is_led) this.hand.isTaken = true;
    else if (this.hand.isTaken) this.forget();  // another page has let it go
  }

  /// The chosen instrument follows the mouse from where it is.
  take() {
    const now = this.instrument && this.session.instrument(this.instrument.name);
    if (!now) return;
    const {name} = this.instrument;
    this.hand = new Hand(this.instrument, now.asked, (wish) => this.session.lead(name, wish, this.takeInputTime()));
    this.hand.moveTo(now.asked.tip);
    at('field').classList.add('led');
    this.say(`${name} follows the mouse`);
    this.tellHint();
  }
  letGo() {
    if (!this.hand) return;
    this.hand.end();
    this.session.follow(this.hand.name);
    this.say(`${this.hand.name} follows its track`);
    this.forget();
  }
  /// The hand lets be; the instrument stays where it is.
  forget() {
    this.hand = null;
    at('field').classList.remove('led');
    this.tellHint();
  }
  choose(n) {
    if (n === this.chosen || !this.instruments[n]) return;
    const leads = Boolean(this.hand);
    this.forget();
    this.chosen = n;
    if (leads) this.take();
    else this.say(`${this.instrument.name} is chosen`);
    this.tellHint();
  }
  tellHint() {
    at('hint').textContent = this.instrument && !this.hand ? `Click to take the ${this.instrument.name}; H lists all keys` : '';
  }
  takeInputTime() {
    const time = this.inputTime ?? performance.now();
    this.inputTime = null;
    return time;
  }

  keyDown(event) {
    if (document.querySelector('dialog[open]') || event.defaultPrevented) return;
    const control = event.target.closest?.('button, select, input');
    if (control && [' ', 'Enter', 'ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight'].includes(event.key)) return;
    const binding = bindingOf(event);
    if (!binding) return;
    event.preventDefault();
    this.inputTime = event.timeStamp;
    if (binding.move) return this.step(binding.move, event.shiftKey ? kLargeStepMm : kStepMm);
    if (binding.action === 'choose') return this.choose(Number(event.key) - 1);
    if (binding.action === 'hold' && event.repeat) return;
    this.act(binding.action);
  }

  act(action) {
    const {hand, session} = this;
    const actions = {
      'next': () => this.choose((this.chosen + 1) % this.instruments.length),
      'take': () => hand ? hand.hold(!hand.isHeld) : this.take(),
      'let-go': () => this.letGo(),
      'hold': () => hand ? hand.hold(true) : this.take(),
      'roll-left': () => hand?.roll(5), 'roll-right': () => hand?.roll(-5),
      'zoom-in': () => this.zoom(kZoomStep), 'zoom-out': () => this.zoom(1 / kZoomStep),
      'focus-tip': () => this.focusTip(),
      'focus-deeper': () => this.focus(kFocusStepMm), 'focus-nearer': () => this.focus(-kFocusStepMm),
      'stereo': () => this.nextStereo(),
      'models': () => this.exchangeModels(),
      'pause': () => this.ask(session.status?.is_paused ? 'go' : 'pause'),
      'restart': () => this.restart(),
      'save': () => this.saving.show(), 'help': () => this.help.show()};
    actions[action]?.();
  }
  ask(what) { return this.session.operation(what).catch((error) => this.say(error.message)); }

  /// A move of the tip by a key: right, down and into the picture.
  step([right, down, into], mm) {
    if (!this.hand) return this.take();
    const {size} = this.picture.size;
    const pixel = this.picture.mmPerCssPixel * this.picture.size.scale;
    const aside = shifted(this.picture.camera, this.hand.pose.tip, right * mm / pixel, down * mm / pixel, size);
    this.hand.moveTo(deeper(this.picture.camera, aside, into * mm));
  }
  async restart() {
    await this.ask('restart');
    if (this.hand) this.letGo();
    this.panel.events.replaceChildren();
    this.touches.clear();
    at('alarm').hidden = true;
    this.say('From the beginning');
  }
  async save(path, force) {
    const {files} = await this.session.operation('save', {path, force});
    this.say(`${files.length} files written: ${files[0]}`);
  }

  zoom(factor) { this.session.view({zoom: Math.min(8, Math.max(0.25, this.session.status.view.zoom * factor))}); }
  focus(mm) { this.session.view({focus: deeper(this.picture.camera, this.session.status.view.focus, mm)}); }
  focusTip() {
    const now = this.instrument && this.session.instrument(this.instrument.name);
    if (now) this.session.view({focus: now.pose.tip});
  }
  nextStereo() {
    const list = at('stereo');
    list.selectedIndex = (list.selectedIndex + 1) % list.options.length;
    this.session.view({stereo: list.value});
  }

  exchangeModels() {
    for (const {name, model} of this.session.status.membranes) {
      this.session.takeModel(name, model === 'ecm' ? 'springs' : 'ecm');
      this.say(model === 'ecm' ? `${name} moves by springs` : `${name} moves by ChainMail`);
    }
  }

  /// News that a person is to know at once; an alarm stays for as long as what it tells of.
  tellEvent(event, text) {
    this.say(text);
    const {kind, instrument, at: place} = event, touch = `${instrument} at ${place}`;
    if (kind === 'touch_ended') this.touches.delete(touch);
    if (kind === 'touch' && isAlarm(event)) this.touches.add(touch);
    if (isAlarm(event)) {
      at('alarm').textContent = text;
      at('alarm').hidden = false;
    }
    if (at('alarm').hidden) return;
    clearTimeout(this.alarmTimer);
    if (!this.touches.size) this.alarmTimer = setTimeout(() => { at('alarm').hidden = true; }, kAlarmMs);
  }

  connectionChanged(state) {
    at('banner').hidden = state === 'connected';
    if (state === 'connected') return;
    this.forget();
    at('banner-text').textContent = state === 'ended'
      ? 'The program has ended. Start supple view again and open the address that it prints.'
      : 'The connection to the program is lost. Trying again…';
  }

  /// Pictures a second and the time from input to picture, once a second.
  tellSpeed() {
    this.frames = (this.frames ?? 0) + 1;
    this.speedTimer ??= setTimeout(() => {
      const {latencies} = this.session;
      const last = latencies.percentile(0.95, latencies.ms.slice(-60));
      at('speed').textContent = `${this.frames} pictures/s` + (last === null ? '' : `, ${Math.round(last)} ms`);
      this.frames = 0;
      this.speedTimer = null;
    }, 1000);
  }
}

const app = new OperationApp();
const copy = (value) => value === undefined ? undefined : JSON.parse(JSON.stringify(value));
Object.defineProperty(window, 'supple', {value: Object.freeze({
  get state() { return app.session.state; },
  get scene() { return copy(app.session.scene); },
  get status() { return copy(app.session.status); },
  get events() { return copy(app.session.events); },
  get log() { return copy(app.session.log); },
  get counts() { return {...app.session.counts}; },
  get chosen() { return app.chosen; },
  get leads() { return app.hand?.name ?? null; },
  get asked() { return copy(app.hand?.pose); },
  get decoding() { return app.picture.decoding; },
  /// Where a place is in the picture, in its pixels.
  place: (mm) => pixelOf(app.picture.camera, mm, app.picture.size.size),
  latency: (clear) => app.session.latency(clear),
})});
