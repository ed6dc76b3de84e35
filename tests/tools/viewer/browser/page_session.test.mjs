// What the page does with frames, keys, transfer functions and a lost connection, without a browser.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {actionOf, kBindings, namesOf} from '../../../../tools/viewer/page/bindings.js';
import {crossings} from '../../../../tools/viewer/page/cut_marks.js';
import {eventsTo, hashOf, partsOf, slicesTo, viewOf} from '../../../../tools/viewer/page/link.js';
import {FrameGate, Latencies, parseFrame} from '../../../../tools/viewer/page/frames.js';
import {Geometry, planeInBox} from '../../../../tools/viewer/page/geometry.js';
import {degreesBetween, turnedAxes} from '../../../../tools/viewer/page/oblique.js';
import {choiceOf, keptOf} from '../../../../tools/viewer/page/remembered_looks.js';
import {Session} from '../../../../tools/viewer/page/session.js';
import {stopper} from '../../../../tools/viewer/page/stopper.js';
import * as transfers from '../../../../tools/viewer/page/transfer.js';
import {cross, distance, dot, minus} from '../../../../tools/viewer/page/vectors.js';

function frameBytes({event = 7, frame = 9, view = 1, format = 1, settled = 1, plane = [1, 2, 3, 4, 5, 6, 7, 8, 9], picture = [42]}) {
  const bytes = Buffer.alloc(24 + (view ? 72 : 0) + picture.length);
  bytes.write('SVF1');
  bytes.writeUInt32LE(event, 4);
  bytes.writeUInt32LE(frame, 8);
  bytes.set([view, format, settled], 12);
  bytes.writeUInt16LE(640, 16);
  bytes.writeUInt16LE(480, 18);
  bytes.writeFloatLE(12.5, 20);
  if (view) plane.forEach((value, i) => bytes.writeDoubleLE(value, 24 + 8 * i));
  bytes.set(picture, bytes.length - picture.length);
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
}

test('a frame is read as the protocol says', () => {
  const frame = parseFrame(frameBytes({}));
  assert.deepEqual({...frame, picture: [...frame.picture]}, {
    event: 7, frame: 9, view: 'axial', type: 'image/png', settled: true, width: 640, height: 480, isAtRest: false, serverMs: 12.5,
    plane: [1, 2, 3, 4, 5, 6, 7, 8, 9], picture: [42]});
  const space = parseFrame(frameBytes({view: 0, format: 0, settled: 0}));
  assert.deepEqual([space.view, space.type, space.settled, space.plane, space.picture[0]], ['3d', 'image/jpeg', false, null, 42]);
});

test('what is no frame is refused', () => {
  assert.equal(parseFrame(new ArrayBuffer(10)), null);
  assert.equal(parseFrame(new ArrayBuffer(200)), null);
  assert.equal(parseFrame(frameBytes({}).slice(0, 60)), null);
  assert.equal(parseFrame(frameBytes({view: 4})), null);
});

test('whatever the order of decoding, a view never goes back and ends with the newest frame', () => {
  let seed = 5;
  const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
  for (let round = 0; round < 100; ++round) {
    const gate = new FrameGate();
    const frames = Array.from({length: 30}, (_, i) => ({frame: i + 1, event: Math.floor(i / 3)}));
    for (let i = frames.length - 1; i > 0; --i) {
      const k = Math.floor(random() * (i + 1));
      [frames[i], frames[k]] = [frames[k], frames[i]];
    }
    const shown = frames.filter((frame) => gate.pass(frame));
    for (let i = 1; i < shown.length; ++i) assert.ok(shown[i].frame > shown[i - 1].frame && shown[i].event >= shown[i - 1].event);
    assert.equal(shown.at(-1).frame, 30);
    assert.equal(shown.length + gate.dropped, 30);
  }
});

test('a frame of an older event is not shown, whatever its number', () => {
  const gate = new FrameGate();
  assert.ok(gate.pass({frame: 3, event: 8}));
  assert.ok(!gate.pass({frame: 4, event: 7}));
  assert.ok(!gate.pass({frame: 3, event: 8}));
  gate.restart();
  assert.ok(gate.pass({frame: 1, event: 0}));
});

test('an event ends with the first picture that shows it or a later one', () => {
  const times = new Latencies();
  [[1, 0], [2, 10], [3, 20]].forEach(([n, at]) => times.sent(n, at));
  times.shown(2, 50);
  assert.deepEqual(times.ms, [50, 40]);
  times.shown(2, 99);
  times.shown(3, 100);
  assert.deepEqual(times.ms, [50, 40, 80]);
  assert.equal(times.percentile(0.95), 80);
  assert.equal(times.percentile(0.5), 50);
});

const key = (name, more = {}) => ({key: name, code: '', ctrlKey: false, shiftKey: false, altKey: false, metaKey: false, ...more});

test('every key has one meaning where it holds', () => {
  const seen = new Set();
  for (const {keys, where} of kBindings) {
    for (const name of keys) {
      assert.ok(!seen.has(where + name), `${name} twice in ${where}`);
      seen.add(where + name);
    }
  }
});

test('keys of the issue do what it says', () => {
  const expected = {g: 'grab', a: 'anchor', k: 'cut', m: 'measure', ' ': 'deformed', r: 'reset-view', 1: 'side-anterior',
                    3: 'side-left', 7: 'side-superior', F12: 'screenshot', h: 'help', '?': 'help'};
  for (const [name, action] of Object.entries(expected)) {
    assert.equal(actionOf(key(name, {shiftKey: name === '?'}), ['space', 'any']), action);
  }
  assert.equal(actionOf(key('z', {ctrlKey: true}), ['any']), 'undo');
  assert.equal(actionOf(key('Z', {ctrlKey: true, shiftKey: true}), ['any']), 'redo');
  assert.equal(actionOf(key('!', {shiftKey: true, code: 'Digit1'}), ['any']), 'side-posterior');
  assert.equal(actionOf(key('x'), ['grab', 'tool', 'space', 'any']), 'axis-x');
  assert.equal(actionOf(key('x'), ['space', 'any']), null);
  assert.equal(actionOf(key('ArrowUp'), ['slice', 'any']), 'slice-next');
  assert.equal(actionOf(key('ArrowUp'), ['grab', 'tool', 'slice', 'any']), 'nudge-up');
  assert.equal(actionOf(key('A', {shiftKey: true}), ['any']), 'let-go');
  // Caps lock changes the letter, not the meaning.
  assert.equal(actionOf(key('G'), ['any']), 'grab');
  assert.deepEqual(namesOf(key('c', {metaKey: true})).at(-1), 'Ctrl+c');
});

const transfer = {name: 't', opacity: [[0, 0], [100, 0.5], [200, 1]], colour: [[0, 0, 0, 0], [200, 1, 0.5, 0]], background: null};

test('curves are linear between key points and constant beyond', () => {
  assert.deepEqual(transfers.at(transfer.opacity, -5), [0]);
  assert.deepEqual(transfers.at(transfer.opacity, 150), [0.75]);
  assert.deepEqual(transfers.at(transfer.colour, 100), [0.5, 0.25, 0]);
  assert.deepEqual(transfers.at(transfer.colour, 999), [1, 0.5, 0]);
});

test('a point stays between its neighbours and its opacity between 0 and 1', () => {
  const moved = transfers.opacityMoved(transfer, 1, 500, 7);
  assert.ok(moved.opacity[1][0] < 200 && moved.opacity[1][0] > 199);
  assert.equal(moved.opacity[1][1], 1);
  assert.deepEqual(transfer.opacity[1], [100, 0.5], 'the first one is as it was');
  assert.ok(transfers.opacityMoved(transfer, 1, -500, -7).opacity[1][0] > 0);
});

test('a point put on the curve changes nothing until it is moved', () => {
  const {transfer: more, index} = transfers.inserted(transfer, 'opacity', 150);
  assert.deepEqual([index, more.opacity[2]], [2, [150, 0.75]]);
  assert.equal(transfers.inserted(transfer, 'opacity', 100).index, -1);
  assert.deepEqual(transfers.removed(more, 'opacity', 2).opacity, transfer.opacity);
  const one = {...transfer, opacity: [[1, 1]]};
  assert.deepEqual(transfers.removed(one, 'opacity', 0).opacity, [[1, 1]]);
});

test('colours and files', () => {
  assert.deepEqual(transfers.rgbOf('#ff0080'), [1, 0, 0.502]);
  assert.equal(transfers.hexOf(transfers.rgbOf('#1a2b3c')), '#1a2b3c');
  assert.deepEqual(transfers.domain(transfers.shifted(transfer, 10)), [10, 210]);
});

/// A socket whose other end is the test.
class FakeSocket {
  constructor(address, protocol) {
    Object.assign(this, {address, protocol, readyState: 0, sent: []});
    FakeSocket.all.push(this);
  }
  send(text) { this.sent.push(JSON.parse(text)); }
  open() {
    this.readyState = 1;
    this.onopen();
    this.say({hello: {session: FakeSocket.session}});
  }
  say(message) { this.onmessage({data: JSON.stringify(message)}); }
  close() {
    this.readyState = 3;
    this.onclose();
  }
  static all = [];
  static session = 'one';
}
const volume = {affine: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], dims: [4, 4, 4], spacing: [1, 1, 1]};
const sceneOf = (event, position) => ({scene: {volume, event, view: {camera: {position, target: [0, 0, 0], up: [0, 0, 1], fov: 30}}}});

test('a lost connection is tried again with longer pauses, and numbers begin anew', async (t) => {
  t.mock?.timers?.enable({apis: ['setTimeout']});
  FakeSocket.all = [];
  const session = new Session('ws://x/socket', 'secret', FakeSocket);
  assert.equal(FakeSocket.all[0].protocol, 'supple.secret');
  FakeSocket.all[0].open();
  const states = [];
  session.on('connection', (state) => states.push(state));
  assert.equal(session.event({kind: 'undo'}), 1);
  assert.equal(session.event({kind: 'undo'}), 2);
  const answer = session.ask('presets', true);
  FakeSocket.all[0].close();
  await assert.rejects(answer, /lost/);
  assert.equal(session.event({kind: 'undo'}), 0, 'nothing is sent without a connection');
  session.connection.retry();
  assert.equal(FakeSocket.all.length, 2);
  FakeSocket.all[1].open();
  assert.equal(session.event({kind: 'undo'}), 1);
  assert.deepEqual(states, ['lost', 'connected']);
  FakeSocket.session = 'two';
  FakeSocket.all[1].close();
  session.connection.retry();
  FakeSocket.all[2].open();
  assert.deepEqual([states.at(-1), session.counts.restarts], ['restarted', 1]);
  session.connection.socket.onclose = null;
});

test('answers come to those who asked, errors of others to the log', async () => {
  FakeSocket.all = [];
  const session = new Session('ws://x/socket', 't', FakeSocket);
  const [socket] = FakeSocket.all;
  socket.open();
  const first = session.ask('list', {path: ''}), second = session.ask('list', {path: '/no'});
  socket.say({re: 2, error: 'refused'});
  socket.say({re: 1, ok: {path: ''}});
  assert.deepEqual(await first, {path: ''});
  await assert.rejects(second, /refused/);
  const n = session.event({kind: 'cut'});
  socket.say({re: n, error: 'no tissue'});
  assert.deepEqual([session.log.at(-1).text, session.log.at(-1).n], ['no tissue', n]);
});

test('the own camera leads until the scene has it', () => {
  FakeSocket.all = [];
  const session = new Session('ws://x/socket', 't', FakeSocket);
  const [socket] = FakeSocket.all;
  socket.open();
  socket.say(sceneOf(0, [0, -100, 0]));
  const sent = session.turnCamera({...session.camera(), position: [0, -50, 0]});
  socket.say(sceneOf(sent - 1, [0, -100, 0]));
  assert.deepEqual(session.camera().position, [0, -50, 0], 'an older scene does not turn it back');
  assert.deepEqual(session.shownCamera().position, [0, -100, 0]);
  const frame = parseFrame(frameBytes({view: 0, event: sent, frame: 1}));
  assert.ok(!session.passes({...frame, connection: 0}), 'a frame of an earlier connection');
  assert.ok(session.passes({...frame, connection: 1}));
  assert.deepEqual(session.shownCamera().position, [0, -50, 0]);
  assert.deepEqual(socket.sent.at(-1), {ack: 1});
  socket.say(sceneOf(sent, [0, -50, 0]));
  socket.say(sceneOf(sent, [7, 7, 7]));
  assert.deepEqual(session.camera().position, [7, 7, 7], 'another page turned it');
});

test('a page waits for what it has sent, from then or from the last that came of it', () => {
  FakeSocket.all = [];
  const session = new Session('ws://x/socket', 't', FakeSocket);
  const [socket] = FakeSocket.all;
  socket.open();
  socket.say({hello: {session: 'one'}});
  socket.say(sceneOf(0, [0, -100, 0]));
  assert.equal(session.waitsMs(), 0);
  const n = session.event({kind: 'undo'});
  session.event({kind: 'undo'});
  session.waitsSince -= 5000;
  assert.ok(session.waitsMs() >= 5000);
  socket.say(sceneOf(n, [0, -100, 0]));
  assert.ok(session.waitsMs() < 5000 && session.lastSent > n);
  socket.say(sceneOf(n + 1, [0, -100, 0]));
  assert.equal(session.waitsMs(), 0);
});

test('who stops a drag is the nearest of what is held, or a cut', () => {
  const geometry = new Geometry({affine: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], dims: [9, 9, 9], spacing: [1, 1, 1]});
  const held = (x, more = {}) => ({voxel: [x, 0, 0], rest_lps: [x, 0, 0], event: more});
  const scene = {drag: {stopped_by: 'held'}, anchors: [held(9), held(6, {radius: 2})], handles: [held(0), held(-5)]};
  assert.equal(stopper({scene, geometry}, [0, 0, 0]), 'what is held, nearest anchor 2 at 6, 0, 0, stops');
  assert.equal(stopper({scene: {...scene, anchors: []}, geometry}, [0, 0, 0]), 'handle 2 at -5, 0, 0 stops');
  assert.equal(stopper({scene: {...scene, anchors: [], handles: []}, geometry}, [0, 0, 0]), 'what is held stops');
  assert.equal(stopper({scene: {...scene, drag: {stopped_by: 'cut'}}, geometry}, [0, 0, 0]), 'the sides of a cut stop');
});

test('a swept line crosses a plane where it does', () => {
  const sheet = {line: [[0, 0, 0], [4, 0, 0]], down: [0, 0, -3], up: [0, 0, 1]};
  const across = crossings(sheet, ([x]) => x - 1);
  assert.deepEqual([across.length, Math.min(...across.flat().map(([, , z]) => z)), Math.max(...across.flat().map(([, , z]) => z))], [2, -3, 1]);
  assert.ok(across.flat().every(([x, y]) => Math.abs(x - 1) < 1e-9 && y === 0));
  assert.deepEqual(crossings(sheet, ([x]) => x - 5), []);
});

test('a link keeps what is seen, digit by digit, and asks for what differs alone', () => {
  const scene = {
    volume: {dims: [9, 7, 5]}, amount: 0.6000000000000001,
    view: {camera: {projection: 'perspective', position: [0.1 + 0.2, -1e-17, 1 / 3], target: [0, 0, 0], up: [0, 0, 1], fov: 30}, preset: '',
           transfer: {name: 'Köpfe ∂', opacity: [[-1e308, 0], [4e-324, 1]]}, clips: [{box: [0, 0, 0, 1, 1, 1]}]},
    slices: {cursor: [1, 2.5, 3], window: 0.1, level: -7, zoom: 2, centre: {axial: [1 / 7, 2, 3]}, overlay: 'none', overlay_colours: [[0, 0, 0]]}};
  const {token, view, isBroken} = partsOf(hashOf('to-ken_1', viewOf(scene, 'axial')));
  assert.deepEqual([token, isBroken], ['to-ken_1', false]);
  assert.deepEqual(view, {camera: scene.view.camera, transfer: scene.view.transfer, clips: scene.view.clips, amount: scene.amount, maximised: 'axial',
                          slices: {cursor: [1, 2.5, 3], window: 0.1, level: -7, zoom: 2, centre: {axial: [1 / 7, 2, 3]}, overlay: 'none'}});
  assert.deepEqual(eventsTo(view, scene), []);
  const other = {...scene, view: {...scene.view, clips: [], camera: {...scene.view.camera, fov: 31}}, slices: {...scene.slices, centre: {coronal: [0, 0, 0]}}};
  assert.deepEqual(eventsTo(view, other), [{kind: 'clip', clip: scene.view.clips}, {kind: 'camera', camera: scene.view.camera}]);
  assert.deepEqual(slicesTo(view, other).centre, {axial: [1 / 7, 2, 3], coronal: [4, 3, 2]}, 'back in the middle');
  assert.deepEqual(partsOf('#to-ken_1'), {token: 'to-ken_1', view: null, isBroken: false});
  for (const bad of ['#t&view=', '#t&view=%%', '#t&view=YQ']) assert.deepEqual(partsOf(bad), {token: 't', view: null, isBroken: true}, bad);
});

test('a look is kept as it is where densities are HU, else as parts of their range', () => {
  const transfer = {name: 'own', opacity: [[100, 0], [300, 1]], colour: [[200, 1, 0.5, 0]], gradient_opacity: [[20, 1]], full_shading_gradient: 40};
  const choice = {transfer, window: 400, level: 200};
  assert.deepEqual(keptOf(choice, {hu: true, density: [-1000, 3000]}), choice);
  const kept = keptOf(choice, {hu: false, density: [100, 300]});
  assert.deepEqual(kept, {transfer: {name: 'own', opacity: [[0, 0], [1, 1]], colour: [[0.5, 1, 0.5, 0]], gradient_opacity: [[0.1, 1]], full_shading_gradient: 0.2},
                          window: 2, level: 0.5});
  assert.deepEqual(choiceOf(kept, {hu: false, density: [0, 1000]}).transfer.opacity, [[0, 0], [1000, 1]]);
  assert.deepEqual(choiceOf(kept, {hu: false, density: [100, 300]}), choice);
  assert.deepEqual(keptOf({preset: 'Bone'}, {hu: false, density: [1, 2]}), {preset: 'Bone'});
});

test('what a plane cuts out of a box lies in both, and goes round', () => {
  const geometry = new Geometry({affine: [2, 0, 0, 5, 0, 1, 0.5, 0, 0, 0, 3, -7, 0, 0, 0, 1], dims: [4, 5, 6], spacing: [2, 1, Math.hypot(0.5, 3)]});
  const middle = geometry.lpsOfIndex([1.5, 2, 2.5]);
  for (const [normal, count] of [[[1, 0, 0], 4], [[3, -2, 1], undefined], [[0.1, 1, 0.2], undefined]]) {
    const corners = planeInBox(geometry, middle, normal);
    assert.ok(corners.length >= 3 && corners.length <= 6 && corners.length === (count ?? corners.length));
    const turns = corners.map((c, n) => dot(cross(minus(c, middle), minus(corners[(n + 1) % corners.length], middle)), normal));
    assert.ok(turns.every((t) => t > 1e-6), `${turns}`);
    for (const corner of corners) {
      assert.ok(Math.abs(dot(minus(corner, middle), normal)) < 1e-9);
      assert.ok(geometry.indexOfLps(corner).every((v, a) => v > -0.5 - 1e-9 && v < geometry.dims[a] - 0.5 + 1e-9));
    }
  }
  assert.deepEqual(planeInBox(geometry, [1000, 0, 0], [1, 0, 0]), []);
});

test('a slice turns about the line of sight, and becomes straight where it nearly is', () => {
  const straight = {right: [1, 0, 0], down: [0, 0, -1]};
  const axes = turnedAxes(straight, [0, 0, -1], 30, straight);
  assert.ok(Math.abs(degreesBetween(axes, straight) - 30) < 1e-9);
  assert.ok(distance(axes.right, [Math.cos(Math.PI / 6), -0.5, 0]) < 1e-12 && distance(axes.down, [0, 0, -1]) < 1e-12);
  let led = straight;
  for (let n = 0; n < 359; ++n) led = turnedAxes(led, [0.6, 0, 0.8], 1, straight) ?? assert.fail('not straight yet');
  assert.ok(Math.abs(dot(led.right, led.down)) < 1e-15 && Math.abs(degreesBetween(led, straight) - 1) < 1e-6);
  assert.equal(turnedAxes(led, [0.6, 0, 0.8], 1, straight), null);
});

test('docs/viewer.md lists the keys as they are', async () => {
  const {documented} = await import('./keys_table.mjs');
  const {text, wanted} = documented();
  assert.equal(text, wanted, 'run node tests/tools/viewer/browser/keys_table.mjs --write');
});
