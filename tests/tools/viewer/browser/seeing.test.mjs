// The page tells and shows a body without changing it, in Chromium: values under the pointer
// against the volume's file, a part of its displacement, a link. How long values take is told, not judged.

import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {loadavg} from 'node:os';
import {join} from 'node:path';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {readPng} from './png.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, View} from './supple_view.mjs';
import {distance, length, minus} from '../../../../tools/viewer/page/vectors.js';

const kWindow = {width: 1100, height: 760};
const kViews = ['3d', 'axial', 'coronal', 'sagittal'];
let folder, server, browser, page, view, volume;

const step = stepsOf(() => page);

const labelOf = ([i, j, k]) => 1 + Number(i >= 48) + 2 * Number(k >= 27);

before(async () => {
  if (missing) return;
  folder = new Folder();
  const header = readFileSync(folder.at('head.nhdr'), 'latin1');
  const labels = new Uint8Array(96 * 96 * 54);
  for (let n = 0; n < labels.length; ++n) labels[n] = labelOf([n % 96, Math.floor(n / 96) % 96, Math.floor(n / 9216)]);
  writeFileSync(folder.at('labels.raw'), labels);
  writeFileSync(folder.at('labels.nhdr'), header.replace('int16', 'uint8').replace('head.raw', 'labels.raw'));
  writeFileSync(folder.at('scene.toml'), '[volume]\npath = "head.nhdr"\n[labels]\npath = "labels.nhdr"\n[material]\npreset = "soft-tissue"\n');
  server = await Server.start(folder.at('scene.toml'), '--folder', folder.path);
  browser = await Chromium.start();
  page = await browser.page(server.address, kWindow);
  view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 60);
  await view.settled(60);
  volume = await view.get('scene.volume');
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

/// The hit of the pointer at a place of the window, as it is told once the pointer rests there.
async function valuesAt(x, y) {
  await page.move(x, y);
  await view.until('values are told', `$pointer.at && Math.hypot($pointer.at[0] - ${x}, $pointer.at[1] - ${y}) < 0.01`);
  return view.get('pointer');
}
const partOf = async (name, [fx, fy]) => {
  const {x, y, width, height} = await page.box(`#view-${name} .picture`);
  return [x + Math.round(fx * width), y + Math.round(fy * height)];
};

step('values under the pointer are those of the files, in all views', async () => {
  for (const name of kViews) {
    for (const part of [[0.5, 0.5], [0.42, 0.55], [0.56, 0.45]]) {
      const [x, y] = await partOf(name, part);
      const {lines, hit} = await valuesAt(x, y);
      const shown = await page.eval(`supple.place('${name}', ${JSON.stringify(hit.lps)})`);
      assert.ok(Math.hypot(shown[0] - x, shown[1] - y) < 0.6, `${name}: the place lies under the pointer`);
      assert.ok(Math.abs(hit.density - folder.densityAt(hit.index)) < 0.01, `${name}: ${hit.density} instead of ${folder.densityAt(hit.index)}`);
      assert.equal(hit.label, labelOf(hit.voxel), `${name}: label at ${hit.voxel}`);
      assert.ok(distance(hit.voxel, hit.index) < (name === '3d' ? 4 : 0.9));
      const affine = volume.affine;
      const lps = [0, 1, 2].map((r) => affine[4 * r + 3] + [0, 1, 2].reduce((s, c) => s + affine[4 * r + c] * hit.index[c], 0));
      assert.ok(distance(lps, hit.lps) < 1e-6);
      assert.equal(lines[0], `voxel ${hit.index.map((v) => Math.round(v)).join(', ')}`);
      assert.match(lines[1], /^[LR] [\d.]+, [AP] [\d.]+, [SI] [\d.]+ mm$/);
      assert.ok(lines[2].endsWith(`label ${hit.label}`), lines[2]);
      assert.equal(lines[3], 'moved 0.00 mm');
    }
  }
  await page.move(...await page.middle('#toolbar .brand'));
  await page.until('nothing is told elsewhere', `!document.querySelector('.pointer-values')`);
});

step('tissue tells how far it has moved, its change of volume and, by finite elements, its stress', async () => {
  await page.eval(`document.getElementById('tab-deform').click()`);
  const [x, y] = await partOf('3d', [0.5, 0.5]);
  await page.eval(`(() => { for (const [name, value] of [['radius', 20], ['soft', 0]]) {
    const input = document.getElementById('setting-' + name);
    input.value = value; input.dispatchEvent(new Event('change')); } })()`);
  await view.drag([x, y], [30, 12]);
  const [handle] = (await view.get('scene')).handles;
  const way = minus(handle.lps, handle.rest_lps);
  assert.ok(length(way) > 3);
  const [hx, hy] = await page.eval(`supple.place('3d', ${JSON.stringify(handle.lps)})`);
  const {lines, hit} = await valuesAt(Math.round(hx), Math.round(hy));
  assert.ok(distance(hit.displacement, way) < 0.05, `${hit.displacement} instead of ${way}`);
  assert.ok(distance(hit.rest_lps.map((v, a) => v + way[a]), hit.lps) < 0.05);
  assert.ok(Math.abs(hit.det_f - 1) < 0.01, 'a handle keeps its volume');
  assert.equal(lines[3], `moved ${length(hit.displacement).toFixed(2)} mm from ${hit.voxel.join(', ')}`);
  assert.ok(lines[4].startsWith('det F') && !/kPa/.test(lines[4]), 'ChainMail knows of no stress');
  await keep(page, 'values.png');

  await page.key('Control+z');
  await view.until('it is taken back', '$carriedOut >= $sent && !$scene.undo.length');
  await page.eval(`(() => { const list = document.getElementById('model'); list.value = 'fem'; list.dispatchEvent(new Event('change')); })()`);
  await view.until('finite elements are chosen', '$scene.model === "fem"');
  await page.move(...await partOf('3d', [0.5, 0.3]));
  await page.key('a');
  await view.until('tissue is fixed', '$scene.anchors.length === 1');
  await view.drag([x, y], [24, 0]);
  const stressed = await valuesAt(Math.round(x + 50), Math.round(y));
  assert.ok(stressed.hit?.stress_kpa > 0 && stressed.hit.det_f > 0.5, JSON.stringify(stressed.hit));
  assert.match(stressed.lines[4], /^det F [\d.]+, [\d.e-]+ kPa$/);
});

step('finite elements follow the hand, and tell how near they are and with which force the body pulls', async () => {
  const choose = async (model) => {
    await page.eval(`(() => { const list = document.getElementById('model'); list.value = '${model}'; list.dispatchEvent(new Event('change')); })()`);
    await view.until('the model is chosen', `document.getElementById('model').value === '${model}' && $carriedOut >= $sent`);
  };
  await choose('fem/hand');
  const [x, y] = await partOf('3d', [0.5, 0.6]);
  const done = (await view.get('scene')).undo.length;
  await page.move(x, y);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (let i = 1; i <= 8; ++i) {
    await page.move(x - 4 * i, y);
    await sleep(20);
  }
  await view.until('a level is there', '$scene.lead?.level >= 0', 60);
  await view.until('all levels are there', '$scene.lead?.done', 120);
  await page.move(x - 34, y);
  await page.until('it is told', `/finite elements, solved, [\\d.e-]+ N/.test(document.getElementById('say').textContent)`);
  assert.ok((await view.get('scene.lead')).force_n > 0);
  assert.equal((await view.get('scene')).undo.length, done, 'the body waits for the release');
  await keep(page, 'under_hand.png');
  await page.key('Enter');
  await view.until('the stroke is one step', `$carriedOut >= $sent && !$scene.grab && !$scene.lead && $scene.undo.length === ${done + 1}`, 60);
  const moved = await valuesAt(x - 34, y);
  assert.ok(length(moved.hit.displacement) > 2 && moved.hit.stress_kpa > 0, JSON.stringify(moved.hit));
  await page.key('Control+z');
  await view.until('it is taken back at once', `$carriedOut >= $sent && $scene.undo.length === ${done}`);
  await choose('fem');
  await view.settled(60);
});

step('values follow the pointer', async (t) => {
  for (const name of kViews) {
    const from = await partOf(name, [0.35, 0.4]), to = await partOf(name, [0.65, 0.6]);
    const before = (await view.get('pointer')).times.length;
    for (let i = 0; i <= 60; ++i) {
      await page.move(...from.map((v, a) => v + (to[a] - v) * i / 60));
      await sleep(16);
    }
    await sleep(100);
    const times = (await view.get('pointer')).times.slice(before).sort((a, b) => a - b);
    assert.ok(times.length > 10, 'one question after the other');
    const at = (part) => times[Math.ceil(part * times.length) - 1].toFixed(1);
    t.diagnostic(`${name}: from pointer to values ${at(0.5)} ms in the median, ${at(0.95)} ms at the 95th percentile of ${times.length}, load ${loadavg()[0].toFixed(1)}`);
  }
});

const setAmount = (percent) => page.eval(`(() => { const slider = document.getElementById('amount'); slider.value = ${percent}; slider.dispatchEvent(new Event('input')); })()`);
const pictures = () => page.eval(`Promise.all(${JSON.stringify(kViews)}.map((name) => document.querySelector('#view-' + name + ' canvas').toDataURL('image/png')))`);
/// The pictures of all views once the last of them, which come after the one in space, is there.
async function settledPictures() {
  await view.settled(60);
  const n = await view.get('barrier()');
  await view.until('all slices are there', `!$decoding && ['axial', 'coronal', 'sagittal'].every((name) => $views[name].event >= ${n} && $views[name].settled)`, 30);
  return pictures();
}

step('the slider shows a part of the displacement, or more, and leaves the body alone', async () => {
  await page.move(...await page.middle('#toolbar .brand'));
  await page.key('Control+z');
  await view.until('all is taken back', '$carriedOut >= $sent && !$scene.handles.length && !$scene.settling', 30);
  await page.eval(`(() => { const list = document.getElementById('model'); list.value = 'ecm'; list.dispatchEvent(new Event('change')); })()`);
  await view.settled(60);
  await setAmount(0);
  await view.until('rest is shown', '$scene.amount === 0 && !$scene.deformed');
  await view.settled(60);
  await setAmount(100);
  await view.settled(60);
  await view.drag(await partOf('3d', [0.5, 0.5]), [30, 12]);
  const {handles: [handle], undo} = await view.get('scene');
  const way = minus(handle.lps, handle.rest_lps);
  const whole = await settledPictures();
  for (const amount of [0.5, 2, 0.25]) {
    await setAmount(100 * amount);
    await view.until('the slider is heard', `$scene.amount === ${amount}`);
    await view.settled(60);
    await keep(page, `amount_${100 * amount}.png`);
    const {handles: [shown]} = await view.get('scene');
    const part = way.map((mm) => mm * amount);
    assert.ok(distance(minus(shown.lps, handle.rest_lps), part) < 1e-3, `${amount} of the way`);
    const [x, y] = await page.eval(`supple.place('3d', ${JSON.stringify(shown.lps)})`);
    const {hit} = await valuesAt(Math.round(x), Math.round(y));
    assert.ok(distance(hit.displacement, part) < 0.05, `${hit.displacement} instead of ${part}`);
    const rest = hit.index.map((v, a) => v - hit.displacement[a] / volume.affine[5 * a]);
    assert.ok(Math.abs(hit.density - folder.densityAt(rest)) < 0.5, 'what is seen there is that tissue of the file');
    await page.move(...await page.middle('#toolbar .brand'));
  }
  await setAmount(100);
  await view.until('all of it is shown', '$scene.amount === 1');
  assert.deepEqual(await settledPictures(), whole, 'the same bytes as before');
  assert.deepEqual((await view.get('scene')).undo, undo);
  // A hand leads the body itself.
  await setAmount(50);
  await view.until('half is shown', '$scene.amount === 0.5');
  await page.move(...await partOf('3d', [0.45, 0.6]));
  await page.key('g');
  await view.until('the handle is there, and all of the displacement', '$scene.grab && $scene.amount === 1');
  await page.key('Escape');
  await view.until('it is as it was', '$carriedOut >= $sent && !$scene.grab');
});

step('a link restores the view to the byte, and leaves out what is as it was', async () => {
  await page.eval(`document.getElementById('tab-look').click()`);
  const choose = (id, value) => page.eval(`(() => { const list = document.getElementById('${id}'); list.value = '${value}'; list.dispatchEvent(new Event('change')); })()`);
  const [x, y] = await view.middle();
  await page.drag([x, y], [x + 70, y - 30], {steps: 12});
  await page.drag([x, y], [x + 15, y + 5], {steps: 4, modifiers: 8});
  await choose('preset', 'Bone');
  await choose('overlay', 'displacement');
  await page.eval(`document.getElementById('overlay-in-space').click()`);
  await page.eval(`[...document.querySelectorAll('#panel-look button')].find((b) => /^Plane/.test(b.textContent)).click()`);
  await view.until('it is clipped', '$scene.view.clips.length === 1');
  const [ax, ay] = await view.middle('axial');
  await page.wheel(ax, ay, -300);
  await page.drag([ax + 11, ay - 7], [ax + 14, ay - 9]);
  await page.drag([ax, ay], [ax + 9, ay + 4], {button: 'middle'});
  await page.wheel(ax, ay, -300, {modifiers: 2});
  await setAmount(60);
  await view.until('the slider is heard', '$scene.amount === 0.6');
  await page.move(...await page.middle('#toolbar .brand'));
  const seen = await settledPictures(), before = await view.get('scene');
  const {slices: {zoom, centre, cursor}} = before;
  assert.ok(zoom > 1.05 && centre.axial && cursor[2] !== Math.round(cursor[2]), JSON.stringify([zoom, centre, cursor]));
  await page.key('l');
  const link = await page.until('the link is in the address', `location.hash.includes('&view=') && location.href`);
  assert.ok(link.startsWith(server.address + '&view='));
  await keep(page, 'link.png');

  const others = async () => {
    await page.key('1');
    await choose('preset', 'Skin');
    await page.eval(`document.querySelector('[aria-label="Remove clip 1"]').click()`);
    await page.wheel(...await view.middle('coronal'), 400);
    await page.eval(`document.querySelector('#view-axial .fit').click()`);
    await setAmount(100);
    await view.until('it is seen otherwise', '$scene.amount === 1 && $scene.view.clips.length === 0 && $carriedOut >= $sent');
    await page.move(...await page.middle('#toolbar .brand'));
    const now = await settledPictures();
    for (const [i, name] of kViews.entries()) assert.notEqual(now[i], seen[i], `${name} has changed`);
  };
  const isRestored = async (what) => {
    await view.until('the view is there', '$scene && $carriedOut >= $sent && $scene.amount === 0.6 && $scene.view.clips.length === 1', 30);
    const restoredPictures = await settledPictures();
    const {view: restored, slices} = await view.get('scene');
    assert.deepEqual([restored, slices], [before.view, before.slices], what);
    assert.deepEqual(restoredPictures, seen, what);
  };
  await others();
  await page.close();
  page = await browser.page(link, kWindow);
  view = new View(page);
  await view.until('the page is there', 'window.supple && $scene && $views["3d"].count', 30);
  await isRestored('by another page');
  const {undo} = await view.get('scene');

  // In a page that is open: only what differs is sent.
  await page.eval(`window.dispatchEvent(new Event('hashchange'))`);
  await isRestored('once more');
  assert.deepEqual((await view.get('scene')).undo, undo);
  await page.eval(`location.hash = location.hash.slice(0, -7) + '!'`);
  await page.until('a damaged link is told of', `/cannot be read/.test(document.getElementById('say').textContent)`);
});

step('a curtain and blinking show the body at rest beside it, by one camera, and leave the session alone', async () => {
  await page.eval(`document.querySelector('[aria-label="Remove clip 1"]')?.click()`);
  await page.key('1');
  await setAmount(0);
  await view.until('rest is shown', '$scene.amount === 0');
  const atRest = await settledPictures();
  await setAmount(100);
  await view.until('all of it is shown', '$scene.amount === 1');
  const deformed = await settledPictures(), before = await view.get('scene');
  const restPictures = () => page.eval(`Promise.all(${JSON.stringify(kViews)}.map((name) => document.querySelector('#view-' + name + ' canvas.at-rest').toDataURL('image/png')))`);
  const isThere = (camera = 0, slices = 0) => view.until('pictures at rest are there',
    `Object.entries($curtain.views).every(([name, one]) => one.settled && one.event >= (name === '3d' ? ${camera} : ${slices}))`, 60);

  await page.key('c');
  await isThere();
  assert.deepEqual(await restPictures(), atRest, 'those of the body at rest, byte for byte');
  assert.deepEqual(await settledPictures(), deformed);
  await keep(page, 'curtain.png');

  // The screen shows one on the left of the line, the other on its right.
  const box = await page.box('#view-3d .picture');
  const decoded = (data) => readPng(Buffer.from(data.split(',')[1], 'base64'));
  const isSeen = async (part) => {
    const [screen, rest, now] = [readPng(await page.picture()), decoded(atRest[0]), decoded(deformed[0])];
    const same = {rest: 0, now: 0, differing: 0};
    for (let y = 60; y < box.height - 60; ++y) {
      for (let x = 60; x < box.width - 60; ++x) {
        if (Math.abs(x - part * box.width) < 12) continue;  // the line with its letters
        const at = (picture, i, j) => [0, 1, 2].map((c) => picture.pixels[(Math.round(j) * picture.width + Math.round(i)) * 3 + c]);
        const [a, b] = [at(rest, x, y), at(now, x, y)];
        if (distance(a, b) < 20) continue;
        ++same.differing;
        const seen = at(screen, box.x + x, box.y + y);
        const isRest = distance(seen, a) < distance(seen, b);
        if (x < part * box.width) same.rest += isRest;
        else same.now += !isRest;
      }
    }
    assert.ok(same.differing > 100 && same.rest + same.now > 0.9 * same.differing, JSON.stringify([part, same]));
  };
  await isSeen(0.5);
  const grip = await page.middle('#view-3d .divider');
  await page.drag(grip, [grip[0] + 0.2 * box.width, grip[1] + 9]);
  assert.ok(Math.abs((await view.get('curtain')).position - 0.7) < 0.01, 'led by the mouse, in all views');
  await isSeen(0.7);
  assert.equal(await page.eval(`document.querySelector('#view-axial .divider').style.left`), '70%');
  await page.eval(`document.querySelector('#view-3d .divider').focus()`);
  for (const [key, position] of [['ArrowLeft', 0.68], ['Home', 0], ['ArrowRight', 0.02], ['End', 1]]) {
    await page.key(key);
    assert.ok(Math.abs((await view.get('curtain')).position - position) < 0.011, key);
  }

  // What is told and measured on the side at rest is of the body at rest; hands find nothing there.
  const [x, y] = await partOf('3d', [0.5, 0.5]);
  const {hit} = await valuesAt(x, y);
  assert.ok(length(hit.displacement) === 0 && Math.abs(hit.density - folder.densityAt(hit.index)) < 0.01);
  await page.key('g');
  await page.until('hands are told', `/body at rest is shown here/.test(document.getElementById('say').textContent)`);
  assert.equal(await view.get('scene.grab'), null);

  // Blinking asks for nothing.
  await page.key('v');
  const sent = await view.get('sent'), {count} = await view.get('views["3d"]');
  const seenWhole = () => page.eval(`[...document.querySelectorAll('canvas.at-rest')].map((c) => c.hidden ? 'no' : c.style.clipPath)`);
  assert.ok((await seenWhole()).every((clip) => /^inset\(0px 0%/.test(clip)), await seenWhole());
  await keep(page, 'blink.png');
  await page.key('v');
  assert.ok((await seenWhole()).every((clip) => clip === 'no'));
  assert.deepEqual([await view.get('sent'), (await view.get('views["3d"]')).count], [sent, count]);

  // Both follow the camera and the slices.
  await page.key('c');
  await page.key('3');
  const camera = await view.get('sent');
  await page.move(...await page.middle('#toolbar .brand'));
  const turned = await settledPictures();
  await isThere(camera, await view.get('barrier()'));
  const turnedAtRest = await restPictures();
  assert.ok(turnedAtRest[0] !== atRest[0] && turnedAtRest[0] !== turned[0]);
  await page.key('Escape');
  await view.until('it is gone', '!$scene.curtain && !$curtain.mode');
  await setAmount(0);
  await view.until('rest is shown', '$scene.amount === 0');
  assert.deepEqual(await settledPictures(), turnedAtRest);
  await setAmount(100);
  await view.until('all of it is shown', '$scene.amount === 1');
  assert.deepEqual((await view.get('scene')).undo, before.undo);
});
