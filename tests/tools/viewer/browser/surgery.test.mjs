// Surgery by hand in Chromium: a bone is grabbed, moved and turned by mouse, keys and numbers, and every place
// on it is where a rigid motion takes it.

import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, supple, View} from './supple_view.mjs';
import {add, distance, minus, times, turned} from '../../../../tools/viewer/page/vectors.js';

const kChin = [50, 77, 2], kSkull = [24, 48, 14];
let folder, server, browser, page, view, volume, middle;

const step = stepsOf(() => page);
const lpsOf = (index) => [0, 1, 2].map((r) => volume.affine[4 * r + 3] + [0, 1, 2].reduce((s, c) => s + volume.affine[4 * r + c] * index[c], 0));

before(async () => {
  if (missing) return;
  folder = new Folder();
  writeFileSync(folder.at('scene.toml'), `[volume]
path = "head.nhdr"
[material]
preset = "soft-tissue"
shear = 1.0
[[step]]
rigid = [{ name = "jaw", grab_box = [24, 48, 0, 68, 80, 4], grab_density = [300, 4000] },
         { name = "skull", grab_box = [0, 0, 5, 95, 95, 53], grab_density = [300, 4000] }]
fix = [[${kSkull}]]
`);
  server = await Server.start(folder.at('scene.toml'), '--folder', folder.path, '--preset', 'Bone');
  browser = await Chromium.start();
  page = await browser.page(server.address, {width: 1100, height: 760});
  view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 60);
  volume = await view.get('scene.volume');
  middle = lpsOf(middleOfJaw());
  await page.eval(`document.getElementById('tab-deform').click()`);
  await page.key('1');
  await view.settled(60);
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  folder?.remove();
});

function middleOfJaw() {
  const {densities} = folder;
  let sum = [0, 0, 0], count = 0;
  for (let k = 0; k <= 4; ++k) for (let j = 48; j <= 80; ++j) for (let i = 24; i <= 68; ++i) {
    if (densities[i + 96 * (j + 96 * k)] < 300) continue;
    sum = add(sum, [i, j, k]);
    ++count;
  }
  return times(sum, 1 / count);
}
const placeOf = async (lps) => (await page.eval(`supple.place('3d', ${JSON.stringify(lps)})`)).map(Math.round);
const say = () => page.eval(`document.getElementById('say').textContent`);
const isDone = () => view.until('all is carried out', '$carriedOut >= $sent', 30);

/// The place that was grabbed, a voxel of bone, is where that motion of all of it leads.
async function isRigid(shift, axis, degrees) {
  const {rest_lps: rest, lps: now} = (await view.get('scene')).handles.at(-1);
  const asked = add(add(middle, turned(minus(rest, middle), axis, degrees)), shift);
  assert.ok(distance(now, asked) < 0.002 && distance(now, rest) > 4, `${now} instead of ${asked}`);
}

step('G over bone takes the whole piece; it moves by mouse and number, with mm beside the pointer', async () => {
  await page.eval(`(() => { const input = document.getElementById('setting-joint'); input.value = 15; input.dispatchEvent(new Event('change')); })()`);
  const [x, y] = await placeOf(lpsOf(kChin));
  await page.move(x, y);
  await page.key('g');
  await view.until('the bone is in hand', '$scene.grab?.event.rigid_at');
  assert.match(await say(), /^Bone jaw: .*R turns/);
  await page.move(x + 12, y + 20);
  await isDone();
  await page.until('the way is told', `/mm/.test(document.querySelector('.hand-text')?.textContent)`);
  for (const key of ['z', '-', '2']) await page.key(key);
  await isDone();
  await view.until('two mm to the feet', '$scene.drag && Math.abs($scene.drag.reached[2] + 2) < 1e-3');
});

step('R turns it by the pointer about the line of sight, and G goes on moving', async () => {
  await page.key('r');
  assert.match(await say(), /G moves/);
  const [mx, my] = await page.eval(`supple.place('3d', ${JSON.stringify(add(middle, [0, 0, -2]))})`);
  const swept = 12, radius = 50;
  const at = (degrees) => [mx + radius * Math.cos(degrees * Math.PI / 180), my + radius * Math.sin(degrees * Math.PI / 180)];
  await page.move(...at(80));
  await isDone();
  const {turn: first} = (await view.get('scene')).drag;
  for (let i = 1; i <= 6; ++i) {
    await page.move(...at(80 + swept * i / 6));
    await sleep(20);
  }
  await isDone();
  const {turn} = (await view.get('scene')).drag;
  assert.ok(Math.abs(Math.abs(turn.asked - (first?.asked ?? 0)) - swept) < 0.5 || Math.abs(turn.asked + (first?.asked ?? 0) - swept) < 0.5, JSON.stringify([first, turn]));
  await page.until('degrees stand beside the pointer', `[...document.querySelectorAll('.hand-text')].some((t) => /°/.test(t.textContent))`);
  await keep(page, 'turn.png');
  await page.key('g');
  assert.match(await say(), /R turns/);
  await page.key('Escape');
  await isDone();
  await view.until('it is restored', '!$scene.grab && $scene.undo.length === 1');
});

step('a number is degrees about a patient axis; all places of the bone follow, in one stroke', async () => {
  const [x, y] = await placeOf(lpsOf(kChin));
  await page.move(x, y);
  for (const key of ['g', 'z', '-', '2', 'r', 'x', '4']) {
    await page.key(key);
    if (key === 'g') await view.until('the bone is in hand', '$scene.grab?.event.rigid_at');
  }
  await isDone();
  const {drag} = await view.get('scene');
  assert.deepEqual([drag.asked[2], drag.turn.asked], [-2, 4]);
  assert.ok(drag.stopped_by === null && Math.abs(drag.turn.reached - 4) < 1e-3, JSON.stringify(drag));
  await page.key('Enter');
  await view.until('it is kept', '$carriedOut >= $sent && !$scene.grab', 30);
  await isRigid([0, 0, -2], [1, 0, 0], 4);
  await keep(page, 'turned.png');
  const {undo, handles} = await view.get('scene');
  assert.equal(undo.length, 2);
  assert.match(undo[1].text, /^drag 2\.0 mm, turn 4\.0° at /);
  assert.deepEqual(handles.at(-1).event.rigid_at.length, 3);
});

step('journal and scene of it lead to the same state, and one undo takes it back', async () => {
  await view.saved('journal', 'hand.toml');
  await view.saved('scene', 'batch.toml');
  await view.saved('state', 'hand.vdb');
  assert.match(readFileSync(folder.at('hand.toml'), 'utf8'), /joint = 15/);
  for (const name of ['hand.toml', 'batch.toml']) supple('replay', folder.at(name), '--check', folder.at('hand.vdb'));
  await page.move(...await page.middle('#toolbar .brand'));
  await page.key('Control+z');
  await view.until('it is taken back', '$carriedOut >= $sent && $scene.undo.length === 1');
  await page.key('Control+Shift+Z');
  await view.until('it is made again', '$carriedOut >= $sent && $scene.undo.length === 2', 30);
  await isRigid([0, 0, -2], [1, 0, 0], 4);
});

step('a click takes a bone, and rings about its middle turn it by the mouse about the patient\'s axes', async () => {
  await page.move(...await page.middle('#toolbar .brand'));
  await page.key('Control+z');
  await view.until('the turn is taken back', '$carriedOut >= $sent && $scene.undo.length === 1');
  await page.clickOn('#tools [data-tool=grab]');
  const chin = await placeOf(lpsOf(kChin));
  await page.click(...chin);
  await view.until('the bone is in hand', '$scene.grab?.event.rigid_at');
  await page.until('there are rings', `document.querySelectorAll('#view-3d .ring').length === 3`);
  assert.match(await say(), /^Bone jaw: .*Rings turn/);
  // The pointer may go where it likes.
  await page.move(chin[0] + 60, chin[1] - 80);
  await isDone();
  assert.ok(!(await view.get('scene')).drag?.turn && (await view.get('scene')).grab.reached.every((mm) => mm === 0));

  // From the front the ring about anterior and posterior is a circle, and its place follows the mouse; keys choose rings, too.
  const [mx, my] = await page.eval(`supple.place('3d', ${JSON.stringify(middle)})`), radius = 64;
  const at = (degrees) => [mx + radius * Math.cos(degrees * Math.PI / 180), my + radius * Math.sin(degrees * Math.PI / 180)];
  const turn = async () => (await view.get('scene')).drag.turn;
  await page.drag(at(-45), at(-40), {steps: 6});
  await isDone();
  const swept = await turn();
  assert.ok(Math.abs(swept.asked - 5) < 0.3, `${swept.asked} instead of 5°`);
  await page.until('degrees stand beside the pointer', `[...document.querySelectorAll('.hand-text')].some((t) => /°/.test(t.textContent))`);
  await keep(page, 'rings.png');
  await page.key('x');
  await page.key('3');
  await isDone();
  const half = (degrees) => Math.cos(degrees * Math.PI / 360), both = 2 * Math.acos(half(swept.asked) * half(3)) * 180 / Math.PI;
  assert.ok(Math.abs((await turn()).asked - both) < 0.01, `${(await turn()).asked} instead of ${both}°`);
  await page.key('Escape');
  await view.until('it is restored', '$carriedOut >= $sent && !$scene.grab && $scene.undo.length === 1');

  // The dot moves it. The ring about left and right is seen from its edge: what is in front goes down.
  await page.click(...chin);
  await page.until('there are rings', `document.querySelectorAll('#view-3d .ring').length === 3`);
  await page.drag([mx, my], [mx, my + 7], {steps: 4});
  await isDone();
  const {asked: down} = (await view.get('scene')).drag;
  assert.ok(down[2] < -1.5 && Math.abs(down[0]) < 0.01, `the dot moves it: ${down}`);
  const [nx, ny] = await page.eval(`supple.place('3d', ${JSON.stringify(add(middle, down))})`);
  await page.drag([nx, ny + 30], [nx, ny + 34], {steps: 4});
  await isDone();
  const led = await turn();
  assert.ok(led.asked > 3 && led.asked < 5 && Math.abs(led.reached - led.asked) < 1e-3, JSON.stringify(led));
  await page.click(nx + 90, ny - 90);
  await view.until('a click beside the rings keeps it', '$carriedOut >= $sent && !$scene.grab && $scene.undo.length === 2', 30);
  assert.equal(await page.eval(`document.querySelectorAll('#view-3d .ring').length`), 0);
  await isRigid(down, [1, 0, 0], led.asked);
  await page.key('Escape');
});

step('a bone that an anchor holds does not come along, and tissue does not turn', async () => {
  const [x, y] = await placeOf(lpsOf([48, 60, 30]));
  await page.move(x, y);
  await page.key('g');
  await sleep(300);
  assert.ok(!(await view.get('scene')).grab?.event.rigid_at);
  if ((await view.get('scene')).grab) {
    await page.key('r');
    assert.match(await say(), /Only bones turn/);
    await page.key('Escape');
  }
  await isDone();
});

step('finite elements under the hand follow a turn of the bone, too', async () => {
  await page.key('Control+z');
  await view.until('the stroke is taken back', '$carriedOut >= $sent && $scene.undo.length === 1');
  await page.eval(`(() => {
    const joint = document.getElementById('setting-joint'), model = document.getElementById('model');
    joint.value = 0;
    joint.dispatchEvent(new Event('change'));
    model.value = 'fem/hand';
    model.dispatchEvent(new Event('change'));
  })()`);
  await view.until('the model is chosen', '$scene.under_hand && $carriedOut >= $sent');
  await page.move(...await placeOf(lpsOf(kChin)));
  await page.key('g');
  await view.until('the bone is in hand', '$scene.grab?.event.rigid_at');
  for (const key of ['z', '-', '2', 'r', 'x', '4']) await page.key(key);
  await isDone();
  await view.until('its turn is solved', '$scene.lead?.done', 100);
  await page.until('it is told', `/finite elements, solved, [\\d.e-]+ N/.test(document.getElementById('say').textContent)`);
  assert.equal((await view.get('scene')).drag.turn.asked, 4);
  await keep(page, 'turn_under_hand.png');
  await page.key('Enter');
  await view.until('the stroke is one step', '$carriedOut >= $sent && !$scene.grab && !$scene.lead && $scene.undo.length === 2', 60);
  await isRigid([0, 0, -2], [1, 0, 0], 4);
});
