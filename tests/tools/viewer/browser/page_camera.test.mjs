// Cameras, planes and lines of the page, without a browser. Laws are checked on random cases.

import assert from 'node:assert/strict';
import {test} from 'node:test';
import * as cameras from '../../../../tools/viewer/page/camera.js';
import {Geometry, PixelPlane, scaleBar} from '../../../../tools/viewer/page/geometry.js';
import {PieceTurn} from '../../../../tools/viewer/page/piece_turn.js';
import {simplified, strokeLength} from '../../../../tools/viewer/page/strokes.js';
import {add, cross, distance, dot, length, minus, normalized, times, turned as turnedBy} from '../../../../tools/viewer/page/vectors.js';

/// Numbers in [0, 1) that are the same in every run (Park and Miller 1988).
let seed = 20;
const random = () => (seed = seed * 48271 % 2147483647) / 2147483647;
const vector = (size = 1) => [0, 1, 2].map(() => (2 * random() - 1) * size);
const near = (a, b, tolerance = 1e-9) => assert.ok(
  Math.abs(a - b) <= tolerance * Math.max(1, Math.abs(a)), `${a} is not ${b}`);
const nearAll = (a, b, tolerance) => a.forEach((value, i) => near(value, b[i], tolerance));

function someCamera(projection) {
  const target = vector(50);
  const camera = {projection, target, position: add(target, times(normalized(vector()), 200 + 300 * random())), up: vector()};
  return projection === 'orthographic' ? {...camera, height: 100 + 200 * random()} : {...camera, fov: 10 + 50 * random()};
}
function forCameras(check) {
  for (let i = 0; i < 200; ++i) check(someCamera(i % 2 ? 'orthographic' : 'perspective'), [300 + 500 * random(), 200 + 500 * random()]);
}

test('the ray of a pixel leads back to the pixel', () => forCameras((camera, size) => {
  const at = [random() * size[0], random() * size[1]];
  const {origin, direction} = cameras.rayAt(camera, ...at, size);
  near(length(direction), 1);
  nearAll(cameras.pixelOf(camera, add(origin, times(direction, 50 + 100 * random())), size), at, 1e-7);
}));

test('a turned camera keeps its distance and its target in the middle, and up across the view', () => forCameras((camera, size) => {
  const turned = cameras.rotated(camera, 400 * random() - 200, 400 * random() - 200, size);
  near(distance(turned.position, turned.target), distance(camera.position, camera.target));
  nearAll(cameras.pixelOf(turned, camera.target, size), times([...size, 0], 0.5).slice(0, 2), 1e-7);
  near(dot(turned.up, minus(turned.target, turned.position)), 0, 1e-6);
}));

test('a drag to the right turns what lies before the target to the right', () => forCameras((camera, size) => {
  const front = add(camera.target, times(normalized(minus(camera.position, camera.target)), 20));
  const right = cameras.pixelOf(cameras.rotated(camera, 10, 0, size), front, size);
  const down = cameras.pixelOf(cameras.rotated(camera, 0, 10, size), front, size);
  assert.ok(right[0] > size[0] / 2 + 1e-6 && Math.abs(right[1] - size[1] / 2) < 1e-6);
  assert.ok(down[1] > size[1] / 2 + 1e-6 && Math.abs(down[0] - size[0] / 2) < 1e-6);
}));

test('a drag across the view turns by 200 degrees', () => {
  const camera = {projection: 'perspective', position: [0, -100, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 30};
  const {position} = cameras.rotated(camera, 400, 0, [400, 300]);
  const angle = Math.atan2(position[0], -position[1]) * 180 / Math.PI;
  near(Math.abs(angle), 160, 1e-9);
});

test('a panned picture follows the pointer in the plane of the target', () => forCameras((camera, size) => {
  const [x, y, dx, dy] = [random() * size[0], random() * size[1], 60 * random() - 30, 60 * random() - 30];
  const place = cameras.placeInViewPlane(camera, camera.target, x, y, size);
  nearAll(cameras.pixelOf(cameras.panned(camera, dx, dy, size), place, size), [x + dx, y + dy], 1e-7);
}));

test('zooming by a factor shows as much less at the target', () => forCameras((camera) => {
  near(cameras.heightAtTarget(cameras.zoomed(camera, 1.5)), cameras.heightAtTarget(camera) / 1.5);
}));

test('a rolled picture follows the pointer around its middle', () => forCameras((camera, size) => {
  const from = [size[0] / 2 + 40, size[1] / 2 + 10], to = [size[0] / 2 + 20, size[1] / 2 - 30];
  const place = cameras.placeInViewPlane(camera, camera.target, ...from, size);
  const degrees = cameras.angleAround(...from, ...to, size);
  const seen = cameras.pixelOf(cameras.rolled(camera, degrees), place, size);
  const angle = ([x, y]) => Math.atan2(y - size[1] / 2, x - size[0] / 2);
  near(angle(seen), angle(to), 1e-7);
}));

test('perspective and orthographic show as much at the target', () => forCameras((camera) => {
  const other = camera.projection === 'orthographic' ? 'perspective' : 'orthographic';
  const changed = cameras.projectedAs(camera, other);
  assert.equal(changed.projection, other);
  assert.equal('fov' in cameras.cameraKeys(changed), other === 'perspective');
  near(cameras.heightAtTarget(changed), cameras.heightAtTarget(camera));
}));

test('a side shows every corner of the box with 5 % to spare', () => {
  const geometry = new Geometry({affine: [1, 0, 0, -50, 0, 1, 0, -70, 0, 0, 2, -60, 0, 0, 0, 1], dims: [100, 140, 60], spacing: [1, 1, 2]});
  for (const camera of [{projection: 'perspective', fov: 30}, {projection: 'orthographic'}]) {
    for (const side of Object.keys(cameras.kSides)) {
      const size = [400, 300];
      const pixels = geometry.corners().map((corner) => cameras.pixelOf(cameras.framed(geometry.corners(), 4 / 3, side, camera), corner, size));
      const least = Math.min(...pixels.flatMap(([x, y]) => [x / 400, 1 - x / 400, y / 300, 1 - y / 300]));
      near(least, 0.05, 1e-9);
    }
  }
});

test('a shift kept to an axis is seen nearest to the pointer', () => forCameras((camera) => {
  const frame = cameras.cameraFrame(camera);
  const axis = [0, 0, 0];
  axis[Math.floor(random() * 3)] = 1;
  const shift = add(times(frame.right, 10 * random()), times(frame.up, 10 * random()));
  const kept = cameras.alongAxis(frame, shift, axis);
  near(length(cross(kept, axis)), 0, 1e-9);
  const off = (t) => {
    const way = minus(times(axis, t), shift);
    return Math.hypot(dot(way, frame.right), dot(way, frame.up));
  };
  if (Math.abs(dot(axis, frame.forward)) < 0.99) {
    const t = dot(kept, axis);
    assert.ok(off(t) <= off(t + 0.01) && off(t) <= off(t - 0.01));
  }
}));

test('letters name the sides within 78 degrees, nearest first', () => {
  assert.equal(cameras.sideLetters([1, 0, 0]), 'L');
  assert.equal(cameras.sideLetters([-0.8, -0.6, 0]), 'RA');
  assert.equal(cameras.sideLetters([0, 0.1, -1]), 'I');
  assert.equal(cameras.sideLetters([0, 0.3, 0.9]), 'SP');
});

test('places and grid ways go to LPS and back, also on sheared grids', () => {
  const geometry = new Geometry({affine: [0.9, 0.1, 0, 5, -0.2, 1.1, 0.3, -7, 0, 0.2, -2, 9, 0, 0, 0, 1], dims: [8, 9, 10],
                                 spacing: [Math.hypot(0.9, 0.2), Math.hypot(0.1, 1.1, 0.2), Math.hypot(0.3, 2)]});
  for (let i = 0; i < 50; ++i) {
    const v = vector(30);
    nearAll(geometry.indexOfLps(geometry.lpsOfIndex(v)), v);
    nearAll(geometry.gridOfLps(geometry.lpsOfGrid(v)), v);
  }
  // A grid way of its axis' length is one voxel.
  nearAll(geometry.lpsOfGrid([geometry.spacing[0], 0, 0]), minus(geometry.lpsOfIndex([1, 0, 0]), geometry.lpsOfIndex([0, 0, 0])));
  assert.deepEqual([0, 1, 2].map((axis) => geometry.axisNearest(axis)), [0, 1, 2]);
});

test('pixels of a slice go to places and back', () => {
  const plane = new PixelPlane([1, 2, 3, 0.5, 0, 0.1, 0, 0.5, 0]);
  nearAll(plane.lpsOf(0.5, 0.5), [1, 2, 3]);
  for (let i = 0; i < 50; ++i) {
    const at = [random() * 100, random() * 100];
    nearAll(plane.pixelOf(plane.lpsOf(...at)), at);
    nearAll(plane.pixelOf(add(plane.lpsOf(...at), times(normalized(cross(plane.right, plane.down)), 5))), at);
  }
});

test('a scale bar is round and fits', () => {
  for (const mmPerPixel of [0.003, 0.04, 0.5, 1.7, 33]) {
    const {mm, pixels} = scaleBar(mmPerPixel, 160);
    assert.ok(pixels <= 160 && pixels > 160 / 2.6);
    assert.ok([1, 2, 5].includes(Number(mm.toExponential()[0])));
  }
  assert.equal(scaleBar(0, 100), null);
});

test('a simplified line keeps its ends and stays within its tolerance', () => {
  const points = Array.from({length: 300}, (_, i) => [i, 20 * Math.sin(i / 30) + random()]);
  const few = simplified(points, 2);
  assert.ok(few.length < 30 && few.length > 4);
  assert.deepEqual([few[0], few.at(-1)], [points[0], points[299]]);
  for (const [x, y] of points) {
    const i = Math.max(1, few.findIndex(([fx]) => fx >= x));
    const [[x0, y0], [x1, y1]] = [few[i - 1], few[i]];
    assert.ok(Math.abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / Math.hypot(x1 - x0, y1 - y0) <= 2 + 1e-9);
  }
  assert.equal(strokeLength([[0, 0], [3, 4], [3, 5]]), 6);
});

test('turns of a bone follow one another, swept or typed, and beyond half a turn', () => {
  const turn = new PieceTurn();
  turn.begin();
  turn.sweep([10, 0], [0, 0]);
  for (let degrees = 5; degrees <= 200; degrees += 5) {
    turn.sweep([10 * Math.cos(degrees * Math.PI / 180), 10 * Math.sin(degrees * Math.PI / 180)], [0, 0]);
  }
  turn.lead([0, 1, 0], null, null);
  assert.equal(turn.degrees, 200);  // clockwise, as seen along y
  nearAll(turn.vector(), [0, -160, 0], 1e-9);
  turn.lead([0, 1, 0], [0, -1, 0], null);
  assert.equal(turn.degrees, -200);
  turn.lead([0, 1, 0], [0, 0, 1], 30);
  turn.end();
  turn.begin();
  turn.lead([0, 1, 0], [1, 0, 0], 50);
  const all = turn.vector();
  for (const x of [[1, 0, 0], [0, 1, 0], [0.3, -2, 1]]) {
    nearAll(turnedBy(x, normalized(all), length(all)), turnedBy(turnedBy(x, [0, 0, 1], 30), [1, 0, 0], 50), 1e-9);
  }
});
