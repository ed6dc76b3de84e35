// Cameras as journals write them (docs/scenes.md, "Cameras"): position, target and up in LPS mm, and
// fov in degrees or, orthographic, height in mm. Every function gives a new camera. The motions are
// those of VTK's trackball, which 3D Slicer uses: 200 degrees for a drag across the view.

import {add, cross, dot, length, minus, normalized, rounded, times, turned} from './vectors.js';

export const kDegreesPerView = 200;

/// Towards the camera and upwards, as raycast/scene/camera.cpp has them.
export const kSides = {
  anterior: [[0, -1, 0], [0, 0, 1]], posterior: [[0, 1, 0], [0, 0, 1]],
  left: [[1, 0, 0], [0, 0, 1]], right: [[-1, 0, 0], [0, 0, 1]],
  superior: [[0, 0, 1], [0, -1, 0]], inferior: [[0, 0, -1], [0, -1, 0]]};

const isOrthographic = (camera) => camera.projection === 'orthographic';

export function cameraFrame(camera) {
  const forward = normalized(minus(camera.target, camera.position));
  const right = normalized(cross(forward, camera.up));
  return {right, up: cross(right, forward), forward};
}

/// Half the height of a picture at a distance of 1.
const halfHeight = (camera) => Math.tan(camera.fov * Math.PI / 360);

/// The world's height of the whole view in the plane through the target, in mm.
export function heightAtTarget(camera) {
  if (isOrthographic(camera)) return camera.height;
  return 2 * halfHeight(camera) * length(minus(camera.target, camera.position));
}

/// Turned about the target by a drag of (dx, dy) pixels in a view of `size` [width, height].
export function rotated(camera, dx, dy, size) {
  return orbited(camera, -dx / size[0] * kDegreesPerView, -dy / size[1] * kDegreesPerView);
}

/// Azimuth about the picture's up, then elevation about its right; up stays across the view.
export function orbited(camera, azimuth, elevation) {
  let {right, up} = cameraFrame(camera);
  let arm = turned(minus(camera.position, camera.target), up, azimuth);
  right = turned(right, up, azimuth);
  arm = turned(arm, right, elevation);
  up = turned(up, right, elevation);
  return {...camera, position: add(camera.target, arm), up: normalized(up)};
}

/// Moved so that what lies in the plane of the target follows the pointer.
export function panned(camera, dx, dy, size) {
  const {right, up} = cameraFrame(camera);
  const mmPerPixel = heightAtTarget(camera) / size[1];
  const shift = add(times(right, -dx * mmPerPixel), times(up, dy * mmPerPixel));
  return {...camera, position: add(camera.position, shift), target: add(camera.target, shift)};
}

/// Nearer by `factor` > 1: a perspective camera moves, an orthographic one sees less.
export function zoomed(camera, factor) {
  if (isOrthographic(camera)) return {...camera, height: camera.height / factor};
  const arm = times(minus(camera.position, camera.target), 1 / factor);
  return {...camera, position: add(camera.target, arm)};
}

/// Turned about the line of sight; positive degrees turn the picture counterclockwise.
export function rolled(camera, degrees) {
  const {up, forward} = cameraFrame(camera);
  return {...camera, up: normalized(turned(up, forward, degrees))};
}

/// Degrees that the pointer went around the middle of a view, from (x0, y0) to (x1, y1).
export function angleAround(x0, y0, x1, y1, size) {
  const angle = (x, y) => Math.atan2(size[1] / 2 - y, x - size[0] / 2);
  const degrees = (angle(x1, y1) - angle(x0, y0)) * 180 / Math.PI;
  return degrees > 180 ? degrees - 360 : degrees < -180 ? degrees + 360 : degrees;
}

/// A ray through the pixel (x, y), as CameraRays::at has it.
export function rayAt(camera, x, y, size) {
  const {right, up, forward} = cameraFrame(camera);
  const half = isOrthographic(camera) ? camera.height / 2 : halfHeight(camera);
  const aside = add(times(right, (2 * x - size[0]) / size[1] * half),
                    times(up, (size[1] - 2 * y) / size[1] * half));
  if (isOrthographic(camera)) return {origin: add(camera.position, aside), direction: forward};
  return {origin: camera.position, direction: normalized(add(forward, aside))};
}

/// The pixel of a place, or null behind the camera.
export function pixelOf(camera, place, size) {
  const {right, up, forward} = cameraFrame(camera);
  const p = minus(place, camera.position);
  const depth = dot(p, forward);
  if (!(depth > 0)) return null;
  const half = isOrthographic(camera) ? camera.height / 2 : depth * halfHeight(camera);
  return [(dot(p, right) / half * size[1] + size[0]) / 2, (size[1] - dot(p, up) / half * size[1]) / 2];
}

/// Where the plane through `place` across the view is met by the pixel's ray.
export function placeInViewPlane(camera, place, x, y, size) {
  const {origin, direction} = rayAt(camera, x, y, size);
  const {forward} = cameraFrame(camera);
  return add(origin, times(direction, dot(minus(place, origin), forward) / dot(direction, forward)));
}

/// A shift kept to one axis: the way along it that is seen nearest to where the pointer leads, in a
/// picture with the directions right, up and forward. An axis that looks into the picture (within 5
/// degrees) is moved along by the vertical way of the pointer, up: away.
export function alongAxis({right, up, forward}, shift, axis) {
  const inPlane = minus(axis, times(forward, dot(axis, forward)));
  const seen = dot(inPlane, inPlane);
  if (seen < Math.sin(5 * Math.PI / 180) ** 2) {
    return times(axis, dot(shift, up) * Math.sign(dot(axis, forward)));
  }
  const flat = add(times(right, dot(shift, right)), times(up, dot(shift, up)));
  return times(axis, dot(flat, inPlane) / seen);
}

/// A named view that frames the corners of a box with 5 % to spare on each side, as default_camera.
export function framed(corners, aspect, side, camera) {
  const [from, up] = kSides[side];
  const target = corners.reduce((sum, c) => add(sum, times(c, 1 / corners.length)), [0, 0, 0]);
  const seen = {...camera, target, position: add(target, from), up};
  const frame = cameraFrame(seen);
  let reach = 0, half = 0, depth = 0;
  for (const corner of corners) {
    const p = minus(corner, target);
    const extent = Math.max(Math.abs(dot(p, frame.right)) / aspect, Math.abs(dot(p, frame.up))) / 0.9;
    if (!isOrthographic(camera)) reach = Math.max(reach, extent / halfHeight(camera) - dot(p, frame.forward));
    half = Math.max(half, extent);
    depth = Math.max(depth, Math.abs(dot(p, frame.forward)));
  }
  if (isOrthographic(camera)) {
    return {...seen, height: 2 * half, position: add(target, times(from, 2 * depth + half))};
  }
  return {...seen, position: add(target, times(from, reach))};
}

/// The same view in the other projection: as much is seen in the plane of the target.
export function projectedAs(camera, projection) {
  if ((camera.projection ?? 'perspective') === projection) return camera;
  const {fov, height, ...rest} = camera;
  if (projection === 'orthographic') return {...rest, projection, height: heightAtTarget(camera)};
  const arm = normalized(minus(camera.position, camera.target));
  const perspective = {...rest, projection, fov: 30};
  return {...perspective,
          position: add(camera.target, times(arm, height / 2 / halfHeight(perspective)))};
}

/// What an event's `camera` table holds; numbers without noise, so that journals stay readable.
export function cameraKeys(camera) {
  const list = (v) => v.map((x) => rounded(x));
  const keys = {projection: camera.projection ?? 'perspective', position: list(camera.position),
                target: list(camera.target), up: list(camera.up)};
  if (isOrthographic(camera)) return {...keys, height: rounded(camera.height)};
  return {...keys, fov: rounded(camera.fov)};
}

/// Letters of the patient's sides towards which a direction points: nearest first, those within 78
/// degrees (docs/pictures.md, "Annotations").
export function sideLetters(direction) {
  const pairs = [['L', 'R'], ['P', 'A'], ['S', 'I']];
  return normalized(direction)
    .map((value, axis) => [Math.abs(value), pairs[axis][value < 0 ? 1 : 0]])
    .filter(([size]) => size > Math.cos(78 * Math.PI / 180))
    .sort((a, b) => b[0] - a[0]).map(([, letter]) => letter).join('');
}
