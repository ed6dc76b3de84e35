// Hands, keys and session of the page of an operation, without a browser. Laws are checked on random cases.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import {until} from './chromium.mjs';
import {pixelOf} from '../../../../tools/viewer/page/camera.js';
import {Hand, deeper, shifted} from '../../../../tools/viewer/page/operation/hand.js';
import {bindingOf, kOperationKeys} from '../../../../tools/viewer/page/operation/operation_keys.js';
import {OperationSession} from '../../../../tools/viewer/page/operation/operation_session.js';
import {Trips} from '../../../../tools/viewer/page/operation/trips.js';
import {cross, distance, minus} from '../../../../tools/viewer/page/vectors.js';

/// Numbers in [0, 1) that are the same in every run (Park and Miller 1988).
let seed = 20;
const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
const vector = (size = 1) => [0, 1, 2].map(() => (2 * random() - 1) * size);
const near = (a, b, tolerance) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

const kSize = [800, 600];
function microscope() {
  const target = vector(10);
  return {target, position: [target[0] + 20 * random(), target[1] + 20 * random(), target[2] + 200], up: [0, 1, 0], fov: 1 + 4 * random()};
}

test('a tip follows the mouse pixel by pixel, parallel to the picture', () => {
  for (let i = 0; i < 200; ++i) {
    const camera = microscope(), tip = vector(10), [dx, dy] = [200 * random() - 100, 200 * random() - 100];
    const from = pixelOf(camera, tip, kSize), moved = shifted(camera, tip, dx, dy, kSize), to = pixelOf(camera, moved, kSize);
    near(to[0] - from[0], dx, 1e-6);
    near(to[1] - from[1], dy, 1e-6);
    const forward = minus(camera.target, camera.position), way = minus(moved, tip);
    near(way[0] * forward[0] + way[1] * forward[1] + way[2] * forward[2], 0, 1e-9);
  }
});

test('the wheel leads a tip along the line of sight', () => {
  for (let i = 0; i < 50; ++i) {
    const camera = microscope(), tip = vector(10), mm = random() - 0.5, forward = minus(camera.target, camera.position);
    const way = minus(deeper(camera, tip, mm), tip);
    near(distance(way, [0, 0, 0]), Math.abs(mm), 1e-9);
    near(distance(cross(way, forward), [0, 0, 0]), 0, 1e-9);
    assert.equal(Math.sign(way[2]), -Math.sign(mm));
  }
});

const kForceps = {name: 'forceps', kind: 'forceps', has_jaws: true, is_lamp: false, start: {opening: 20}};
const kLamp = {name: 'lamp', kind: 'lamp', has_jaws: false, is_lamp: true, start: {opening: 0}};
const kNeedle = {name: 'needle', kind: 'needle', has_jaws: false, is_lamp: false, start: {opening: 0}};

test('jaws close step by step and open to where the scene has them', async () => {
  const sent = [];
  const hand = new Hand(kForceps, {tip: [0, 0, 0], roll: 0, opening: 20, active: 0}, (wish) => sent.push(wish.opening));
  hand.hold(true);
  hand.hold(true);
  await until('they are closed', () => sent.at(-1) === 0);
  assert.ok(sent.length >= 5 && sent.every((opening, i) => !i || opening < sent[i - 1]), String(sent));
  hand.hold(false);
  await until('they are open', () => sent.at(-1) === 20);
});

test('a lamp changes at each press, and a needle has nothing to close', () => {
  const sent = [];
  const lamp = new Hand(kLamp, {active: 1}, (wish) => sent.push(wish.active));
  for (const isHeld of [true, false, true, false]) lamp.hold(isHeld);
  assert.deepEqual(sent, [0, 1]);
  new Hand(kNeedle, {active: 0}, () => assert.fail()).hold(true);
});

test('every key means one thing, and Shift makes moves larger only', () => {
  const keys = kOperationKeys.flatMap((one) => one.keys);
  assert.equal(new Set(keys).size, keys.length);
  const of = (key, more = {}) => bindingOf({key, code: '', ctrlKey: false, altKey: false, metaKey: false, shiftKey: false, ...more})?.action;
  assert.equal(of('ArrowLeft'), 'left');
  assert.equal(of('ArrowLeft', {shiftKey: true}), 'left');
  assert.equal(of('R', {shiftKey: true}), 'restart');
  assert.equal(of('r'), undefined);
  assert.equal(of('+', {shiftKey: true}), 'zoom-in');
  assert.equal(of('P', {shiftKey: true}), undefined);
  assert.equal(of('s', {ctrlKey: true}), 'save');
  assert.equal(of('p', {ctrlKey: true}), undefined);
});

test('of many moves few are sent, the newest is, and none after the hand has let go', async () => {
  const sent = [];
  const hand = new Hand(kNeedle, {tip: [0, 0, 0]}, ({tip}) => sent.push(tip[0]));
  for (let n = 1; n <= 1000; ++n) hand.moveTo([n, 0, 0]);
  assert.equal(sent[0], 1, 'the first one at once');
  await until('the newest is sent', () => sent.at(-1) === 1000);
  assert.ok(sent.length < 100, `${sent.length} moves were sent`);
  hand.moveTo([1001, 0, 0]);
  hand.moveTo([1002, 0, 0]);
  hand.end();
  const {length} = sent;
  await new Promise((resolve) => setTimeout(resolve, 50));
  assert.equal(sent.length, length);
});

test('the parts of a trip are its whole time, of the oldest input of a picture', () => {
  const trips = new Trips();
  trips.sent(1, 100, 102);
  trips.sent(2, 110, 111);
  trips.sent(3, 120, 121);
  trips.shown({event: 2, serverMs: 30, came: 134, decoded: 140}, 150);
  assert.deepEqual(trips.ms, {page: [2], server: [30], way: [2], decoding: [6], screen: [10]});
  trips.shown({event: 2, serverMs: 1, came: 160, decoded: 161}, 162);
  assert.equal(trips.ms.page.length, 1, 'a picture without an input of its own');
  trips.shown({event: 3, serverMs: 30, came: 160, decoded: 161}, 170);
  assert.equal(Object.values(trips.ms).reduce((sum, ms) => sum + ms.at(-1), 0), 170 - 120);
});

test('a session keeps what it is told, and only the newest picture is shown', () => {
  class Socket {
    constructor() { Socket.last = this; this.readyState = 1; this.sent = []; }
    send(text) { this.sent.push(JSON.parse(text)); }
  }
  const session = new OperationSession('ws://x', 't', Socket);
  const heard = (message) => Socket.last.onmessage({data: JSON.stringify(message)});
  Socket.last.onopen();
  heard({hello: {version: '1', session: 'a'}});
  heard({status: {time_s: 1, is_paused: false, instruments: [{name: 'forceps', is_led: true}]}});
  heard({events: [{kind: 'touch', time_s: 1}]});
  assert.equal(session.state, 'connected');
  assert.equal(session.instrument('forceps').is_led, true);
  assert.equal(session.events.length, 1);
  session.lead('forceps', {tip: [1, 2, 3]}, 0);
  assert.deepEqual(Socket.last.sent, [{n: 1, instrument: {name: 'forceps', tip: [1, 2, 3]}}]);
  heard({re: 1, error: 'no such thing'});
  assert.equal(session.log.at(-1).text, 'no such thing');
  const frame = (number, event) => ({frame: number, event, connection: 1});
  assert.ok(session.passes(frame(2, 1)));
  assert.ok(!session.passes(frame(1, 1)), 'an older one');
  assert.equal(session.counts.stale, 1);
});
