// Chromium without a window, driven by its DevTools protocol over a pipe: pages, real mouse, touch and
// key events, pictures. It needs nothing but Node's own modules, and a browser that Debian has.

import {spawn} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export const kChromium = [process.env.SUPPLE_CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome']
  .find((path) => path && existsSync(path));

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/// Asks until the answer is true; fails after `seconds` with what was waited for.
export async function until(what, ask, seconds = 15) {
  const end = Date.now() + seconds * 1000;
  let last;
  while (Date.now() < end) {
    last = await ask();
    if (last) return last;
    await sleep(25);
  }
  throw new Error(`waited ${seconds} s in vain: ${what} (last: ${JSON.stringify(last)})`);
}

export class Chromium {
  static async start() {
    const profile = mkdtempSync(join(tmpdir(), 'supple-chromium-'));
    const flags = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
                   '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage', '--hide-scrollbars', '--mute-audio',
                   '--force-color-profile=srgb', `--user-data-dir=${profile}`, '--remote-debugging-pipe', 'about:blank'];
    const child = spawn(kChromium, flags, {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    return new Chromium(child, profile);
  }

  constructor(child, profile) {
    Object.assign(this, {child, profile, id: 0, waiting: new Map(), listeners: new Map(), rest: ''});
    child.stdio[4].setEncoding('utf8');
    child.stdio[4].on('data', (text) => this.heard(text));
    child.stdio[3].on('error', () => {});
    this.ended = new Promise((resolve) => child.on('exit', resolve));
    this.ended.then(() => {
      for (const {reject} of this.waiting.values()) reject(new Error('chromium has ended'));
    });
  }

  heard(text) {
    const messages = (this.rest + text).split('\0');
    this.rest = messages.pop();
    for (const message of messages.map(JSON.parse)) {
      const one = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (message.error) one?.reject(new Error(message.error.message));
      else if (one) one.resolve(message.result);
      else this.listeners.get(message.sessionId)?.(message);
    }
  }
  send(method, params = {}, sessionId) {
    const id = ++this.id;
    this.child.stdio[3].write(JSON.stringify({id, method, params, sessionId}) + '\0');
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }

  async page(url, options = {}) {
    const {targetId} = await this.send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await this.send('Target.attachToTarget', {targetId, flatten: true});
    const page = new Page(this, sessionId, targetId);
    await page.begin(options);
    if (url) await page.go(url);
    return page;
  }

  async stop() {
    this.send('Browser.close').catch(() => {});
    await Promise.race([this.ended, sleep(3000)]);
    if (this.child.exitCode === null && this.child.signalCode === null) this.child.kill('SIGKILL');
    await this.ended;
    // Its helpers may still be writing.
    for (let tries = 0; tries < 20; ++tries) {
      try {
        return rmSync(this.profile, {recursive: true, force: true});
      } catch {
        await sleep(100);
      }
    }
  }
}

const kModifiers = {Alt: 1, Control: 2, Meta: 4, Shift: 8};
const kCodes = {' ': ['Space', 32], Enter: ['Enter', 13], Escape: ['Escape', 27], Tab: ['Tab', 9], ArrowLeft: ['ArrowLeft', 37],
                ArrowUp: ['ArrowUp', 38], ArrowRight: ['ArrowRight', 39], ArrowDown: ['ArrowDown', 40], Delete: ['Delete', 46],
                F12: ['F12', 123], F6: ['F6', 117], '?': ['Slash', 191], '[': ['BracketLeft', 219], ']': ['BracketRight', 221]};

export class Page {
  constructor(browser, sessionId, targetId) {
    Object.assign(this, {browser, sessionId, targetId, errors: [], loads: 0});
  }
  send(method, params) { return this.browser.send(method, params, this.sessionId); }

  async begin({width = 1280, height = 800, scale = 1, touch = false, light = false}) {
    this.browser.listeners.set(this.sessionId, (message) => this.event(message));
    await this.send('Page.enable');
    await this.send('Runtime.enable');
    await this.send('Log.enable');
    await this.resize(width, height, scale);
    if (touch) await this.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 2});
    await this.colours(light ? 'light' : 'dark');
  }
  event({method, params}) {
    if (method === 'Page.loadEventFired') ++this.loads;
    if (method === 'Runtime.exceptionThrown') this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === 'Runtime.consoleAPICalled' && params.type === 'error') this.errors.push(params.args.map((a) => a.value ?? a.description).join(' '));
    // A lost connection is told by the browser, too; that is no fault of the page.
    if (method === 'Log.entryAdded' && params.entry.level === 'error' && !/ERR_CONNECTION|WebSocket/.test(params.entry.text)) {
      this.errors.push(`${params.entry.text} ${params.entry.url ?? ''}`);
    }
  }
  resize(width, height, deviceScaleFactor = 1) {
    return this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor, mobile: false});
  }
  colours(value) {
    return this.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value}]});
  }
  async go(url) {
    const before = this.loads;
    await this.send('Page.navigate', {url});
    await until('the page is loaded', () => this.loads > before);
  }
  async reload() {
    const before = this.loads;
    await this.send('Page.reload');
    await until('the page is loaded again', () => this.loads > before);
  }
  async close() {
    await this.browser.send('Target.closeTarget', {targetId: this.targetId});
    this.browser.listeners.delete(this.sessionId);
  }

  /// The value of an expression, which may be a promise, in the page.
  async eval(expression) {
    const {result, exceptionDetails} = await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }
  until(what, expression, seconds) { return until(what, () => this.eval(expression), seconds); }

  mouse(type, x, y, more = {}) { return this.send('Input.dispatchMouseEvent', {type, x, y, ...more}); }
  move(x, y, more) { return this.mouse('mouseMoved', x, y, more); }
  press(x, y, more = {}) { return this.mouse('mousePressed', x, y, {button: 'left', clickCount: 1, ...more}); }
  release(x, y, more = {}) { return this.mouse('mouseReleased', x, y, {button: 'left', clickCount: 1, ...more}); }
  async click(x, y, more) {
    await this.move(x, y);
    await this.press(x, y, more);
    await this.release(x, y, more);
  }
  async doubleClick(x, y) {
    await this.click(x, y);
    await this.press(x, y, {clickCount: 2});
    await this.release(x, y, {clickCount: 2});
  }
  wheel(x, y, deltaY, more) { return this.mouse('mouseWheel', x, y, {deltaX: 0, deltaY, ...more}); }
  /// A drag in so many steps, each given time for a picture.
  async drag(from, to, {steps = 8, pause = 16, ...more} = {}) {
    const buttons = {left: 1, right: 2, middle: 4}[more.button ?? 'left'];
    await this.move(...from, more);
    await this.press(...from, more);
    for (let i = 1; i <= steps; ++i) {
      await this.move(...from.map((v, a) => v + (to[a] - v) * i / steps), {button: 'left', buttons, ...more});
      await sleep(pause);
    }
    await this.release(...to, more);
  }
  touch(type, points) {
    return this.send('Input.dispatchTouchEvent', {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
  }

  /// A key with modifiers, as 'Control+z'.
  async key(name) {
    const parts = name === '+' ? ['+'] : name.split('+');
    const key = parts.pop();
    const modifiers = parts.reduce((sum, part) => sum | kModifiers[part], 0);
    const letter = /^[a-zA-Z]$/.test(key), digit = /^\d$/.test(key);
    const shown = letter && parts.includes('Shift') ? key.toUpperCase() : key;
    const [code, number] = kCodes[key] ?? (letter ? ['Key' + key.toUpperCase(), key.toUpperCase().charCodeAt(0)]
      : digit ? ['Digit' + key, key.charCodeAt(0)] : ['', 0]);
    const text = key.length === 1 && !(modifiers & 7) ? shown : key === 'Enter' ? '\r' : undefined;
    const event = {key: shown, code, windowsVirtualKeyCode: number, modifiers};
    await this.send('Input.dispatchKeyEvent', {type: text ? 'keyDown' : 'rawKeyDown', text, ...event});
    await this.send('Input.dispatchKeyEvent', {type: 'keyUp', ...event});
  }
  async type(text) { await this.send('Input.insertText', {text}); }

  /// A PNG file of the page, or of a part of it.
  async picture(clip) {
    const {data} = await this.send('Page.captureScreenshot', {format: 'png', ...(clip ? {clip: {...clip, scale: 1}} : {})});
    return Buffer.from(data, 'base64');
  }
  /// The box of an element in the window.
  box(selector) {
    return this.eval(`(() => { const b = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
      return {x: b.x, y: b.y, width: b.width, height: b.height}; })()`);
  }
  async middle(selector) {
    const {x, y, width, height} = await this.box(selector);
    return [x + width / 2, y + height / 2];
  }
  async clickOn(selector) { await this.click(...await this.middle(selector)); }
}
