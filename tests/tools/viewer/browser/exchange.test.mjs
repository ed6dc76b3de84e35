// What goes into the page and out of it, in Chromium: measures that follow tissue and become a table.

import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {after, before} from 'node:test';
import {Chromium, sleep} from './chromium.mjs';
import {keep, missing, stepsOf} from './steps.mjs';
import {Folder, Server, supple, View} from './supple_view.mjs';
import {distance, minus} from '../../../../tools/viewer/page/vectors.js';
import {valueOf} from '../../../../tools/viewer/page/measures.js';

const kWindow = {width: 1100, height: 760};
let folder, server, browser, page, view;

const step = stepsOf(() => page);

before(async () => {
  if (missing) return;
  folder = new Folder();
  server = await Server.start(folder.at('head.nhdr'), '--material', folder.at('soft.toml'), '--folder', folder.path);
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

async function drag([x, y], [dx, dy]) {
  await page.move(x, y);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab');
  for (let i = 1; i <= 6; ++i) {
    await page.move(x + dx * i / 6, y + dy * i / 6);
    await sleep(20);
  }
  await page.key('Enter');
  await view.until('the drag is carried out', '$carriedOut >= $sent && !$scene.grab', 30);
  await view.settled(60);
}

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

  await drag([x, y], [34, 20]);
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

  // As a table, and by a replay of the journal.
  await view.saved('measures', 'measures.csv');
  await view.saved('journal', 'measured.toml');
  supple('replay', folder.at('measured.toml'), '--measures', folder.at('replayed.csv'), '--quiet');
  const table = readFileSync(folder.at('measures.csv'), 'utf8');
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
