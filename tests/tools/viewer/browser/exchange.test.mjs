// What goes into the page and out of it, in Chromium: measures that follow tissue and become a table, files that
// are dropped, and the viewer in a page of another origin.

import assert from 'node:assert/strict';
import {existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, supple, View} from './supple_view.mjs';
import {distance, minus} from '../../../../tools/viewer/page/vectors.js';
import {valueOf} from '../../../../tools/viewer/page/measures.js';

/// A port of another origin.
async function freePort() {
  const taken = createServer();
  await new Promise((resolve) => taken.listen(0, '127.0.0.1', resolve));
  const {port} = taken.address();
  await new Promise((resolve) => taken.close(resolve));
  return port;
}

const kWindow = {width: 1100, height: 760};
let homePort;
let folder, server, browser, page, view;

const step = stepsOf(() => page);

before(async () => {
  if (missing) return;
  folder = new Folder();
  homePort = await freePort();
  mkdirSync(folder.at('saved'));
  writeFileSync(folder.at('saved/a.toml'), '');
  mkdirSync(folder.at('scratch'));  // where the program puts what is dropped
  process.env.TMPDIR = folder.at('scratch');
  server = await Server.start(folder.at('head.nhdr'), '--material', folder.at('soft.toml'), '--folder', folder.at('saved'), '--drop-limit', '20', '--embed', `http://127.0.0.1:${homePort}/`);
  delete process.env.TMPDIR;
  browser = await Chromium.start();
  page = await browser.page(server.address, kWindow);
  view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 60);
  await view.settled(60);
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

const partOf = async (name, [fx, fy]) => {
  const {x, y, width, height} = await page.box(`#view-${name} .picture`);
  return [x + Math.round(fx * width), y + Math.round(fy * height)];
};
const measures = async () => (await view.get('scene')).measures;
const tableOf = (text) => text.trim().split('\n').map((line) => line.split(','));

step('distances and angles stay, follow tissue, are taken back and become a table', async () => {
  await page.eval(`document.getElementById('tab-deform').click()`);
  const [x, y] = await partOf('3d', [0.5, 0.5]);
  const places = [[x, y], [x - 50, y], [x - 20, y + 60]];
  // A distance by one drag, an angle by three clicks.
  await page.move(x, y);
  await page.key('m');
  await page.drag([x + 45, y + 75], places[0], {steps: 6});
  await view.until('the distance is there', '$scene.measures.length === 1');
  await page.key('n');
  for (const place of places) await page.click(...place);
  await view.until('the angle is there', '$scene.measures.length === 2');
  const [long, wide] = await measures();
  assert.deepEqual([long.kind, long.unit, wide.kind, wide.unit], ['distance', 'mm', 'angle', 'degrees']);
  for (const {lps, rest_lps: rest, now, at_rest: atRest} of [long, wide]) {
    assert.ok(Math.abs(valueOf(lps) - now) < 1e-6 && Math.abs(now - atRest) < 1e-6 && distance(lps[0], rest[0]) < 1e-6);
  }
  const at = await page.eval(`supple.place('3d', ${JSON.stringify(wide.lps[1])})`);
  assert.ok(Math.hypot(at[0] - places[1][0], at[1] - places[1][1]) < 1, 'where it was clicked');

  await view.drag([x, y], [34, 20]);
  const [longer, wider] = await measures();
  const [handle] = (await view.get('scene')).handles;
  const way = minus(handle.lps, handle.rest_lps);
  assert.ok(distance(way, [0, 0, 0]) > 3);
  assert.ok(distance(minus(longer.lps[1], longer.rest_lps[1]), way) < 0.3, 'the place under the handle goes with it');
  assert.deepEqual(longer.rest_lps, long.rest_lps);
  assert.ok(Math.abs(longer.at_rest - long.now) < 1e-6 && Math.abs(longer.now - longer.at_rest) > 1);
  assert.ok(Math.abs(wider.now - valueOf(wider.lps)) < 1e-6 && Math.abs(wider.now - wider.at_rest) > 2);
  await page.until('both values stand in list and view', `/at rest/.test(document.querySelector('[aria-label=Measures]').textContent) &&
    [...document.querySelectorAll('#view-3d .measure-text')].filter((text) => /at rest/.test(text.textContent)).length === 2`);
  await page.eval(`document.querySelector('[aria-label=Measures]').scrollIntoView()`);
  await page.move(...await page.middle('#toolbar .brand'));
  await keep(page, 'measures.png');

  // On tissue that has moved: it is known where that was.
  const hand = await page.eval(`supple.place('3d', ${JSON.stringify(handle.lps)})`);
  await page.move(...hand);
  await page.key('m');
  await page.click(...hand);
  await page.click(...places[1]);
  await view.until('it is there', '$scene.measures.length === 3');
  const third = (await measures())[2];
  assert.ok(distance(third.lps[0], handle.lps) < 4 && distance(third.rest_lps[0], handle.rest_lps) < 4, JSON.stringify([third, handle]));
  await page.key('Control+z');
  await view.until('it is taken back', '$scene.measures.length === 2');

  // As a table, and by a replay of the journal.
  await view.saved('measures', 'measures.csv');
  await view.saved('journal', 'measured.toml');
  supple('replay', folder.at('saved/measured.toml'), '--measures', folder.at('replayed.csv'), '--quiet');
  const table = readFileSync(folder.at('saved/measures.csv'), 'utf8');
  assert.equal(readFileSync(folder.at('replayed.csv'), 'utf8'), table);
  const [head, first] = tableOf(table);
  assert.deepEqual(head.slice(0, 5), ['name', 'kind', 'unit', 'at_rest', 'now']);
  assert.equal(Number(first[head.indexOf('now')]), longer.now);
  assert.deepEqual(['x2', 'y2', 'z2'].map((name) => Number(first[head.indexOf(name)])), longer.lps[1]);

  // Another page has them; one is removed, all are taken back, and made again.
  const other = await browser.page(server.address, kWindow);
  await other.until('they are there', 'window.supple && supple.scene?.measures.length === 2', 30);
  await other.close();
  await page.eval(`document.querySelector('[aria-label="Remove measure 1"]').click()`);
  await view.until('one is left', '$scene.measures.length === 1 && $scene.measures[0].kind === "angle"');
  await page.key('Control+z');
  await view.until('it is back', '$scene.measures.length === 2');
  await page.key('Shift+M');
  await view.until('none is left', '!$scene.measures.length');
  assert.deepEqual((await view.undoTexts()).slice(-2), ['drag', 'measure']);
  await page.key('Control+z');
  await view.until('all are back', '$scene.measures.length === 2');
  assert.deepEqual((await measures())[0], longer);
  for (let i = 0; i < 3; ++i) await page.key('Control+z');
  await view.until('drag, angle and distance are taken back', '$scene.undo.length === 0 && !$scene.measures.length', 30);
});

step('the viewer stands in a page of another origin that it was told of, and tells it what happens', async (t) => {
  // The page of the documentation, from another port.
  const docs = readFileSync(new URL('../../../../docs/viewer.md', import.meta.url), 'utf8');
  const [, example] = /<!-- example of an embedding page.*-->\n```html\n([^]*?)```/.exec(docs);
  assert.ok(example.trim().split('\n').length <= 12);
  const token = new URL(server.address).hash.slice(1);
  const home = createServer((request, response) => response.setHeader('Content-Type', 'text/html').end(
    example.replaceAll('http://127.0.0.1:8080', server.address.replace(/\/#.*/, '')).replace('TOKEN', token)));
  await new Promise((resolve) => home.listen(homePort, '127.0.0.1', resolve));
  t.after(() => home.close());
  const outer = await browser.page(`http://127.0.0.1:${homePort}/`, kWindow);
  const heard = () => outer.eval('window.heard');
  await outer.eval(`window.heard = []; for (const name of ['ready', 'crosshair', 'stroke', 'saved', 'refused'])
    document.querySelector('supple-view').addEventListener(name, (event) => heard.push({name, ...event.detail}))`);
  await outer.until('the cross-hair is told', `/^-?[\\d.]+, -?[\\d.]+, -?[\\d.]+ mm LPS$/.test(document.getElementById('place').textContent)`, 30);
  // Hands in the frame, of which the outer page hears, and the other page, which shows the same session.
  const {x, y, width, height} = await outer.box('supple-view');
  await outer.eval('heard.length = 0');
  const isMoved = `heard.some(({name}) => name === 'crosshair')`;
  for (let n = 0; n < 20 && !await outer.eval(isMoved); ++n) {  // until the frame has its picture
    await outer.click(x + 0.45 * width + n, y + 0.33 * height);
    await sleep(500);
  }
  await outer.until('the cross-hair moves', isMoved);
  const place = (await heard()).findLast(({name}) => name === 'crosshair').lps;
  await sleep(300);
  const {volume: {affine}, slices: {cursor}} = await view.get('scene');
  const cursorLps = [0, 1, 2].map((r) => affine[4 * r + 3] + [0, 1, 2].reduce((sum, c) => sum + affine[4 * r + c] * cursor[c], 0));
  assert.ok(distance(place, cursorLps) < 1e-6);
  const hand = [x + 0.82 * width, y + 0.32 * height];
  await outer.move(...hand);
  await outer.key('g');
  await view.until('the handle is there', '$scene.grab', 20);
  for (let i = 1; i <= 6; ++i) {
    await outer.move(hand[0] + 4 * i, hand[1] + i);
    await sleep(20);
  }
  await outer.key('Enter');
  await outer.until('the stroke is told', `heard.some(({name}) => name === 'stroke')`, 30);
  const [handle] = (await view.get('scene')).handles;
  const stroke = (await heard()).find(({name}) => name === 'stroke');
  assert.deepEqual([stroke.kind, stroke.isUndone, stroke.lps, stroke.rest_lps], ['drag', false, handle.lps, handle.rest_lps]);
  assert.ok(distance(stroke.lps, stroke.rest_lps) > 3);
  await sleep(700);
  await keep(outer, 'embedded.png');
  await outer.key('Control+z');
  await outer.until('that it is taken back, too', `heard.some(({name, isUndone}) => name === 'stroke' && isUndone)`, 30);
  await outer.key('Control+s');
  await sleep(1000);
  await outer.key('Enter');
  await outer.until('what was saved is told', `heard.some(({name, what, path}) => name === 'saved' && what === 'state' && /state\\.vdb$/.test(path))`, 30);
  assert.ok(!(await heard()).some(({name}) => name === 'refused'));
  await outer.close();

  // Another origin is not let in: neither the frame nor the module.
  const elsewhere = createServer((request, response) => response.setHeader('Content-Type', 'text/html').end(
    `<iframe src="${server.address}"></iframe><script>window.heard = []; window.onmessage = ({data}) => heard.push(data);
     document.querySelector('iframe').onload = ({target}) => target.contentWindow.postMessage({supple: 'hello'}, '*');</script>`));
  await new Promise((resolve) => elsewhere.listen(0, '127.0.0.1', resolve));
  t.after(() => elsewhere.close());
  const stranger = await browser.page(`http://127.0.0.1:${elsewhere.address().port}/`, kWindow);
  const {pages} = await view.get('hello');
  const isRead = await stranger.eval(`import('${server.address.replace(/#.*/, 'supple-view.js')}').then(() => true, () => false)`);
  await sleep(500);
  assert.deepEqual([isRead, await stranger.eval('heard'), (await view.get('hello')).pages], [false, [], pages]);
  await stranger.close();
});

/// Files of the machine are dropped on the views, as from a file manager.
async function drop(...names) {
  const [x, y] = await view.middle('3d');
  const data = {items: [], files: names.map((name) => folder.at(name)), dragOperationsMask: 1};
  for (const type of ['dragEnter', 'dragOver']) await page.send('Input.dispatchDragEvent', {type, x, y, data});
  await page.until('the page says what to do', `!document.getElementById('drop-hint').hidden`);
  if (names.length === 2) await keep(page, 'drop_hint.png');
  await page.send('Input.dispatchDragEvent', {type: 'drop', x, y, data});
}
const copies = () => readdirSync(folder.at('scratch'), {recursive: true}).filter((name) => /\w\.\w/.test(name)).map((name) => name.replace(/.*\//, '')).sort();

step('files that are dropped open with what belongs to them, and go with the program', async () => {
  const say = (words) => page.until(`${words} is said`, `${words}.test(document.getElementById('say').textContent)`, 30);
  const refused = async (words, ...names) => {
    const {volume} = await view.get('scene'), before = copies();
    await drop(...names);
    await say(words);
    assert.deepEqual([(await view.get('scene')).volume, copies()], [volume, before], String(words));
    assert.equal(await page.eval(`document.getElementById('drop-hint').hidden`), true);
  };
  writeFileSync(folder.at('notes.txt'), 'no volume');
  writeFileSync(folder.at('large.raw'), Buffer.alloc(21e6));
  await refused(/notes\.txt/, 'notes.txt');
  await refused(/head\.raw/, 'head.nhdr');
  await refused(/21 MB to be copied.*at most 20 MB/, 'large.raw');

  await drop('head.nhdr', 'head.raw');
  await view.until('it is open', `$scene.volume.path.startsWith(${JSON.stringify(folder.at('scratch'))})`, 60);
  await say(/2 files: open, by a copy/);
  await view.settled(60);
  const {volume: {dims}, assumed} = await view.get('scene');
  assert.deepEqual(dims, [96, 96, 54]);
  assert.match(assumed, /no material is given/);
  assert.deepEqual(copies(), ['head.nhdr', 'head.raw']);
  await keep(page, 'dropped.png');

  writeFileSync(folder.at('scene.toml'), '[volume]\npath = "head.nhdr"\n[material]\npreset = "soft-tissue"\n[[step]]\nhandles = [{ grab_ball = [47, 80, 26], radius = 5, by = [2, 0, 0] }]\n');
  await drop('scene.toml', 'head.nhdr', 'head.raw');
  await say(/3 files: open/);
  await view.until('its step is done', '$scene.undo.length === 1 && $scene.undo[0].kind === "step"', 60);
  await view.settled(60);
  assert.deepEqual(copies(), ['head.nhdr', 'head.raw', 'scene.toml'], 'what was open before is gone');
  await refused(/head\.nhdr|folders that may be used/, 'scene.toml');  // without its volume

  // A file on its way that is given up.
  writeFileSync(folder.at('large.raw'), Buffer.alloc(15e6));
  await page.eval(`(() => { const send = XMLHttpRequest.prototype.send; XMLHttpRequest.prototype.send = function(body) { send.call(this, body); XMLHttpRequest.prototype.send = send; this.abort(); }; })()`);
  await refused(/Cancelled/, 'large.raw');

  const kept = readdirSync(folder.at('scratch')).filter((name) => name.startsWith('supple-dropped-'));
  assert.equal(kept.length, 1);
  await server.stop();
  assert.ok(!existsSync(folder.at('scratch/' + kept[0])), 'nothing is left of it');
});
