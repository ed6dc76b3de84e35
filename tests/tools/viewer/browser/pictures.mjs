// Pictures of the viewer for docs/viewer.md and to be looked at:
//
//   node tests/tools/viewer/browser/pictures.mjs FOLDER VOLUME [options of supple view]
//
// What docs/viewer.md shows, by the keys and mouse that it describes; with SUPPLE_SIZES=1 also the page
// as it opens, its list of keys, and windows of several sizes, dark and light, to be looked at.

import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {Chromium, sleep} from './chromium.mjs';
import {Server, View} from './supple_view.mjs';

const [folder, ...options] = process.argv.slice(2);
const server = await Server.start(...options);
const browser = await Chromium.start();
try {
  const page = await browser.page(server.address, {width: 1280, height: 800});
  const view = new View(page);
  const keep = async (name) => {
    await view.settled(120);
    await sleep(400);
    writeFileSync(join(folder, name), await page.picture());
  };
  await view.until('the volume is open', 'window.supple && $scene && $views["3d"].count', 120);
  if (process.env.SUPPLE_SIZES) await keep('size_open.png');
  await dragged(page, view);
  await keep('viewer_drag.png');
  await page.key('Enter');
  await page.eval(`(() => { const list = document.getElementById('overlay'); list.value = 'displacement'; list.dispatchEvent(new Event('change')); })()`);
  await page.eval(`document.getElementById('tab-look').click()`);
  await keep('viewer_overlay.png');
  await lookedAt(page, view, keep);
  if (process.env.SUPPLE_SIZES) await sizes(page, view, keep);
} finally {
  await browser.stop();
  await server.stop();
}

/// The nose led to the patient's left, still held.
async function dragged(page, view) {
  await page.eval(`document.getElementById('tab-deform').click()`);
  const {x, y, width, height} = await page.box('#view-3d .picture');
  const at = (process.env.SUPPLE_GRAB ?? '0.5,0.6').split(',').map(Number);
  const [px, py] = [x + width * at[0], y + height * at[1]];
  await page.move(px, py);
  await page.key('g');
  await view.until('the handle is there', '$scene.grab', 30);
  for (let i = 1; i <= 10; ++i) {
    await page.move(px + 3 * i, py + i);
    await sleep(60);
  }
}

/// A plane before the view from the left, and a coronal slice turned by 30 degrees.
async function lookedAt(page, view, keep) {
  const choose = (id, value) => page.eval(`(() => { const list = document.getElementById('${id}'); list.value = '${value}'; list.dispatchEvent(new Event('change')); })()`);
  const focus = (label) => page.eval(`document.querySelector('.grip[aria-label="${label}"]:not([hidden])').focus()`);
  await choose('overlay', 'none');
  await page.move(...await view.middle());
  for (const key of ['3', 'p', '1', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowLeft']) {
    if (key.length > 1) await page.eval(`document.querySelector('#view-3d .picture').focus()`);
    await page.key(key);
    await view.settled(120);
  }
  await keep('viewer_clip.png');
  await focus('Clip plane 1, place');
  await page.key('Delete');
  await page.move(...await page.middle('#toolbar .brand'));
  await focus('Turn the coronal slice');
  for (let n = 0; n < 3; ++n) await page.key('Shift+ArrowRight');
  await keep('viewer_oblique.png');
}

async function sizes(page, view, keep) {
  await page.key('h');
  await sleep(300);
  writeFileSync(join(folder, 'size_keys.png'), await page.picture());
  await page.key('Escape');
  for (const [width, height, scale, light] of [[1280, 800, 1, true], [2560, 1440, 1, false], [390, 844, 2, false], [640, 400, 2, false]]) {
    await page.resize(width, height, scale);
    await page.colours(light ? 'light' : 'dark');
    if (width < 700) await page.reload();
    await view.until('it is connected', 'window.supple && $scene && $views["3d"].count', 30);
    await sleep(200);
    await keep(`size_${width}x${height}.png`);
  }
}
