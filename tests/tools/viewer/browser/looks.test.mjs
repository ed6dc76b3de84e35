// How a body is looked at, in Chromium: looks that the browser remembers, clips by hand, oblique slices.

import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {after, before} from 'node:test';
import {Chromium} from './chromium.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, View} from './supple_view.mjs';
import {Geometry} from '../../../../tools/viewer/page/geometry.js';
import {cross, distance, dot, length, minus, normalized} from '../../../../tools/viewer/page/vectors.js';

const kWindow = {width: 1100, height: 760};
let folder, server, browser, page, view;

const step = stepsOf(() => page);

/// A program of its own on the head, and a page of it.
async function start(file = 'head.nhdr', hash = '') {
  await page?.close();
  await server?.stop();
  server = await Server.start(folder.at(file), '--material', folder.at('soft.toml'), '--folder', folder.path);
  page = await browser.page(server.address + hash, kWindow);
  view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 60);
  await view.settled(60);
}
before(async () => {
  if (missing) return;
  folder = new Folder();
  const {densities} = folder;
  // The same without HU, as MR has them.
  writeFileSync(folder.at('mr.raw'), new Uint8Array(densities.map((hu) => Math.max(0, hu + 1000) / 4).buffer));
  writeFileSync(folder.at('mr.nhdr'), readFileSync(folder.at('head.nhdr'), 'latin1').replace('head.raw', 'mr.raw'));
  browser = await Chromium.start();
  await start();
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

const choose = (id, value) => page.eval(`(() => { const list = document.getElementById('${id}'); list.value = '${value}'; list.dispatchEvent(new Event('change')); })()`);
const said = () => page.eval(`document.getElementById('say').textContent`);
const grip = (label) => `.grip[aria-label="${label}"]`;

step('a plane that is dragged cuts away what is before it, by keys and by mouse, and a link has it', async () => {
  const {volume, view: {camera}} = await view.get('scene');
  const whole = await view.picture();
  await page.move(...await view.middle());
  await page.key('p');
  await view.until('a plane is there', '$scene.view.clips.length === 1 && $carriedOut >= $sent');
  const plane = async () => (await view.get('scene')).view.clips[0].plane;
  const first = await plane();
  const forward = normalized(minus(camera.target, camera.position));
  assert.ok(dot(normalized(first.normal), forward) > 0.999, 'what lies behind it stays');
  await page.until('its grip has the focus', `document.activeElement?.getAttribute('aria-label') === 'Clip plane 1, place'`);
  await view.settled(60);
  const cut = await view.picture();
  assert.notDeepEqual(cut.pixels, whole.pixels);

  // 3 mm towards the viewer, 10 away from him.
  for (const [key, mm] of [['ArrowUp', 1], ['ArrowRight', 1], ['ArrowDown', -1], ['Shift+ArrowUp', 10]]) {
    const at = await plane();
    await page.key(key);
    await view.until('it is carried out', `$carriedOut >= $sent && $scene.view.clips[0].plane.point.join() !== '${at.point}'`);
    assert.ok(Math.abs(dot(minus((await plane()).point, at.point), normalized(at.normal)) - mm) < 2e-3, key);
  }

  // Seen from aside, its ring follows the mouse along the normal.
  await page.key('3');
  await view.settled(60);
  const at = await plane(), [x, y] = await page.middle(grip('Clip plane 1, place'));
  await page.drag([x, y], [x + 30, y + 4]);
  await view.settled(60);
  const led = await plane(), [nx] = await page.middle(grip('Clip plane 1, place'));
  assert.ok(Math.abs(nx - x - 30) < 2.5, `${nx - x} instead of 30 pixels`);
  assert.deepEqual(led.normal, at.normal);
  assert.ok(length(cross(minus(led.point, at.point), normalized(at.normal))) < 3e-3 && distance(led.point, at.point) > 3);
  await keep(page, 'clip_plane.png');

  // Its dot turns it, and is where the mouse has led it.
  const dotAt = await page.middle(grip('Clip plane 1, direction')), to = [dotAt[0] + 12, dotAt[1] - 40];
  await page.drag(dotAt, to, {steps: 12});
  await view.settled(60);
  const turned = await plane();
  const bearing = ([fx, fy], [tx, ty]) => Math.atan2(ty - fy, tx - fx) * 180 / Math.PI;
  const ring = await page.middle(grip('Clip plane 1, place'));
  assert.ok(Math.abs(bearing(ring, await page.middle(grip('Clip plane 1, direction'))) - bearing(ring, to)) < 3);
  assert.ok(Math.abs(length(turned.normal) - 1) < 1e-4 && dot(normalized(turned.normal), normalized(led.normal)) < 0.95);
  await page.eval(`document.querySelector('${grip('Clip plane 1, direction')}').focus()`);
  await page.key('ArrowLeft');
  await view.until('it is turned by a degree', `$carriedOut >= $sent && $scene.view.clips[0].plane.normal.join() !== '${turned.normal}'`);
  const angle = Math.acos(dot(normalized((await plane()).normal), normalized(turned.normal))) * 180 / Math.PI;
  assert.ok(angle > 0.2 && angle < 1.001, `${angle}°`);

  // The link, and the history.
  await page.move(...await page.middle('#toolbar .brand'));
  await view.settled(60);
  const seen = (await view.picture()).pixels, clips = (await view.get('scene')).view.clips;
  await page.key('l');
  const link = await page.until('the link is in the address', `location.hash.includes('&view=') && location.href`);
  await page.eval(`document.querySelector('${grip('Clip plane 1, place')}').focus()`);
  await page.key('Delete');
  await view.until('it is taken away', '$scene.view.clips.length === 0 && $carriedOut >= $sent');
  assert.equal(await page.eval(`document.querySelectorAll('.grip:not([hidden])[aria-label^="Clip"]').length`), 0);
  await page.go('about:blank');
  await page.go(link);
  await view.until('the plane is back', 'window.supple && $scene?.view.clips.length === 1', 30);
  await view.settled(60);
  assert.deepEqual((await view.get('scene')).view.clips, clips);
  assert.deepEqual((await view.picture()).pixels, seen);
  await page.key('Control+z');
  await view.until('undo takes the way of the link back', '$scene.view.clips.length === 0');
  await page.key('Control+Shift+z');
  await view.until('redo makes it again', '$scene.view.clips.length === 1 && $carriedOut >= $sent');
  await view.saved('scene', 'clipped.toml');
  assert.match(readFileSync(folder.at('clipped.toml'), 'latin1'), /\[\[view\.clip\]\]|clip = \[/);
  await page.eval(`document.querySelector('[aria-label="Remove clip 1"]').click()`);
  await view.until('it is taken away', '$scene.view.clips.length === 0 && $carriedOut >= $sent');
});

step('the faces of a box are led inwards by whole voxels', async () => {
  await page.move(...await view.middle());
  await page.key('Shift+P');
  await view.until('a box is there', '$scene.view.clips.length === 1 && $carriedOut >= $sent');
  const box = async () => (await view.get('scene')).view.clips[0].box;
  assert.deepEqual(await box(), [-0.5, -0.5, -0.5, 95.5, 95.5, 53.5]);
  await page.key('1');
  await view.settled(60);
  const name = 'Clip box 1, i to', [x, y] = await page.middle(grip(name));
  const way = (await page.middle(grip('Clip box 1, i from')))[0] - x;
  await page.drag([x, y], [x + 0.25 * way, y + 3]);
  await view.settled(60);
  const led = await box();
  assert.ok(Math.abs(led[3] - 71.5) <= 3 && Number.isInteger(led[3] - 0.5), `${led}`);
  assert.deepEqual(led.filter((_, n) => n !== 3), [-0.5, -0.5, -0.5, 95.5, 53.5]);
  assert.ok(Math.abs((await page.middle(grip(name)))[0] - x - 0.25 * way) < 4, 'its dot is under the mouse');
  await page.eval(`document.querySelector('${grip(name)}').focus()`);
  await page.key('Shift+ArrowDown');
  await view.until('ten voxels', `$scene.view.clips[0].box[3] === ${led[3] - 10}`);
  await keep(page, 'clip_box.png');
  await page.key('Delete');
  await view.until('it is taken away', '$scene.view.clips.length === 0');
});

step('a slice is turned by its line in another one, shows the deformed body there, and a link has it', async () => {
  await page.key('1');
  await view.settled(60);
  await view.drag(await view.middle(), [30, 12]);
  const {handles: [handle], volume} = await view.get('scene');
  const geometry = new Geometry(volume);
  const straight = await view.picture('coronal');

  // Led by the mouse about the cross-hair: the line is where the mouse is.
  const cursor = await page.eval(`supple.place('axial', ${JSON.stringify(geometry.lpsOfIndex((await view.get('slices')).cursor))})`);
  const bearing = ([x, y]) => Math.atan2(y - cursor[1], x - cursor[0]) * 180 / Math.PI;
  const from = await page.middle('#view-axial ' + grip('Turn the coronal slice'));
  const angle = 30 * Math.PI / 180, arm = [from[0] - cursor[0], from[1] - cursor[1]];
  const to = [cursor[0] + arm[0] * Math.cos(angle) - arm[1] * Math.sin(angle), cursor[1] + arm[0] * Math.sin(angle) + arm[1] * Math.cos(angle)];
  await page.drag(from, to, {steps: 10});
  await view.settled(60);
  const {turned} = await view.get('slices');
  assert.deepEqual(Object.keys(turned), ['coronal']);
  const {right, down} = turned.coronal, away = cross(right, down);
  assert.ok(Math.abs(Math.acos(away[1] * Math.sign(away[1])) * 180 / Math.PI - 30) < 1, `${away}`);
  assert.ok(Math.abs(bearing(await page.middle('#view-axial ' + grip('Turn the coronal slice'))) - bearing(to)) < 0.5);
  assert.match(await said(), /^Coronal slice: turned by (29|30)\.\d°$/);
  assert.notDeepEqual((await view.picture('coronal')).pixels, straight.pixels);

  // Its pixels, and the values under the pointer, are those of the file where the tissue was at rest.
  await page.eval(`(() => { const box = [...document.querySelectorAll('#panel-look .check')].find((e) => /^Outline of/.test(e.textContent)).querySelector('input'); if (box.checked) box.click(); })()`);
  for (const [a, name] of ['i', 'j', 'k'].entries()) {
    await page.eval(`(() => { const input = document.querySelector('[aria-label="Cross-hair: voxel ${name}"]');
      input.value = ${Math.round(geometry.indexOfLps(handle.lps)[a])}; input.dispatchEvent(new Event('change')); })()`);
  }
  await view.settled(60);
  const picture = await view.picture('coronal'), {window, level} = await view.get('slices');
  const box = await page.box('#view-coronal .picture');
  let moved = 0, seen = 0, known = 0;
  const [hx, hy] = await page.eval(`supple.place('coronal', ${JSON.stringify(handle.lps)})`);
  for (const [dx, dy] of [[1, 0], [-5, 3], [6, -4], [-3, -8], [9, 6], [0, 11]]) {
    const [x, y] = [Math.round(hx + dx), Math.round(hy + dy)];
    await page.move(x, y);
    await view.until('values are told', `$pointer.at && Math.hypot($pointer.at[0] - ${x}, $pointer.at[1] - ${y}) < 0.01`);
    const {hit} = await view.get('pointer');
    const shown = await page.eval(`supple.place('coronal', ${JSON.stringify(hit.lps)})`);
    assert.ok(Math.hypot(shown[0] - x, shown[1] - y) < 0.6, 'the place lies under the pointer');
    const through = geometry.lpsOfIndex((await view.get('slices')).cursor);
    assert.ok(Math.abs(dot(minus(hit.lps, through), away)) < 1e-3, 'and in the turned plane');
    if (!hit.displacement) continue;  // air beyond what tissue tells
    ++known;
    const rest = hit.index.map((v, a) => v - hit.displacement[a] / volume.affine[5 * a]);
    assert.ok(Math.abs(hit.density - folder.densityAt(rest)) < 0.5, `${hit.density} instead of ${folder.densityAt(rest)}`);
    const grey = Math.min(1, Math.max(0, (hit.density - level) / window + 0.5)) * 255;
    const pixel = picture.pixels[3 * (Math.floor(y - box.y) * picture.width + Math.floor(x - box.x))];
    if (Math.abs(pixel - grey) < 12) ++seen;
    moved = Math.max(moved, length(hit.displacement));
  }
  assert.ok(known >= 4 && seen >= known - 1, `${seen} of ${known} pixels have the grey of their density`);
  assert.ok(moved > 0.5, `tissue of the slice has moved by ${moved} mm`);
  await page.move(...await page.middle('#toolbar .brand'));
  await keep(page, 'oblique.png');

  // By keys; through the slices along its normal; by a link; straight again.
  await page.eval(`document.querySelector('#view-sagittal ${grip('Turn the coronal slice')}').focus()`);
  await page.key('Shift+ArrowRight');
  await view.until('it is turned by 10 degrees more', `$slices.turned.coronal.right.join() !== '${right}'`);
  const by = (await view.get('slices')).turned.coronal;
  const shift = minus(by.right, right), drop = minus(by.down, down);
  assert.ok(Math.abs(shift[0]) < 1e-9 && Math.abs(drop[0]) < 1e-9, 'about the line of sight of a sagittal slice');
  assert.ok(Math.abs(length(drop) - 2 * Math.sin(Math.PI / 36)) < 1e-6, `${length(drop)}`);
  const before = geometry.lpsOfIndex((await view.get('slices')).cursor);
  await page.wheel(...await view.middle('coronal'), 100);
  await view.until('the next slice', `$slices.cursor.join() !== '${geometry.indexOfLps(before)}'`);
  await page.move(...await page.middle('#toolbar .brand'));
  await view.settled(60);
  const {slices, view: {camera}} = await view.get('scene');
  const way = minus(geometry.lpsOfIndex(slices.cursor), before);
  assert.ok(length(cross(way, cross(by.right, by.down))) < 1e-6 && Math.abs(length(way) - Math.min(...volume.spacing)) < 1e-6);
  const kept = (await view.picture('coronal')).pixels;
  await page.key('l');
  const link = await page.until('the link is in the address', `location.hash.includes('&view=') && location.href`);
  await page.move(...await view.middle('coronal'));
  await page.key('r');
  await view.until('it is straight', '!$slices.turned.coronal && $carriedOut >= $sent');
  await page.go('about:blank');
  await page.go(link);
  await view.until('it is turned again', 'window.supple && $scene?.slices.turned?.coronal', 30);
  await page.move(...await page.middle('#toolbar .brand'));
  await view.settled(60);
  assert.deepEqual((await view.get('scene')).slices, {...slices, centre: {coronal: [47.5, 47.5, 26.5]}});
  assert.deepEqual((await view.picture('coronal')).pixels, kept);
  assert.deepEqual((await view.get('scene')).view.camera, camera);
  const [gx, gy] = await page.middle('#view-axial ' + grip('Turn the coronal slice'));
  await page.doubleClick(gx, gy);
  await view.until('a double click straightens it', '!$slices.turned.coronal');
});

step('the next CT is looked at as the last one, MR otherwise, a link otherwise; and it can be forgotten', async () => {
  const {first} = await view.get('scene');
  assert.deepEqual(first.preset, 'Skin');
  await choose('preset', 'Bone');
  await view.until('bone is shown', '$scene.view.preset === "Bone" && $carriedOut >= $sent');
  await page.key('w');
  const [x, y] = await view.middle('axial');
  await page.drag([x, y], [x + 40, y + 25]);
  await page.key('w');
  await view.settled(60);
  const {window, level} = await view.get('slices');
  assert.ok(window > first.window && level > first.level);
  assert.match(await page.eval(`document.getElementById('remembered').textContent`), /^Remembered for CT \(by its densities\): Bone; window \d+/);
  await page.key('l');
  const linked = await page.until('the link is in the address', `location.hash.split('&view=')[1]`);

  await start();
  const state = async () => {
    const {view: {preset}, slices, undo} = await view.get('scene');
    return [preset, slices.window, slices.level, undo.length];
  };
  await view.until('the look is there', '$scene.view.preset === "Bone"');
  await view.until('the window is there', `$scene.slices.window === ${window}`);
  assert.deepEqual(await state(), ['Bone', window, level, 0], 'no step of the history');
  await keep(page, 'remembered.png');
  // Another page, and this one once it is loaded again, see the session as it is.
  await choose('preset', 'Muscle');
  await view.until('another look', '$scene.view.preset === "Muscle" && $carriedOut >= $sent');
  await page.eval(`localStorage.setItem('supple.looks', JSON.stringify({CT: {preset: 'CT-Fat', window: 80, level: 40}}))`);
  await page.reload();
  await view.until('the page is there', 'window.supple && $scene && $views["3d"].count', 30);
  await view.settled(60);
  assert.deepEqual(await state(), ['Muscle', window, level, 1]);

  await start('head.nhdr', '&view=' + linked);
  await view.until('the link counts', `$scene.view.preset === "Bone" && $scene.slices.window === ${window}`);

  // Densities that are not HU: the window is a part of their range.
  await start('mr.nhdr');
  const mr = await view.get('scene');
  assert.deepEqual([mr.volume.modality, mr.view.preset], [{name: 'MR', by: 'densities'}, mr.first.preset]);
  await choose('preset', 'MR-Angio');
  await view.until('it is seen', '$scene.view.preset === "MR-Angio" && $carriedOut >= $sent');
  await start('mr.nhdr');
  await view.until('the look of MR is there', '$scene.view.preset === "MR-Angio"');

  await start();
  await view.until('that of CT is there', '$scene.view.preset === "CT-Fat" && $scene.slices.window === 80');
  await page.clickOn('#remembered button');
  await view.until('it is as the program has it', `$scene.view.preset === 'Skin' && $scene.slices.window === ${first.window}`);
  assert.match(await said(), /^Nothing is remembered for CT/);
  await start();
  assert.deepEqual(await state(), ['Skin', first.window, first.level, 0]);
  assert.ok(await page.eval(`document.getElementById('remembered').hidden`));
});
