// Time from a mouse event to the picture on the page, measured in the page, and whether any view ever
// went back:
//
//   node tests/tools/viewer/browser/latency.mjs VOLUME|STATE|SCENE [options of supple view]
//
// Rotates and drags in a square view in space of each of SUPPLE_PIXELS pixels ("512,1024"), then at the first of them
// beside each of SUPPLE_CUTS cuts (1) of 80 pixels above the handle, and, where something is held from the beginning, as
// the skull is under --material ct-head, at each size once more with everything let go of. SUPPLE_EVENTS mouse moves of each kind (300),
// SUPPLE_GRAB "x,y", where to grab in parts of the view (by default the first place below its middle from where tissue follows the hand
// all the way), and SUPPLE_WAY pixels, the radius of
// the circle along which it is dragged at the first size (20), in larger ones as many mm. The other views are hidden but
// with SUPPLE_FOUR=1. One line of JSON for each kind, and at the end a table; of SUPPLE_SERIES series (1) it has the best
// one of each kind, by the 95th percentile.

import {loadavg} from 'node:os';
import {Chromium, sleep} from './chromium.mjs';
import {Server, View} from './supple_view.mjs';

const events = Number(process.env.SUPPLE_EVENTS ?? 300), way = Number(process.env.SUPPLE_WAY ?? 20);
const sizes = (process.env.SUPPLE_PIXELS ?? '512,1024').split(',').map(Number);
const cuts = Number(process.env.SUPPLE_CUTS ?? 1);
let place = process.env.SUPPLE_GRAB?.split(',').map(Number);
const all = new Map();  // reports of each kind and size

const server = await Server.start(...process.argv.slice(2));
const browser = await Chromium.start();
try {
  const page = await browser.page(server.address, {width: 1400, height: 900});
  const view = new View(page);
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 120);
  if (!process.env.SUPPLE_FOUR) await page.doubleClick(...await view.middle());
  await fitted(page, view, sizes[0]);
  place ??= await freePlace(page, view);
  for (let n = Number(process.env.SUPPLE_SERIES ?? 1); n > 0; --n) await series(page, view);
  console.log(table());
} finally {
  await browser.stop();
  await server.stop();
}

async function series(page, view) {
  for (const pixels of sizes) {
    await fitted(page, view, pixels);
    await rotate(page, view);
    await drag(page, view, 'drag');
    await undo(page, view);
  }
  if (cuts > 0) await fitted(page, view, sizes[0]);
  for (let n = 1; n <= cuts; ++n) {
    const [x, y] = await at(page, 0, -0.3 - 0.04 * n);
    await page.move(x, y);
    await page.key('k');
    await page.drag([x - 40, y], [x + 40, y], {steps: 10});
    await view.until('it is cut', `$scene.cuts.length === ${n}`, 60);
    await view.settled(300);
    await drag(page, view, n > 1 ? `drag beside ${n} cuts` : 'drag beside a cut');
    await undo(page, view);
  }
  for (let n = 0; n < cuts; ++n) await undo(page, view);
  if ((await view.get('scene.anchors')).length === 0) return;
  await page.key('Shift+A');
  await view.until('nothing is held', '$scene.anchors.length === 0', 60);
  for (const pixels of sizes) {
    await fitted(page, view, pixels);
    await drag(page, view, 'drag, nothing held', 'Escape');
  }
  await undo(page, view);
}

async function freePlace(page, view) {
  for (let down = 0.5; down < 0.9; down += 0.02) {
    place = [0.5, down];
    const [x, y] = await at(page);
    await page.move(x, y);
    await page.key('g');
    const isGrabbed = await view.until('there is tissue to grab', '$scene.grab', 2).catch(() => false);
    if (!isGrabbed) continue;
    await page.move(x + way, y);
    await page.move(x + way, y + way);
    await view.until('it has followed', '$carriedOut >= $sent', 60);
    const {stopped_by: stop} = await view.get('scene.drag');
    await page.key('Escape');
    await view.settled(300);
    if (stop === null) return place;
  }
  throw new Error('no tissue follows the hand: say where, SUPPLE_GRAB');
}

async function undo(page, view) {
  await page.key('Control+z');
  await view.settled(300);
}

/// Parts of the view in space from where it is grabbed, as a place on the page.
async function at(page, across = 0, down = 0) {
  const box = await page.box('#view-3d .picture');
  return [box.x + box.width * (place[0] + across), box.y + box.height * (place[1] + down)];
}
async function circle(page, [x, y], radius, more) {
  for (let i = 1; i <= events; ++i) {
    const angle = i / 40 * 2 * Math.PI;
    await page.move(x + radius * Math.sin(angle), y + radius * (1 - Math.cos(angle)), more);
    await sleep(16);
  }
}
async function pictures(view) { return (await view.get('views'))['3d'].count; }

async function rotate(page, view) {
  await view.settled(60);
  const from = await at(page);
  await page.move(...from);
  await page.eval('supple.latency(true)');
  await page.press(...from);
  const since = Date.now(), first = await pictures(view);
  await circle(page, from, 60, {button: 'left', buttons: 1});
  await report(view, 'rotate', first, since);
  await page.release(...from);
  await page.key('1');
  await view.settled(60);
}

/// Until it is kept by Enter, and settles, or goes back by Escape.
async function drag(page, view, kind, end = 'Enter') {
  const from = await at(page);
  await page.move(...from);
  await page.key('g');
  await view.until('there is tissue to grab', '$scene.grab', 60);
  await page.eval('supple.latency(true)');
  const since = Date.now(), first = await pictures(view);
  await circle(page, from, way * (await page.box('#view-3d .picture')).width / sizes[0]);
  await report(view, kind, first, since);
  const released = Date.now();
  await page.key(end);
  await view.settled(300);
  if (end === 'Enter') console.log(JSON.stringify({kind: 'settled after release', ms: Date.now() - released,
                              relaxed: await view.get('scene.relaxes'), moved: await view.get('scene.moved')}));
}

/// A window in which the view in space has the wanted pixels.
async function fitted(page, view, pixels) {
  for (let tries = 0; tries < 3; ++tries) {
    const {width, height} = await page.box('#view-3d .picture');
    const [w, h] = await page.eval('[innerWidth, innerHeight]');
    const scale = process.env.SUPPLE_FOUR ? 2 : 1;
    await page.resize(Math.round(w + scale * (pixels - width)), Math.round(h + scale * (pixels - height)));
    await sleep(200);
  }
  await view.until('the size is taken', `$views["3d"].width === ${pixels} && $views["3d"].height === ${pixels}`, 30);
}

async function report(view, kind, first, since) {
  await view.until('the last picture', '$views["3d"].event >= $sent', 30);
  const seconds = (Date.now() - since) / 1000;
  const {count, median, p95, max} = await view.get('latency(true)');
  const views = await view.get('views');
  const round = (ms) => Math.round(ms * 10) / 10;
  const told = {kind, events: count, median_ms: round(median), p95_ms: round(p95), max_ms: round(max),
    pictures_per_s: round((views['3d'].count - first) / seconds), stale_shown: Object.values(views).reduce((sum, v) => sum + v.wentBack, 0),
    size: [views["3d"].width, views["3d"].height], elements: kind === 'rotate' ? 0 : await view.get('scene.drag.moved'), load: round(loadavg()[0])};
  console.log(JSON.stringify(told));
  const key = `${kind} ${told.size}`;
  all.set(key, [...all.get(key) ?? [], told]);
}

function table() {
  const rows = [...all.values()].map((series) => {
    const best = series.reduce((a, b) => b.p95_ms < a.p95_ms ? b : a), whole = Math.round;
    return `| ${best.kind} | ${best.size[0]}² | ${best.elements ? best.elements.toLocaleString('en') : ''} | ${whole(best.median_ms)} ms | ${whole(best.p95_ms)} ms | ${whole(best.max_ms)} ms | ${whole(best.pictures_per_s)} | ${best.load} |`;
  });
  return ['| what | picture | elements, at most | median | 95th percentile | longest | pictures/s | load |', '|---|---|---|---|---|---|---|---|', ...rows].join('\n');
}
