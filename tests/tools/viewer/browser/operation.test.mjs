// An operation in Chromium: a person takes the forceps by a real mouse, grips and peels, sees it, saves
// it, and the program does it again. How long it takes from mouse to picture is told, not judged.

import assert from 'node:assert/strict';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {loadavg, tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {readPng} from './png.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Server, supple, View} from './supple_view.mjs';

/// Forceps stand before the edge of a small membrane, which the lamp shines on.
const kScene = `
[operation]
[eye]
[[body]]
kind  = "membrane"
name  = "membrane"
sheet = { middle = [0, 0, -1], radius = 2, nodes = 400 }
[[instrument]]
name     = "forceps"
kind     = "forceps"
incision = "nasal"
way      = [{ time = 0, tip = [1, 0, -9.8], opening = 20, roll = 90 }]
[[instrument]]
name     = "vitrector"
kind     = "vitrector"
incision = "nasal"
way      = [{ time = 0, tip = [3, 3, -6] }]
[[instrument]]
name     = "lamp"
kind     = "lamp"
incision = "temporal"
way      = [{ time = 0, tip = [-3.5, -1.5, -2.5], active = 1 }]
[[task]]
kind = "peel"
body = "membrane"
instrument = "forceps"
[[view]]
size = [640, 480]
`;

let folder, server, browser, page, view;
const at = (name) => join(folder, name);
const get = (expression) => view.get(expression);

const step = stepsOf(() => page);

before(async () => {
  if (missing) return;
  folder = mkdtempSync(join(tmpdir(), 'supple-operation-'));
  writeFileSync(at('small.toml'), kScene);
  server = await Server.start(at('small.toml'), '--folder', folder, '--grace', '0');
  browser = await Chromium.start();
  page = await browser.page(server.address, {width: 1100, height: 700});
  view = new View(page);
});
after(async () => {
  await browser?.stop();
  await server?.stop('SIGKILL');
  if (folder) rmSync(folder, {recursive: true, force: true});
});

const pose = (name) => page.eval(`supple.status.instruments.find((one) => one.name === ${JSON.stringify(name)})`);
const tip = async () => (await pose('forceps')).pose.tip;
const clinging = () => get('status.clinging_mm2');

/// The picture as it is drawn.
async function picture() {
  const data = await page.eval(`document.querySelector('#picture canvas').toDataURL('image/png')`);
  return readPng(Buffer.from(data.split(',')[1], 'base64'));
}
/// The part of pixels within a square about a place that differ by more than 40 of 255.
function changed(a, b, [x, y], half = 20) {
  let count = 0;
  for (let v = Math.round(y) - half; v < y + half; ++v) for (let u = Math.round(x) - half; u < x + half; ++u) {
    const p = 3 * (v * a.width + u);
    count += [0, 1, 2].some((c) => Math.abs(a.pixels[p + c] - b.pixels[p + c]) > 40);
  }
  return count / (4 * half * half);
}
/// Steps of the mouse from where it is, so many CSS pixels each.
let mouse;
async function lead(dx, dy, steps, pause = 20, more = {}) {
  for (let n = 0; n < steps; ++n) {
    mouse = [mouse[0] + dx, mouse[1] + dy];
    await page.move(...mouse, more);
    await sleep(pause);
  }
}
/// Lets two steps and a picture pass.
async function pass() {
  const {time_s: time} = await get('status');
  await view.until('time passes', `$status.time_s > ${time + 0.15}`, 60);
}

step('the page shows the operation and what is in it', async () => {
  await view.until('the first picture', 'window.supple && $status && $counts.shown > 2', 60);
  assert.deepEqual((await get('scene')).instruments.map(({name}) => name), ['forceps', 'vitrector', 'lamp']);
  assert.equal(await page.eval(`document.querySelectorAll('#instruments button').length`), 3);
  assert.equal(await get('leads'), null);
  assert.match(await page.eval(`document.getElementById('hint').textContent`), /take the forceps/);
  await keep(page, 'operation_begin.png');
});

step('the mouse takes the forceps and moves it; its picture moves with it', async () => {
  mouse = await page.middle('#picture');
  await page.click(...mouse);
  await view.until('the forceps is led', `$leads === 'forceps' && $status.instruments[0].is_led`);
  await pass();
  const before = await picture(), from = await tip(), seen = await page.eval(`supple.place(${JSON.stringify(from)})`);
  await lead(-10, 0, 10);
  await pass();
  const to = await tip(), now = await page.eval(`supple.place(${JSON.stringify(to)})`);
  assert.ok(now[0] < seen[0] - 40, `${seen} to ${now}`);
  assert.ok(Math.abs(to[2] - from[2]) < 0.02, 'parallel to the picture');
  // CSS pixels of the mouse are those of the picture.
  const scale = await page.eval(`(() => { const {clientWidth: w, clientHeight: h} = document.getElementById('picture'); return Math.min(w / 640, h / 480); })()`);
  assert.ok(Math.abs((seen[0] - now[0]) * scale - 100) < 8, 'the tip goes as far as the mouse');
  assert.ok(changed(before, await picture(), now) > 0.02, 'the tip is drawn where it is now');
  await lead(10, 0, 10);
});

step('the wheel leads the tip into the picture and out', async () => {
  await pass();
  const from = await tip();
  const depth = '$status.instruments[0].pose.tip[2]';
  await page.wheel(...mouse, 300);
  await view.until('it comes nearer', `${depth} > ${from[2] + 0.2}`, 30);
  await page.wheel(...mouse, -300);
  await view.until('it goes back', `Math.abs(${depth} - ${from[2]}) < 0.02`, 30);
});

step('the forceps closes on the membrane and peels it, and the page tells of it', async (t) => {
  const whole = await clinging();
  let isGripped = false;
  for (let n = 0; n < 12 && !isGripped; ++n) {
    const asked = await get('asked.tip[2]');
    for (let notch = 0; notch < 4; ++notch) await page.wheel(...mouse, -50);
    await view.until('it is deeper', `$asked.tip[2] < ${asked - 0.15}`, 30);
    await pass();
    await page.press(...mouse);
    await view.until('it is closed', '$status.instruments[0].pose.opening === 0', 30);
    isGripped = (await get('events')).some(({kind}) => kind === 'gripped');
    if (isGripped) break;
    await page.release(...mouse);
    await view.until('it is open', '$status.instruments[0].pose.opening === 20', 30);
  }
  assert.ok(isGripped, 'gripped');
  await keep(page, 'operation_gripped.png');
  for (let n = 0; n < 10; ++n) {
    await page.wheel(...mouse, 100, {button: 'left', buttons: 1});
    await lead(-4, 0, 3, 20, {button: 'left', buttons: 1});
  }
  await view.until('links break', `$events.some(({kind}) => kind === 'link_broken') && $status.clinging_mm2 < ${whole - 0.05}`, 30);
  await pass();
  await keep(page, 'operation_peeled.png');
  await page.release(...mouse);
  await view.until('it is let go', `$events.some(({kind}) => kind === 'released')`);
  t.diagnostic(`${(whole - await clinging()).toFixed(2)} of ${whole.toFixed(2)} mm² peeled`);
});

step('from mouse to picture', async (t) => {
  await page.eval('supple.latency(true)');
  for (let n = 0; n < 4; ++n) {
    await lead(6, 0, 12, 16);
    await lead(-6, 0, 12, 16);
  }
  await pass();
  const {count, median, p95, max, parts} = await get('latency(true)');
  assert.ok(count > 30, `${count} moves were seen`);
  const {ms} = await get('status');
  t.diagnostic(`${count} moves, seen after ${Math.round(median)} ms, 95 % within ${Math.round(p95)} ms, all within ${Math.round(max)} ms; ` +
               `step ${ms.step.median.toFixed(1)} / ${ms.step.p95.toFixed(1)} ms, picture ${ms.picture.median.toFixed(1)} / ${ms.picture.p95.toFixed(1)} ms, ` +
               `in the server ${ms.latency.median.toFixed(0)} / ${ms.latency.p95.toFixed(0)} ms; load ${loadavg()[0].toFixed(1)}`);
  t.diagnostic(Object.entries(parts).map(([part, ms]) => `${part} ${ms.median.toFixed(1)} / ${ms.p95.toFixed(1)} ms`).join(', '));
});

step('keys choose, move, roll, zoom and pause; a lamp is switched', async () => {
  await page.key('2');
  await view.until('the vitrector is led', `$leads === 'vitrector' && $status.instruments[1].is_led`);
  await page.key(' ');
  const from = (await pose('vitrector')).pose;
  for (let n = 0; n < 4; ++n) await page.key('ArrowLeft');
  for (let n = 0; n < 2; ++n) await page.key('q');
  await view.until('it is rolled', `Math.abs($status.instruments[1].pose.roll - ${from.roll + 10}) < 1e-6`, 30);
  const to = (await pose('vitrector')).pose;
  assert.ok(Math.abs(to.tip[0] - from.tip[0] + 0.2) < 0.02, `${from.tip} to ${to.tip}`);
  assert.ok(Math.abs(to.roll - from.roll - 10) < 1e-6);
  await page.key('3');
  await view.until('the lamp is led', `$leads === 'lamp'`);
  await page.key(' ');
  await view.until('the lamp is off', '$status.instruments[2].pose.active === 0');
  await page.key(' ');
  await view.until('the lamp is on', '$status.instruments[2].pose.active === 1');
  await page.key('=');
  await view.until('it is nearer', '$status.view.zoom > 1.2');
  await page.key('-');
  await page.key('p');
  await view.until('it pauses', '$status.is_paused');
  const {time_s: time} = await get('status');
  await sleep(300);
  assert.equal((await get('status')).time_s, time);
  await page.key('p');
  await view.until('it goes on', '!$status.is_paused');
  await page.key('Escape');
  await view.until('the lamp follows its track', `$leads === null && !$status.instruments[2].is_led`);
  await page.key('h');
  await page.until('all keys are listed', `document.querySelector('dialog.help[open]')`);
  await keep(page, 'operation_keys.png');
  await page.key('Escape');
});

step('the retina is touched, and everybody is told', async () => {
  await page.key('1');
  await page.key('Enter');
  await view.until('the forceps is led', `$leads === 'forceps'`);
  const isAlarmed = () => page.eval(`!document.getElementById('alarm').hidden`);
  await page.until('earlier alarms are over', `document.getElementById('alarm').hidden`, 30);
  for (let n = 0; n < 60 && !await isAlarmed(); ++n) {
    await page.wheel(...mouse, -100);
    await sleep(100);
  }
  assert.ok(await isAlarmed(), 'the alarm is shown');
  assert.match(await page.eval(`document.getElementById('alarm').textContent`), /retina/);
  await keep(page, 'operation_touch.png');
  const count = async (kind) => (await get('events')).filter((one) => one.kind === kind && one.at === 'retina').length;
  const touches = await count('touch'), ends = await count('touch_ended'), {time_s: time} = await get('status');
  await view.until('the touch lasts', `$status.time_s > ${time} + 1`, 60);
  assert.deepEqual([await count('touch'), await count('touch_ended'), await isAlarmed()], [touches, ends, true], 'told of once');
  for (let n = 0; n < 10; ++n) await page.wheel(...mouse, 200);
  await view.until('it is told that it is over', `$events.filter(({kind, at}) => kind === 'touch_ended' && at === 'retina').length > ${ends}`, 30);
  await page.until('the alarm is over', `document.getElementById('alarm').hidden`, 30);
});

step('the model of a membrane is exchanged by a key and by its list', async () => {
  const list = `document.querySelector('#models select')`;
  assert.equal(await page.eval(`${list}.value`), 'springs');
  await page.key('m');
  await view.until('ChainMail moves it', `$status.membranes[0].model === 'ecm'`);
  await page.until('the list says so', `${list}.value === 'ecm'`);
  await keep(page, 'operation_models.png');
  await page.eval(`(${list}.value = 'springs', ${list}.dispatchEvent(new Event('change')))`);
  await view.until('springs move it', `$status.membranes[0].model === 'springs'`);
});

step('pairs for two eyes', async () => {
  await page.key('v');
  await page.until('side by side', `document.querySelector('#picture canvas').width === 1280`);
  await keep(page, 'operation_stereo.png');
  await page.key('v');
  await page.until('red and cyan', `document.querySelector('#picture canvas').width === 640`);
  await page.key('v');
  await view.until('one picture', `$status.view.stereo === 'none'`);
});

step('a session is saved, and the program does it again to the same bits', async () => {
  await page.key('p');
  await view.until('it pauses', '$status.is_paused');
  await page.key('Control+s');
  await page.until('the dialog is there', `document.querySelector('dialog[open] #save-name')`);
  await page.eval(`document.getElementById('save-name').value = 'own.toml'`);
  await page.clickOn('dialog[open] button[type=submit]');
  await page.until('it is saved', `!document.querySelector('dialog[open]')`, 30);
  const status = await get('status');
  const report = JSON.parse(supple('run', at('own.toml'), '-o', at('out'), '--json'));
  const text = JSON.stringify(report);
  assert.ok(text.includes(String(Math.round(status.time_s / 0.02))), 'as many steps');
  assert.ok(text.includes(await get('status.digest')), 'the same end');
});

step('a page that is closed and opened again finds all as it was', async () => {
  const before = await get('status');
  await page.close();
  page = await browser.page(server.address, {width: 1100, height: 700});
  view = new View(page);
  await view.until('the picture is there', 'window.supple && $status && $counts.shown > 0', 30);
  assert.equal((await get('status')).digest, before.digest);
  await page.key('Shift+R');
  await view.until('it begins again', '$status.time_s < 0.5');
});
