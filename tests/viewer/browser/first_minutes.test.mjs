// README's first minutes in Chromium, with its own command and material on the real head, each step until
// all has settled; then the same drag at other sizes of the window, and by the keyboard alone, on a small head.

import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {Chromium, kChromium, sleep} from './chromium.mjs';
import {Folder, kSupple, Server, supple, View} from './supple_view.mjs';

const kHead = process.env.SUPPLE_HEAD ?? fileURLToPath(new URL('../../../build/data/ct_head.nhdr', import.meta.url));
const missing = !kChromium ? 'no chromium' : !existsSync(kSupple) ? `no ${kSupple}` : false;
const kPatience = 240;  // s, of a machine that is busy

let folder, browser;
before(async () => {
  if (missing) return;
  folder = new Folder();
  browser = await Chromium.start();
});
after(async () => {
  await browser?.stop();
  folder?.remove();
});

/// A page of `supple view` with these options, in a window of this size, once all is seen.
async function opened(options, width, height) {
  const server = await Server.start(...options);
  const page = await browser.page(server.address, {width, height});
  const view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', kPatience);
  await view.settled(kPatience);
  return {server, page, view, places: await boxes(page)};
}
const boxes = (page) => page.eval(`JSON.stringify([...document.querySelectorAll('.picture')].map((e) => e.getBoundingClientRect()))`);
const said = (page) => page.eval(`document.getElementById('say').textContent`);

/// G over a part of the view in space, `pixels` to the right, Enter.
async function drag({page, view}, [across, down], pixels) {
  const {x, y, width, height} = await page.box('#view-3d .picture');
  const at = [x + across * width, y + down * height];
  await page.move(...at);
  await page.key('g');
  await view.until('there is tissue to grab', '$scene.grab', kPatience);
  for (let i = 1; i <= 10; ++i) {
    await page.move(at[0] + pixels * i / 10, at[1]);
    await sleep(20);
  }
  await view.until('the drag is carried out', '$carriedOut >= $sent', kPatience);
  await page.key('Enter');
  await view.until('it is kept', '!$scene.grab && $carriedOut >= $sent', kPatience);
}
/// Until nothing is left to be done, and no view was drawn anew for anything but the body.
async function rests({page, view, places}) {
  await view.settled(kPatience);
  assert.equal(await view.get('scene.relaxing'), 0);
  assert.equal(await boxes(page), places, 'a view moved');
  assert.deepEqual(page.errors, []);
}

test('the head under ct-head: grab, settle, cut, drag, undo, save, kill, and go on', {
  skip: missing || (existsSync(kHead) ? false : `no ${kHead}`), timeout: 900000}, async (t) => {
  const options = [kHead, '--material', 'ct-head', '--folder', folder.path, '--token', folder.at('.token')];
  let head = await opened(options, 1280, 800);
  const {page, view} = head;
  t.after(() => head.server.stop('SIGKILL'));

  await drag(head, [0.5, 0.6], 10);
  // The camera turns all the while: it is answered, and the drag settles nevertheless.
  await page.eval('supple.latency(true)');
  const turned = Date.now();
  while (await view.get('scene.settling') && Date.now() - turned < 8000) await page.key('ArrowLeft');
  const {count, p95} = await view.get('latency(true)');
  t.diagnostic(`${count} cameras while it settled, 95 % seen within ${Math.round(p95)} ms`);
  await rests(head);
  t.diagnostic(`settled ${((Date.now() - turned) / 1000).toFixed(1)} s after the release`);
  assert.match(await said(page), /^Kept: [\d.]+ .*elements moved/);
  await page.key('1');
  await view.settled(kPatience);

  const {x, y, width, height} = await page.box('#view-3d .picture');
  await page.move(x + 0.5 * width, y + 0.3 * height);
  await page.key('k');
  await page.drag([x + 0.5 * width - 40, y + 0.3 * height], [x + 0.5 * width + 40, y + 0.3 * height], {steps: 10});
  await view.until('it is cut', '$scene.cuts.length === 1', kPatience);
  await page.until('the cut is drawn', `document.querySelector('#view-3d .marks .cut-made')`);
  await rests(head);
  await drag(head, [0.5, 0.55], 10);
  await rests(head);

  const made = await view.undoTexts();
  assert.ok(made.filter((text) => text === 'drag').length === 2 && made.includes('cut'), made.join());
  await view.saved('state', 'head.vdb', {folder: folder.path});
  await view.saved('journal', 'head.toml');
  for (let left = made.length - 1; left >= 0; --left) {
    await page.key('Control+z');
    await page.until('it is told what was taken back', `supple.scene.undo.length === ${left} &&
      document.getElementById('say').textContent.startsWith('Taken back: ')`, kPatience);
  }
  await view.until('all is taken back', '$scene.undo.length === 0 && $carriedOut >= $sent', kPatience);
  await rests(head);

  await head.server.stop('SIGKILL');
  await page.until('the loss is told', `!document.getElementById('banner').hidden`);
  await page.key('Control+z');
  assert.doesNotMatch(await said(page), /^Kept/);
  // A state holds what it fixes and moves; a session goes on with it.
  const server = await Server.start(folder.at('head.vdb'), '--material', 'ct-head', '--folder', folder.path, '--token', folder.at('.token'),
                                    '--port', head.server.port);
  head = {...head, server};
  await view.until('the page is back', '$state === "connected" && $scene && $counts.restarts === 1', kPatience);
  await rests(head);
  await drag(head, [0.5, 0.6], -10);
  await rests(head);
});

for (const [width, height] of [[1920, 1080], [2560, 1440], [390, 844]]) {
  test(`a drag under ct-head settles at ${width} × ${height}`, {skip: missing, timeout: 300000}, async (t) => {
    const all = await opened([folder.at('head.nhdr'), '--material', 'ct-head', '--folder', folder.path], width, height);
    t.after(() => all.server.stop('SIGKILL'));
    await drag(all, [0.5, 0.6], 10);
    await rests(all);
    assert.ok((await all.view.undoTexts()).includes('drag'));
    await all.page.key('Control+z');
    await rests(all);
    await all.page.close();
  });
}

test('by the keyboard alone', {skip: missing, timeout: 300000}, async (t) => {
  const server = await Server.start('--folder', folder.path);
  t.after(() => server.stop('SIGKILL'));
  const page = await browser.page(server.address, {width: 1280, height: 800});
  const view = new View(page);
  const focus = (selector) => page.eval(`document.activeElement.matches(${JSON.stringify(selector)})`);
  const keyUntil = async (key, selector) => {
    for (let tries = 0; tries < 40 && !await focus(selector); ++tries) await page.key(key);
    assert.ok(await focus(selector), `${key} leads to ${selector}`);
  };
  await view.until('the page is connected', 'window.supple && $state === "connected"');
  await page.key('Control+o');
  await page.until('the files are listed', `document.querySelector('dialog[open] [data-name="head.nhdr"]')`);
  await page.until('the materials are listed', `document.querySelectorAll('#open-material option').length > 3`);
  for (let tries = 0; tries < 20 && !await page.eval(`document.querySelector('dialog[open] .at')?.dataset.name === 'head.nhdr'`); ++tries) await page.key('ArrowDown');
  await page.key('Enter');
  await keyUntil('Tab', '#open-material');
  for (let tries = 0; tries < 20 && await page.eval(`document.getElementById('open-material').value`) !== 'ct-head'; ++tries) await page.key('ArrowDown');
  await keyUntil('Tab', 'dialog[open] button[type=submit]');
  await page.key('Enter');
  await view.until('the volume is open', '$scene && $views["3d"].count', kPatience);
  await view.settled(kPatience);
  const places = await boxes(page);
  await keyUntil('F6', '#view-3d .picture');
  await page.key('g');
  await view.until('the tissue at the cross-hair is grabbed', '$scene.grab', kPatience);
  for (const key of ['x', '4', 'Enter']) await page.key(key);
  await view.until('it is kept', '!$scene.grab && $tool === "none" && $carriedOut >= $sent', kPatience);
  await rests({page, view, places});
  assert.ok((await view.undoTexts()).includes('drag'));
  await page.key('Control+s');
  await page.until('the dialog is there', `document.querySelector('dialog[open] .files [data-name]')`);
  await page.key('Enter');
  await page.until('the state is saved', `!document.querySelector('dialog[open]')`, kPatience);
  assert.ok(JSON.parse(supple('info', folder.at('state.vdb'), '--json')));
  await page.key('Control+z');
  await rests({page, view, places});
});
