// README's first minutes in Chromium, with README's own command on the real head, each step until all has
// settled: once from opening to going on after a kill, then at other sizes of the window, and by the keyboard alone.

import assert from 'node:assert/strict';
import {copyFileSync, existsSync, readFileSync} from 'node:fs';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {Chromium, kChromium, sleep} from './chromium.mjs';
import {difference, partBeyond} from './png.mjs';
import {Folder, kSupple, Server, supple, View} from './supple_view.mjs';

const kRoot = fileURLToPath(new URL('../../../..', import.meta.url));
/// `supple view build/data/ct_head.nhdr --material ct-head`, as README has it.
const [, kVolume, kMore] = /`supple view (build\/data\/\S+\.nhdr) ([^`]*--material ct-head)`/.exec(readFileSync(kRoot + 'README.md', 'utf8'));
const kHead = process.env.SUPPLE_HEAD ?? kRoot + kVolume;
const missing = !kChromium ? 'no chromium' : !existsSync(kSupple) ? `no ${kSupple}` : !existsSync(kHead) ? `no ${kHead}` : false;
const kPatience = 600;  // s, of a machine that is busy
/// Voxels of the head: the tip of the nose, the cheeks, and one below the skin of the forehead.
const kNose = [127, 243, 24], kCheeks = [[159, 215, 12], [96, 212, 11]], kForehead = [128, 215, 75];

let folder, browser, server, page, view, places;
before(async () => {
  if (missing) return;
  folder = new Folder();
  browser = await Chromium.start();
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

const started = (...more) => Server.start(kHead, ...kMore.split(' '), '--folder', folder.path, '--token', folder.at('.token'), ...more);
/// The page in a window of this size, once all is seen.
async function seen(width, height) {
  server ??= await started();
  page = await browser.page(server.address, {width, height});
  view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', kPatience);
  await view.settled(kPatience);
  places = await boxes();
}
const boxes = () => page.eval(`JSON.stringify([...document.querySelectorAll('.picture')].map((e) => e.getBoundingClientRect()))`);
const said = () => page.eval(`document.getElementById('say').textContent`);
/// Where a voxel is seen in space.
const placeOf = (voxel) => page.eval(`(() => {
  const {affine} = supple.scene.volume;
  return supple.place('3d', [0, 1, 2].map((r) => ${JSON.stringify(voxel)}.reduce((sum, v, a) => sum + v * affine[4 * r + a], affine[4 * r + 3])));
})()`);

/// G over a voxel in the view in space, `pixels` to the right, Enter: what is seen moves with the hand, all the way.
async function drag(voxel, pixels) {
  const at = await placeOf(voxel);
  const rest = await view.picture();
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
  const {asked, reached, moved, stopped_by: stoppedBy} = await view.get('scene.drag');
  assert.ok(moved > 500 && Math.hypot(...reached) > 0.9 * Math.hypot(...asked),
            `${reached} mm of ${asked}, ${moved} elements, ${stoppedBy}`);
  return rest;
}
/// Until nothing is left to be done, and no view was drawn anew for anything but the body.
async function rests() {
  await view.settled(kPatience);
  assert.equal(await view.get('scene.relaxing'), 0);
  assert.equal(await boxes(), places, 'a view moved');
  assert.deepEqual(page.errors, []);
}
/// A drag that settles, and is seen.
async function dragAndSettle(voxel, pixels) {
  const rest = await drag(voxel, pixels);
  await rests();
  await isSeen(rest);
}
const isSeen = async (rest) => {
  const part = partBeyond(rest, await view.picture(), 16);
  assert.ok(part > 0.002, `only ${(100 * part).toFixed(3)} % of the picture are seen to move`);
};
async function cut() {
  const [x, y] = await placeOf(kForehead);
  await page.move(x, y);
  await page.key('k');
  await page.drag([x - 40, y], [x + 40, y], {steps: 10});
  await view.until('it is cut', '$scene.cuts.length === 1', kPatience);
  await page.until('the cut is drawn', `document.querySelector('#view-3d .marks .cut-made')`);
  await rests();
}
/// The list of the panel, as a person changes it.
async function choose(model) {
  await page.eval(`(() => { document.getElementById('tab-deform').click(); const list = document.getElementById('model');
    list.value = '${model}'; list.dispatchEvent(new Event('change')); })()`);
  await view.until('the model is chosen', `$scene.model === '${model}' && $carriedOut >= $sent`, kPatience);
}
async function undo() {
  const left = (await view.undoTexts()).length - 1;
  await page.key('Control+z');
  await page.until('it is told what was taken back', `supple.scene.undo.length === ${left} &&
    document.getElementById('say').textContent.startsWith('Taken back: ')`, kPatience);
  await rests();
}
/// What a session is: history, what is held and cut, and the camera.
const session = () => page.eval(`JSON.stringify((({undo, redo, handles, anchors, cuts, model, view}) =>
  ({undo, redo, handles, anchors, cuts, model, view}))(supple.scene))`);
const lap = (t, what, since) => t.diagnostic(`${what}: ${((Date.now() - since) / 1000).toFixed(1)} s`);

test('grab the nose, settle, cut, drag, finite elements, undo, save, kill, go on', {skip: missing, timeout: 1700000}, async (t) => {
  await seen(1280, 800);
  let since = Date.now();
  const rest = await drag(kNose, 10);
  // The camera turns all the while: it is answered, and the drag settles nevertheless.
  await page.eval('supple.latency(true)');
  const turned = Date.now();
  while (await view.get('scene.settling') && Date.now() - turned < 8000) await page.key('ArrowLeft');
  const {count, p95} = await view.get('latency(true)');
  t.diagnostic(`${count} cameras while it settled, 95 % seen within ${Math.round(p95)} ms`);
  await rests();
  assert.match(await said(), /^Kept: [\d.]+ .*elements moved/);
  lap(t, 'grabbed and settled', since);
  await page.key('r');
  await view.settled(kPatience);
  await isSeen(rest);

  since = Date.now();
  await cut();
  await choose('ecm');
  await dragAndSettle(kCheeks[0], 10);
  lap(t, 'cut, dragged and settled', since);
  since = Date.now();
  await choose('fem');
  await dragAndSettle(kCheeks[1], -10);
  const made = await view.undoTexts();
  lap(t, 'finite elements', since);

  await view.saved('state', 'head.vdb', {folder: folder.path});
  await view.saved('journal', 'head.toml');
  const [, ...drags] = readFileSync(folder.at('head.toml'), 'utf8').split('kind = "grab"');
  assert.deepEqual(drags.map((text) => [/kind = "step"[^]*fem/.test(text), /kind = "relax"/.test(text)]),
                   [[true, false], [false, true], [true, false]], 'finite elements settle what is dragged under them');
  await undo();
  const kept = await session(), picture = await view.picture();

  since = Date.now();
  await server.stop('SIGKILL');
  await page.until('the loss is told', `!document.getElementById('banner').hidden`);
  await page.key('Control+z');
  assert.doesNotMatch(await said(), /^Kept/);
  server = await started('--port', server.port);
  await page.until('it is asked whether to go on', `supple.state === 'connected' && !document.getElementById('left').hidden`, kPatience);
  await page.clickOn('#left-go-on');
  await view.until('all is there again', `$scene && $scene.undo.length === ${made.length - 1}`, kPatience);
  await rests();
  assert.equal(await session(), kept);
  assert.ok(difference(await view.picture(), picture).most === 0, 'the picture is the same');
  lap(t, 'gone on', since);
  // What was taken back before the kill is made again, to the last byte.
  await page.key('Control+Shift+z');
  await view.until('it is made again', `$scene.undo.length === ${made.length} && $carriedOut >= $sent`, kPatience);
  await rests();
  await view.saved('state', 'again.vdb', {folder: folder.path});
  assert.ok(readFileSync(folder.at('again.vdb')).equals(readFileSync(folder.at('head.vdb'))), 'the same state');
  while ((await view.undoTexts()).length > 1) await undo();
  await page.close();
});

for (const [width, height] of [[1920, 1080], [2560, 1440], [390, 844]]) {
  test(`the same at ${width} × ${height}`, {skip: missing, timeout: 900000}, async (t) => {
    const since = Date.now();
    await seen(width, height);
    await dragAndSettle(kNose, 10);
    await cut();
    await undo();
    await undo();
    assert.equal((await view.undoTexts()).length, 1, 'the anchor of the skull alone');
    await page.close();
    lap(t, 'all', since);
  });
}

test('by the keyboard alone', {skip: missing, timeout: 900000}, async () => {
  await server?.stop('SIGKILL');
  for (const end of ['nhdr', 'raw']) copyFileSync(kHead.replace(/nhdr$/, end), folder.at('ct_head.' + end));
  server = await Server.start('--folder', folder.path);
  page = await browser.page(server.address, {width: 1280, height: 800});
  view = new View(page);
  const focus = (selector) => page.eval(`document.activeElement.matches(${JSON.stringify(selector)})`);
  const keyUntil = async (key, selector) => {
    for (let tries = 0; tries < 40 && !await focus(selector); ++tries) await page.key(key);
    assert.ok(await focus(selector), `${key} leads to ${selector}`);
  };
  await view.until('the page is connected', 'window.supple && $state === "connected"');
  await page.key('Control+o');
  await page.until('the files are listed', `document.querySelector('dialog[open] [data-name="ct_head.nhdr"]')`);
  await page.until('the materials are listed', `document.querySelectorAll('#open-material input').length > 3`);
  for (let tries = 0; tries < 20 && !await page.eval(`document.querySelector('dialog[open] .at')?.dataset.name === 'ct_head.nhdr'`); ++tries) await page.key('ArrowDown');
  await page.key('Enter');
  await keyUntil('Tab', '#open-material input');
  await keyUntil('ArrowDown', '#open-material input[value=ct-head]:checked');
  await keyUntil('Tab', 'dialog[open] button[type=submit]');
  await page.key('Enter');
  await view.until('the volume is open', '$scene && $views["3d"].count', kPatience);
  await view.settled(kPatience);
  places = await boxes();
  await keyUntil('F6', '#view-3d .picture');
  await page.key('g');
  await view.until('the tissue at the cross-hair is grabbed', '$scene.grab', kPatience);
  for (const key of ['x', '4', 'Enter']) await page.key(key);
  await view.until('it is kept', '!$scene.grab && $tool === "none" && $carriedOut >= $sent', kPatience);
  await rests();
  assert.ok((await view.undoTexts()).includes('drag'));
  await page.key('Control+s');
  await page.until('the dialog is there', `document.querySelector('dialog[open] .files [data-name]')`);
  await page.key('Enter');
  await page.until('the state is saved', `!document.querySelector('dialog[open]')`, kPatience);
  assert.ok(JSON.parse(supple('info', folder.at('state.vdb'), '--json')));
  await page.key('Control+z');
  await rests();
});
