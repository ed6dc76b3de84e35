// The page of `supple view` in Chromium, by real mouse, touch and key events. One session from open to
// the last restart, asserted on the page's state, on files that were written, and on pictures.

import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {coarse, difference, partBeyond, readPng} from './png.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, supple, View} from './supple_view.mjs';
import {cameraFrame} from '../../../../tools/viewer/page/camera.js';
import {distance, length, minus} from '../../../../tools/viewer/page/vectors.js';

const kWindow = {width: 900, height: 640};
let folder, server, browser, page, view;

const step = stepsOf(() => page, 60000);

before(async () => {
  if (missing) return;
  folder = new Folder();
  [server, browser] = await Promise.all([
    Server.start('--folder', folder.path, '--token', folder.at('.token')), Chromium.start()]);
  page = await browser.page(server.address, kWindow);
  view = new View(page);
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

const scene = () => view.get('scene');
const camera = () => view.get('camera');
const steps = () => page.eval('supple.scene.undo.reduce((sum, {steps}) => sum + steps, 0)');
const moved = ({lps, rest_lps: rest}) => minus(lps, rest);

/// A grab at a place of a view, led by (dx, dy) pixels; `between` while it is held.
async function grab([x, y], [dx, dy], between = async () => {}) {
  await page.move(x, y);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (let i = 1; i <= 6; ++i) {
    await page.move(x + dx * i / 6, y + dy * i / 6);
    await sleep(20);
  }
  await view.until('the drag is carried out', '$carriedOut >= $sent');
  await between();
}

step('open: a volume is opened by the dialog, and four views show it', async () => {
  await view.until('the page is connected', 'window.supple && $state === "connected"');
  assert.equal(await page.eval(`document.getElementById('welcome').hidden`), false);
  await page.key('Control+o');
  // The only folder that may be used is open at once.
  await page.until('its files are listed', `document.querySelector('dialog[open] [data-name="head.nhdr"]')`);
  await page.until('materials are listed', `document.querySelectorAll('#open-material input').length > 3`);
  const cards = await page.eval(`[...document.querySelectorAll('#open-material .card')].map((card) => {
    const {width, height} = card.querySelector('svg').getBoundingClientRect();
    return [card.querySelector('input').value, width > 20 && height > 20 ? card.querySelector('svg').innerHTML : ''];
  })`);
  assert.deepEqual(cards.map(([name]) => name), ['', 'ct-head', 'ct-body', 'mr-brain', 'elastic-tissue', 'uniform', 'table']);
  assert.equal(new Set(cards.map(([, picture]) => picture)).size, cards.length, 'each has a picture of its own');
  await keep(page, 'opening.png');
  await page.clickOn('[data-name="head.nhdr"]');
  await page.eval(`document.querySelector('#open-material [value=table]').parentElement.scrollIntoView({block: 'center'})`);
  await page.clickOn('#open-material .card:has([value=table])');
  await page.eval(`document.getElementById('material-path').value = ${JSON.stringify(folder.at('soft.toml'))}`);
  await page.clickOn('dialog[open] button[type=submit]');
  await view.until('the volume is open', '$scene && $scene.volume', 30);
  await page.until('the dialog is gone', `!document.querySelector('dialog[open]')`);
  await view.settled();
  const {volume, undo} = await scene();
  assert.deepEqual([volume.dims, undo], [[96, 96, 54], []]);
  for (const name of ['3d', 'axial', 'coronal', 'sagittal']) {
    const picture = await view.picture(name);
    const black = {...picture, pixels: new Uint8Array(picture.pixels.length)};
    assert.ok(difference(picture, black).mean > 5, `the view ${name} is black`);
  }
});

step('the page looks as it did, on a screen and on a phone', async () => {
  for (const [name, width, height] of [['viewer_screen', 1280, 800], ['viewer_phone', 390, 844]]) {
    await page.resize(width, height, 1);
    await sleep(300);
    await view.settled();
    await sleep(300);
    const seen = await page.picture(), file = new URL(`../../../golden/reference/${name}.png`, import.meta.url);
    if (process.env.SUPPLE_UPDATE_GOLDEN) writeFileSync(file, seen);
    const part = partBeyond(coarse(readPng(seen)), coarse(readPng(readFileSync(file))), 24);
    const kept = join(tmpdir(), `${name}.png`);
    if (part > 0.01) writeFileSync(kept, seen);
    assert.ok(part <= 0.01, `${(100 * part).toFixed(2)} % of ${name} differ, see ${kept}`);
  }
  await page.resize(kWindow.width, kWindow.height, 1);
  await sleep(300);
  await view.settled();
});

step('rotate: a drag turns the camera about its target, and the picture follows', async () => {
  const first = await view.picture(), before = await camera();
  const [x, y] = await view.middle();
  await page.drag([x, y], [x + 80, y + 25], {steps: 20});
  await view.settled();
  const now = await camera();
  assert.ok(Math.abs(distance(now.position, now.target) - distance(before.position, before.target)) < 1e-3);
  assert.ok(distance(now.target, before.target) < 1e-6);
  const turned = Math.acos(cameraFrame(now).forward.reduce((sum, v, a) => sum + v * cameraFrame(before).forward[a], 0)) * 180 / Math.PI;
  const {width, height} = await page.box('#view-3d .picture');
  const expected = Math.hypot(80 / width, 25 / height) * 200;
  assert.ok(Math.abs(turned - expected) < expected * 0.06, `turned by ${turned} degrees instead of ${expected}`);
  assert.ok(difference(first, await view.picture()).mean > 2);
  const {counts, views} = {counts: await view.get('counts'), views: await view.get('views')};
  assert.ok(views['3d'].count > 3 && Object.values(views).every(({wentBack}) => wentBack === 0), JSON.stringify([counts, views]));
  await page.key('r');
  await view.settled();
  assert.ok(distance((await camera()).position, before.position) < 1e-3);
});

step('pan, zoom and roll by mouse, standard views by keys', async () => {
  const [x, y] = await view.middle();
  const before = await camera();
  const mm = (c) => 2 * Math.tan(c.fov * Math.PI / 360) * distance(c.position, c.target);
  await page.drag([x, y], [x + 30, y], {modifiers: 8});
  const {height} = await page.box('#view-3d .picture');
  assert.ok(Math.abs(distance((await camera()).target, before.target) - 30 / height * mm(before)) < 0.5);
  await page.wheel(x, y, -200);
  await view.until('the wheel is heard', `Math.abs(Math.hypot(...$camera.position.map((v, a) => v - $camera.target[a])) - ${distance(before.position, before.target)}) > 1`);
  assert.ok(mm(await camera()) < mm(before));
  await page.drag([x + 60, y], [x, y - 60], {modifiers: 2});
  assert.ok(Math.abs((await camera()).up[2]) < 0.95, 'rolled');
  for (const [key, side] of [['1', [0, -1, 0]], ['3', [1, 0, 0]], ['7', [0, 0, 1]], ['Shift+3', [-1, 0, 0]]]) {
    await page.key(key);
    await sleep(50);
    const {position, target} = await camera();
    const from = minus(position, target).map((v) => Math.round(v / distance(position, target)));
    assert.deepEqual(from.map((v) => v + 0), side, `key ${key}`);
  }
  await page.key('1');
  await view.settled();
});

step('a settled picture is that of supple render', async () => {
  await view.saved('state', 'start.vdb', {folder: folder.path});
  await view.saved('camera', 'camera.toml');
  const shown = await view.picture();
  supple('render', folder.at('start.vdb'), '--preset', 'Skin', '--camera', folder.at('camera.toml'), '--size', `${shown.width},${shown.height}`,
         '-o', folder.at('rendered.png'));
  const {mean, most} = difference(shown, readPng(readFileSync(folder.at('rendered.png'))));
  assert.ok(mean < 0.5 && most <= 8, `pictures differ by ${mean} and at most ${most} of 255`);
});

step('preset and transfer function change the look', async () => {
  assert.equal((await scene()).view.preset, 'Skin', 'CT is seen from outside');
  const skin = await view.picture();
  await page.eval(`(() => { const list = document.getElementById('preset'); list.value = 'Bone';
    list.dispatchEvent(new Event('change')); })()`);
  await view.until('the preset is taken', '$scene.view.preset === "Bone"');
  await view.settled();
  const bone = await view.picture();
  assert.ok(difference(bone, skin).mean > 2);
  const [x, y] = await page.middle('.point.opacity[data-point="opacity:1"]');
  const before = (await scene()).view.transfer.opacity;
  await page.drag([x, y], [x + 12, y - 10]);
  await view.until('the curve is taken', `JSON.stringify($scene.view.transfer.opacity) !== ${JSON.stringify(JSON.stringify(before))}`);
  const now = (await scene()).view.transfer.opacity;
  assert.ok(now[1][0] > before[1][0] && now[1][1] >= before[1][1]);
  await page.eval(`document.querySelector('.point.opacity[data-point="opacity:0"]').focus()`);
  await page.key('ArrowRight');
  await view.until('keys move points', `$scene.view.transfer.opacity[0][0] > ${now[0][0]}`);
  await page.eval(`(() => { const list = document.getElementById('preset'); list.value = 'Skin';
    list.dispatchEvent(new Event('change')); })()`);
  await view.settled();
  assert.ok(difference(skin, await view.picture()).mean < 0.1, 'the preset is back');
});

step('slices: wheel, cross-hair, window, zoom', async () => {
  const [x, y] = await view.middle('axial');
  const {cursor} = await view.get('slices');
  await page.wheel(x, y, -100);
  await view.until('the next slice', `$slices.cursor[2] === ${Math.round(cursor[2]) + 1}`);
  await page.click(x + 30, y + 20);
  await view.until('the cross-hair is there', `$slices.cursor[0] !== ${cursor[0]}`);
  const lps = await page.eval(`(() => { const p = supple.place('axial', ${'supple.scene'} && [0, 1, 2].map((r) => supple.slices.cursor.reduce(
    (sum, v, a) => sum + v * supple.scene.volume.affine[4 * r + a], supple.scene.volume.affine[4 * r + 3]))); return p; })()`);
  assert.ok(Math.hypot(lps[0] - x - 30, lps[1] - y - 20) < 1.5, `the cross-hair is at ${lps} instead of ${[x + 30, y + 20]}`);
  const [cx, cy] = await view.middle('coronal');
  const before = await view.get('slices');
  await page.move(cx - 20, cy + 10, {modifiers: 8});
  await view.until('Shift and move lead the cross-hair', `$slices.cursor[2] !== ${before.cursor[2]}`);
  await page.move(x, y);
  await page.key('w');
  await page.drag([x, y], [x + 40, y]);
  await view.until('the window is wider', `$slices.window > ${before.window}`);
  await page.key('w');
  await page.drag([x, y], [x, y + 60], {button: 'right'});
  await view.until('the slice is nearer', '$slices.zoom > 1.05');
  await page.move(x, y);
  await page.key('r');
  await view.until('the slice fits', '$slices.zoom === 1');
  await view.settled();
});

step('grab, drag, release: the tissue goes where the pointer led it', async () => {
  const [x, y] = await view.middle();
  await grab([x, y], [12, 18]);
  const {grab: held} = await scene();
  assert.equal(held.event.kind, 'grab');
  await page.key('Enter');
  await view.until('it is kept', '!$scene.grab && $tool === "none"');
  await view.settled();
  const {handles} = await scene();
  assert.equal(handles.length, 1);
  const {height} = await page.box('#view-3d .picture');
  const c = await camera();
  const mmPerPixel = 2 * Math.tan(c.fov * Math.PI / 360) * distance(c.position, handles[0].rest_lps) / height;
  const way = moved(handles[0]);
  const {right, up} = cameraFrame(c);
  const along = (axis) => way.reduce((sum, v, a) => sum + v * axis[a], 0);
  assert.ok(Math.abs(along(right) - 12 * mmPerPixel) < 1 && Math.abs(along(up) + 18 * mmPerPixel) < 1.2,
            `moved by ${way} mm for ${12 * mmPerPixel}, ${-18 * mmPerPixel}`);
  assert.deepEqual((await view.undoTexts()).filter((kind) => kind !== 'look'), ['drag']);
});

step('Esc restores, X keeps to an axis, the wheel changes the handle', async () => {
  const before = await steps();
  const [x, y] = await view.middle();
  await grab([x - 30, y - 20], [-25, 10], async () => {
    assert.ok(await steps() > before);
    await page.key('Escape');
  });
  await view.until('it is as it was', `!$scene.grab && $scene.undo.reduce((sum, {steps}) => sum + steps, 0) === ${before}`);
  await grab([x - 30, y - 20], [-25, 10], async () => {
    await page.key('x');
    await view.until('it is kept to the axis', '$carriedOut >= $sent');
    const {radius} = await view.get('settings');
    await page.wheel(x - 55, y - 10, -100);
    await view.until('the handle is larger', `$settings.radius > ${radius} && $carriedOut >= $sent`);
    await page.key('Enter');
  });
  await view.until('it is kept', '!$scene.grab && $tool === "none"');
  await view.settled();
  const {handles} = await scene();
  const [left, posterior, superior] = moved(handles.at(-1));
  assert.ok(Math.abs(left) > 2 && Math.abs(posterior) < 0.05 && Math.abs(superior) < 0.05, `moved by ${[left, posterior, superior]}`);
  assert.equal(handles.at(-1).event.radius, (await view.get('settings')).radius);
});

const said = () => page.eval(`document.getElementById('say').textContent`);
const kept = async () => {
  await page.key('Enter');
  await view.until('it is kept', '!$scene.grab && $tool === "none" && $carriedOut >= $sent');
};

step('a stroke owns its keys whatever had the focus, and numbers count as typed', async () => {
  await page.key('Shift+a');
  await view.until('nothing is held', '$scene.handles.length === 0 && $carriedOut >= $sent');
  const before = await steps();
  const [x, y] = await view.middle();
  await page.clickOn('#tab-deform');
  await page.eval(`(() => { const field = document.getElementById('setting-radius'); field.focus(); field.select(); })()`);
  await page.type('8');
  await page.move(x - 20, y - 20);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (const key of ['x', '5']) await page.key(key);
  await page.until('the number is shown', `/5▏mm to the left/.test(document.getElementById('say').textContent)`);
  await kept();
  const {handles, drag} = await scene();
  assert.equal(handles.at(-1).event.radius, 8);
  assert.deepEqual([drag.reached.map(Math.abs), drag.stopped_by], [[5, 0, 0], null]);
  await page.key('Control+z');
  await view.until('it is taken back', `$carriedOut >= $sent && $scene.undo.reduce((sum, {steps}) => sum + steps, 0) === ${before}`);
  assert.match(await said(), /^Taken back: drag/);

  const limits = await page.eval(`(() => { const list = document.getElementById('limits'); list.focus(); return list.value; })()`);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (const key of ['z', '2', '.', '5', 'Backspace', '2', '-']) await page.key(key);
  await page.until('the number is shown', `/-2.2▏mm to the feet/.test(document.getElementById('say').textContent)`);
  await kept();
  assert.deepEqual((await scene()).drag.reached.map(Math.abs), [0, 0, 2.2]);
  await page.key('Control+z');
  await view.until('it is taken back', `$carriedOut >= $sent && $scene.undo.reduce((sum, {steps}) => sum + steps, 0) === ${before}`);
  await page.eval(`document.getElementById('limits').focus()`);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (const key of ['ArrowRight', 'ArrowDown', 'Escape']) await page.key(key);
  await view.until('Esc restores', `$tool === "none" && !$scene.grab && $carriedOut >= $sent`);
  assert.deepEqual([await steps(), await page.eval(`document.getElementById('limits').value`)], [before, limits]);
  await page.eval(`(() => { const field = document.getElementById('setting-radius'); field.value = 5; field.dispatchEvent(new Event('input')); })()`);
});

step('the line says what was asked for and reached, and who stopped it', async () => {
  const before = await steps();
  const [x, y] = await view.middle();
  await page.move(x + 20, y);
  await page.key('a');
  await view.until('tissue is fixed', '$scene.anchors.length === 1');
  await page.until('the anchor is drawn', `document.querySelector('#view-3d .marks .anchor')`);
  await grab([x - 20, y], [-90, 0]);
  await page.until('it is told while it is held', `/ of .* mm, .*anchor 1 at .* stops it/.test(document.getElementById('say').textContent)`);
  await kept();
  assert.match(await said(), /^Kept: [\d.]+ of [\d.]+ mm, .*anchor 1 at [\d, ]+,? stops it; [\d,]+ elements moved/);
  while (await view.get('scene.handles.length') < 2 || await steps() > before) {
    await page.key('Control+z');
    await view.until('it is taken back', '$carriedOut >= $sent');
  }
  await view.settled();
});

step('what takes long shows what it does, and Esc ends it with all that waits behind it', async (t) => {
  const choose = (model) => page.eval(`(() => { const list = document.getElementById('model'); list.value = '${model}'; list.dispatchEvent(new Event('change')); })()`);
  await page.key('Shift+a');
  await view.until('nothing is held', '$scene.handles.length === 0 && $carriedOut >= $sent');
  const before = await steps();
  await choose('springs');
  await view.until('the choice is answered', '$carriedOut >= $sent');
  if (await view.get('scene.model') !== 'springs') await choose('springs');  // that are dear are chosen twice
  await view.until('springs are the model', '$scene.model === "springs" && $carriedOut >= $sent');
  const [x, y] = await view.middle();
  await page.move(x - 40, y + 60);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (let i = 1; i <= 20; ++i) {
    await page.move(x - 40 - 2 * i, y + 60);
    await sleep(30);
  }
  await page.until('work is shown', `!document.getElementById('progress').hidden && document.getElementById('progress-what').textContent`, 30);
  const asked = Date.now();
  await page.key('Escape');
  await view.until('all has ended', `$carriedOut >= $sent && !$scene.grab && $tool === "none" && document.getElementById('progress').hidden`, 20);
  const ms = Date.now() - asked;
  t.diagnostic(`ended after ${ms} ms`);
  assert.ok(ms < 3000, `ended after ${ms} ms`);
  assert.equal(await steps(), before, 'restored');
  await choose('ecm');
  await page.key('Control+z');
  await view.until('as before', '$scene.model === "ecm" && $scene.handles.length === 2 && $carriedOut >= $sent');
  await view.settled();
});

step('anchor, relax and cut', async () => {
  const [x, y] = await view.middle();
  await page.move(x, y - 60);
  await page.key('a');
  await view.until('tissue is fixed', '$scene.anchors.length === 1');
  await page.key('e');
  await view.until('it relaxes', '$scene.undo.some(({kind}) => kind === "relax")', 30);
  await view.settled(30);
  await page.move(x, y);
  await page.key('k');
  await page.drag([x - 40, y + 30], [x + 40, y + 32], {steps: 10});
  await view.until('it is cut', '$scene.cuts.length === 1', 20);
  await page.until('the cut is drawn in space and in slices', `['3d', 'axial', 'coronal', 'sagittal'].filter((name) =>
    document.querySelector('#view-' + name + ' .marks .cut-made')).length >= 2 && document.querySelector('#view-3d .marks .cut-made.deep')`);
  await view.settled(30);
  assert.deepEqual((await view.undoTexts()).slice(-3), ['anchor', 'relax', 'cut']);
  const {event} = (await scene()).cuts[0];
  assert.ok(event.curve.points.length >= 2 && event.curve.depth === 20);
});

step('measure: a distance between two places', async () => {
  const [x, y] = await view.middle('axial');
  await page.move(x, y);
  await page.key('m');
  await page.drag([x - 40, y], [x + 40, y]);
  await view.until('it is measured', '$scene.measures.length === 1');
  const [{lps: [from, to], kind, now}] = (await scene()).measures;
  assert.ok(kind === 'distance' && Math.abs(now - distance(from, to)) < 1e-9);
  assert.ok(now > 20 && Math.abs(from[2] - to[2]) < 0.01);
});

step('journal and state: a replay of what was saved comes to the same body', async () => {
  await view.saved('state', 'worked.vdb');
  await view.saved('journal', 'session.toml');
  supple('replay', folder.at('session.toml'), '--check', folder.at('worked.vdb'));
});

step('undo and redo go back to the beginning and forth again, exactly', async () => {
  const all = await view.undoTexts();
  for (let i = 0; i < all.length; ++i) await page.key('Control+z');
  await view.until('everything is taken back', '$scene.undo.length === 0', 30);
  await view.settled(30);
  await view.saved('state', 'undone.vdb');
  const hash = (name) => JSON.parse(supple('info', folder.at(name), '--json')).state_sha256 ?? JSON.parse(supple('info', folder.at(name), '--json')).sha256;
  assert.equal(hash('undone.vdb'), hash('start.vdb'));
  await page.key('Control+Shift+z');
  await view.until('the first is made again', '$scene.undo.length === 1');
  for (let i = 1; i < all.length; ++i) await page.key('Control+Shift+z');
  await view.until('all are made again', `$scene.undo.length === ${all.length}`, 30);
  await view.settled(30);
  await view.saved('state', 'redone.vdb');
  assert.equal(hash('redone.vdb'), hash('worked.vdb'));
});

step('Space shows the body at rest', async () => {
  const deformed = await view.picture();
  await page.clickOn('#view-3d .picture');
  await page.key(' ');
  await view.until('it is at rest', '$scene.deformed === false');
  await view.settled();
  assert.ok(difference(deformed, await view.picture()).mean > 0.05);
  await page.key(' ');
  await view.until('it is deformed', '$scene.deformed === true');
  await view.settled();
  assert.ok(difference(deformed, await view.picture()).mean < 0.02);
});

step('export: a warp in the words of the command line; an existing file only when told', async () => {
  await view.saved('warp', 'warp.nrrd', {options: {direction: 'material'}});
  assert.deepEqual(JSON.parse(supple('info', folder.at('warp.nrrd'), '--json')).dims, [96, 96, 54]);
  const first = readFileSync(folder.at('warp.nrrd'));
  await view.save('warp', 'warp.nrrd');
  const told = await page.until('it is refused', `document.querySelector('dialog[open] .error').textContent`);
  assert.match(told, /exists/);
  await page.key('Escape');
  await page.until('the dialog is gone', `!document.querySelector('dialog[open]')`);
  await view.saved('warp', 'warp.nrrd', {force: true});
  assert.notDeepEqual(readFileSync(folder.at('warp.nrrd')), first, 'the other direction');
  await view.saved('screenshot', 'picture.png');
  assert.ok(readPng(readFileSync(folder.at('picture.png'))).width > 100);
});

step('clips and lists can be edited', async () => {
  await page.eval(`[...document.querySelectorAll('#panel-look button')].find((b) => /^Box/.test(b.textContent)).click()`);
  await view.until('a box is clipped', '$scene.view.clips.length === 1');
  await page.eval(`document.querySelector('[aria-label="Remove clip 1"]').click()`);
  await view.until('no clip is left', '$scene.view.clips.length === 0');
  const {anchors, handles} = await scene();
  await page.eval(`document.querySelector('[aria-label="Let go of anchor 1"]').click()`);
  await view.until('one is let go of, the others stay', `$carriedOut >= $sent && $scene.handles.length === ${handles.length} &&
    $scene.anchors.length === ${anchors.length - 1}`);
  await page.eval(`document.querySelector('[aria-label="Let go of handle 1"]').click()`);
  await view.until('the other handle stays', `$carriedOut >= $sent && $scene.handles.length === ${handles.length - 1}`);
  assert.deepEqual((await scene()).handles[0].event, handles[1].event);
  await page.eval(`document.querySelector('[aria-label="Take out cut 1"]').click()`);
  await view.until('the cut is taken out', '$carriedOut >= $sent && $scene.cuts.length === 0', 30);
  await view.settled(30);
  const plain = await view.picture();
  const choose = (overlay) => page.eval(`(() => { const list = document.getElementById('overlay'); list.value = '${overlay}';
    list.dispatchEvent(new Event('change')); })()`);
  await choose('energy');
  await page.eval(`document.getElementById('overlay-in-space').click()`);
  await view.until('the overlay has a range', '$scene.slices.overlay_in_space && $scene.slices.overlay_range');
  await view.settled(30);
  assert.ok(difference(plain, await view.picture()).mean > 1, 'the view in space is painted');
  assert.deepEqual(await page.eval(`[...document.querySelectorAll('#view-3d .legend-text')].map((t) => t.textContent)[0]`), 'Strain energy');
  await choose('none');
  await view.until('the overlay is gone', '$scene.slices.overlay === "none"');
  await view.settled(30);
  assert.ok(difference(plain, await view.picture()).mean < 0.02, 'and as it was without');
  await page.eval(`document.getElementById('outline-in-space').click()`);
  await view.until('the outline at rest is asked for', '$scene.slices.outline_in_space');
  await view.settled(30);
  assert.ok(difference(plain, await view.picture()).mean > 0.02, 'the outline at rest is drawn');
  await page.eval(`document.getElementById('outline-in-space').click()`);
  await view.until('it is gone', '!$scene.slices.outline_in_space');
  await view.settled(30);
});

step('double click maximises a view and brings the four back', async () => {
  const [x, y] = await view.middle();
  const before = await page.box('#view-3d .picture');
  await page.doubleClick(x, y);
  await page.until('it is large', `document.querySelector('#view-axial').hidden`);
  await view.settled();
  const after = await page.box('#view-3d .picture');
  assert.ok(after.width > before.width * 1.5);
  assert.equal((await view.get('views'))['3d'].width, Math.round(after.width));
  await page.doubleClick(...await view.middle());
  await page.until('four are back', `!document.querySelector('#view-axial').hidden`);
  await view.settled();
});

step('help lists all keys', async () => {
  await page.key('?');
  await page.until('the help is there', `document.querySelector('dialog.help').open`);
  assert.ok(await page.eval(`document.querySelectorAll('dialog.help kbd').length`) > 40);
  await page.key('Escape');
  await page.until('it is gone', `!document.querySelector('dialog.help').open`);
});

step('everything that can be used has a name for screen readers', async () => {
  await page.send('Accessibility.enable');
  const {nodes} = await page.send('Accessibility.getFullAXTree');
  const roles = ['button', 'textbox', 'spinbutton', 'combobox', 'slider', 'checkbox', 'tab', 'listbox', 'menuitem', 'application', 'link'];
  const used = nodes.filter((node) => !node.ignored && roles.includes(node.role?.value));
  assert.ok(used.length > 40);
  assert.deepEqual(used.filter((node) => !node.name?.value).map((node) => node.role.value), []);
});

step('arrows in the list of files are heard, and Enter twice opens', async () => {
  await page.key('Control+o');
  await page.until('the files are listed', `document.querySelector('dialog[open] [data-name="head.nhdr"]')`);
  assert.equal(await page.eval(`document.activeElement.getAttribute('role')`), 'listbox');
  await page.key('ArrowDown');
  const active = await page.eval(`document.getElementById(document.activeElement.getAttribute('aria-activedescendant'))?.textContent`);
  assert.ok(active, 'the listbox names its active option');
  assert.equal(await page.eval(`[...document.querySelectorAll('dialog[open] button')].find((b) => b.textContent === 'Up').getAttribute('aria-label')`), null);
  await page.key('Escape');
  await page.until('the dialog is gone', `!document.querySelector('dialog[open]')`);
});

step('targets have 24 pixels, and the page a heading and landmarks', async () => {
  for (const tab of ['look', 'deform', 'scene']) {
    await page.clickOn('#tab-' + tab);
    const small = await page.eval(`[...document.querySelectorAll('button, select, input, summary')].filter((e) => e.checkVisibility())
      .map((e) => [e.closest('.check') ?? e, e]).map(([e, own]) => [e.getBoundingClientRect(), own])
      .filter(([b]) => b.width > 1 && (b.width < 23.9 || b.height < 23.9)).map(([b, e]) => [e.getAttribute('aria-label') || e.textContent || e.id, b.width, b.height])`);
    assert.deepEqual(small, [], 'targets below 24 pixels');
  }
  assert.deepEqual(await page.eval(`[document.querySelectorAll('h1').length, document.querySelectorAll('body > :not(header, main, footer, dialog, noscript, script, [role=alert], [role=region])').length]`), [1, 0]);
});

step('nothing is clipped or lies over another at any size of the window', async () => {
  for (const [width, height, scale] of [[1280, 800, 1], [2560, 1440, 1], [390, 844, 2], [640, 400, 2]]) {
    await page.resize(width, height, scale);
    await sleep(150);
    const faults = await page.eval(`(() => {
      const seen = (e) => e.checkVisibility() && e.getBoundingClientRect().width > 0;
      const parts = [...document.querySelectorAll('#toolbar button, #toolbar select, .view-bar > *, #status button')].filter(seen);
      const boxes = parts.map((e) => [e, e.getBoundingClientRect()]);
      const name = (e) => e.getAttribute('aria-label') || e.textContent || e.id;
      const faults = [];
      for (const [e, b] of boxes) {
        if (b.left < -1 || b.top < -1 || b.right > innerWidth + 1 || b.bottom > innerHeight + 1) faults.push('outside: ' + name(e));
        if (e.tagName === 'BUTTON' && e.scrollWidth > e.clientWidth + 1) faults.push('clipped: ' + name(e));
      }
      for (const bar of document.querySelectorAll('.view-bar')) if (seen(bar) && bar.scrollWidth > bar.clientWidth + 1) faults.push('bar: ' + bar.textContent);
      const panel = document.getElementById('panel').getBoundingClientRect();
      for (let i = 0; i < boxes.length; ++i) for (let k = 0; k < i; ++k) {
        const [a, b] = [boxes[i][1], boxes[k][1]];
        if (boxes[i][0].contains(boxes[k][0]) || boxes[k][0].contains(boxes[i][0])) continue;
        if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1) faults.push('over another: ' + name(boxes[i][0]) + ' and ' + name(boxes[k][0]));
      }
      if (document.documentElement.scrollWidth > innerWidth) faults.push('the page scrolls sideways');
      return faults;
    })()`);
    assert.deepEqual(faults, [], `at ${width} × ${height}`);
  }
  await page.resize(kWindow.width, kWindow.height, 1);
  await view.settled();
});

step('nothing moves when a bar, a button or a message comes', async () => {
  for (const [width, height] of [[1280, 800], [2560, 1440], [390, 844], [640, 400]]) {
    await page.resize(width, height, 1);
    await sleep(150);
    const moved = await page.eval(`(() => {
      const boxes = () => JSON.stringify([...document.querySelectorAll('.picture')].map((e) => e.getBoundingClientRect()));
      const before = boxes(), moved = [];
      const shown = (id, text) => {
        const at = document.getElementById(id), was = [at.hidden, at.querySelector('span')?.textContent];
        at.hidden = false;
        if (at.querySelector('span')) at.querySelector('span').textContent = text;
        if (boxes() !== before) moved.push(id);
        [at.hidden] = was;
        if (at.querySelector('span')) at.querySelector('span').textContent = was[1];
      };
      for (const text of ['', 'a long line of what is being done, and for how long it is likely to go on like this']) {
        for (const id of ['progress', 'banner', 'relax-stop']) shown(id, text);
        const say = document.getElementById('say'), said = say.textContent;
        say.textContent = text.repeat(4);
        if (boxes() !== before) moved.push('say');
        say.textContent = said;
        const button = document.getElementById('deformed'), name = button.textContent;
        for (const other of ['At rest', 'Deformed']) {
          button.textContent = other;
          if (boxes() !== before) moved.push(other);
        }
        button.textContent = name;
      }
      return moved;
    })()`);
    assert.deepEqual(moved, [], `at ${width} × ${height}`);
  }
  await page.resize(kWindow.width, kWindow.height, 1);
  await view.settled();
});

step('a page that is loaded again finds its session', async () => {
  const before = await scene(), {session} = await view.get('hello');
  await page.reload();
  await view.until('it is back', 'window.supple && $scene && $views["3d"].count');
  await view.settled();
  const now = await scene();
  assert.equal((await view.get('hello')).session, session);
  assert.deepEqual([now.undo, now.handles, now.anchors], [before.undo, before.handles, before.anchors]);
});

step('a page that is loaded again in mid-drag lets go as Esc does', async () => {
  const before = await scene();
  const [x, y] = await view.middle();
  await grab([x, y], [12, 0]);
  assert.ok((await scene()).undo.length > before.undo.length);
  await page.reload();
  await view.until('it is let go of', `window.supple && $scene && !$scene.grab && $scene.undo.length === ${before.undo.length}`);
  await view.settled();
  assert.deepEqual((await scene()).undo, before.undo);
});

step('two pages show the same session', async () => {
  const other = new View(await browser.page(server.address, kWindow));
  await other.until('the other page is connected', 'window.supple && $scene && $views["3d"].count');
  await page.send('Page.bringToFront');  // browsers slow down pages that are behind another
  const [x, y] = await view.middle();
  await page.drag([x, y], [x - 60, y]);
  const {position} = await camera();
  await other.until('the other one turns, too', `Math.hypot(...$camera.position.map((v, a) => v - ${JSON.stringify(position)}[a])) < 0.01`);
  await view.settled();
  await other.settled();
  assert.ok(difference(await view.picture(), await other.picture()).mean < 0.05);
  assert.deepEqual(other.page.errors, []);
  await other.page.close();
  await page.key('1');
  await view.settled();
});

step('touch: one finger rotates, two zoom, a long press grabs', async () => {
  await page.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 2});
  const [x, y] = await view.middle();
  const before = await camera();
  const fingers = async (paths, pause = 25) => {
    await page.touch('touchStart', paths.map(([from]) => from));
    for (let i = 1; i <= 8; ++i) {
      await page.touch('touchMove', paths.map(([from, to]) => from.map((v, a) => v + (to[a] - v) * i / 8)));
      await sleep(pause);
    }
    await page.touch('touchEnd', []);
  };
  await fingers([[[x, y], [x + 60, y]]]);
  await view.until('one finger turns', `Math.hypot(...$camera.position.map((v, a) => v - ${JSON.stringify(before.position)}[a])) > 20`);
  const turned = await camera();
  await fingers([[[x - 20, y], [x - 60, y]], [[x + 20, y], [x + 60, y]]]);
  await view.until('two fingers zoom', `Math.hypot(...$camera.position.map((v, a) => v - $camera.target[a])) < ${0.5 * distance(turned.position, turned.target)}`);
  await page.key('1');
  await view.settled();
  const done = (await view.undoTexts()).length;
  await page.touch('touchStart', [[x, y]]);
  await view.until('a long press grabs', '$scene.grab', 10);
  for (let i = 1; i <= 5; ++i) {
    await page.touch('touchMove', [[x + 4 * i, y]]);
    await sleep(30);
  }
  await page.touch('touchEnd', []);
  await view.until('lifting keeps', `!$scene.grab && $scene.undo.length === ${done + 1}`);
  await page.send('Emulation.setTouchEmulationEnabled', {enabled: false});
  await view.settled(30);
});

step('a server killed in mid-drag and started again is found again', async () => {
  const [x, y] = await view.middle();
  await grab([x, y], [10, 0]);
  await server.stop('SIGKILL');
  await page.until('the loss is told', `!document.getElementById('banner').hidden`);
  await page.move(x + 20, y);
  server = await Server.start(folder.at('head.nhdr'), '--material', folder.at('soft.toml'), '--folder', folder.path,
                              '--token', folder.at('.token'), '--port', server.port);
  await view.until('the page is back', '$state === "connected" && $counts.restarts === 1 && $scene', 20);
  assert.equal(await page.eval(`document.getElementById('banner').hidden`), true);
  assert.equal(await view.get('tool'), 'none');
  await view.settled();
  await grab([x, y], [10, 0]);
  await page.key('Enter');
  await view.until('it can be grabbed again', '!$scene.grab && $scene.undo.length === 1');
  assert.ok(Object.values(await view.get('views')).every(({wentBack}) => wentBack === 0));
});

step('a server that ends says so', async () => {
  const {code} = await server.stop('SIGINT');
  assert.ok([0, 130, null].includes(code), `exit ${code}: ${server.errors}`);
  const text = await page.until('it is told', `!document.getElementById('banner').hidden && document.getElementById('banner-text').textContent`);
  assert.match(text, /ended|lost/);
});
