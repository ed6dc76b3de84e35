// Where voxels lie in the patient: the affine of a scene's volume, and what follows from it. An
// index is [i, j, k] with fractions; grid vectors are mm along the grid's axes, as a drag's `to`.

import {add, cross, dot, minus, normalized, times} from './vectors.js';

export class Geometry {
  /// `affine`: 16 numbers, row by row, from index to LPS mm.
  constructor({affine, dims, spacing}) {
    this.dims = dims;
    this.spacing = spacing;
    this.axes = [0, 1, 2].map((a) => [affine[a], affine[4 + a], affine[8 + a]]);
    this.origin = [affine[3], affine[7], affine[11]];
    const volume = dot(this.axes[0], cross(this.axes[1], this.axes[2]));
    this.inverseRows = [[1, 2], [2, 0], [0, 1]].map(
      ([b, c]) => times(cross(this.axes[b], this.axes[c]), 1 / volume));
  }

  lpsOfIndex(index) {
    return index.reduce((sum, value, a) => add(sum, times(this.axes[a], value)), this.origin);
  }
  indexOfLps(lps) {
    const from = add(lps, times(this.origin, -1));
    return this.inverseRows.map((row) => dot(row, from));
  }
  lpsOfGrid(vector) {
    return vector.reduce((sum, mm, a) => add(sum, times(this.axes[a], mm / this.spacing[a])), [0, 0, 0]);
  }
  gridOfLps(vector) {
    return this.inverseRows.map((row, a) => dot(row, vector) * this.spacing[a]);
  }

  /// The index moved into the volume.
  clamped(index) {
    return index.map((value, a) => Math.min(this.dims[a] - 1, Math.max(0, value)));
  }
  /// The outer corners, half a voxel beyond the outermost centres.
  corners() {
    return [0, 1, 2, 3, 4, 5, 6, 7].map((c) => this.lpsOfIndex(
      this.dims.map((n, a) => (c >> a) & 1 ? n - 0.5 : -0.5)));
  }
  /// The grid axis that lies nearest to the patient's axis 0 (left), 1 (posterior) or 2 (superior):
  /// the one that a sagittal, coronal or axial slice is across.
  axisNearest(patientAxis) {
    const alike = this.axes.map((axis, a) => Math.abs(axis[patientAxis]) / this.spacing[a]);
    return alike.indexOf(Math.max(...alike));
  }
}

/// Corners, in order, of what a plane cuts out of the volume's box; none where it passes by.
export function planeInBox(geometry, point, normal) {
  const corners = geometry.corners();
  const height = corners.map((corner) => dot(minus(corner, point), normal));
  const found = [];
  for (let c = 0; c < 8; ++c) {
    for (const bit of [1, 2, 4]) {
      const d = c | bit;
      if (d === c || (height[c] < 0) === (height[d] < 0)) continue;
      found.push(add(corners[c], times(minus(corners[d], corners[c]), height[c] / (height[c] - height[d]))));
    }
  }
  if (found.length < 3) return [];
  const middle = found.reduce((sum, place) => add(sum, times(place, 1 / found.length)), [0, 0, 0]);
  const right = normalized(minus(found[0], middle)), up = cross(normalized(normal), right);
  const angle = (place) => Math.atan2(dot(minus(place, middle), up), dot(minus(place, middle), right));
  return found.sort((a, b) => angle(a) - angle(b));
}

/// The plane that a frame of a slice shows: nine numbers, the LPS place of the middle of the top
/// left pixel and the LPS ways to the next pixel to the right and down.
export class PixelPlane {
  constructor(nine) {
    this.origin = nine.slice(0, 3);
    this.right = nine.slice(3, 6);
    this.down = nine.slice(6, 9);
  }
  lpsOf(x, y) {
    return add(this.origin, add(times(this.right, x - 0.5), times(this.down, y - 0.5)));
  }
  /// The pixel nearest to a place, which may lie off the plane.
  pixelOf(lps) {
    const from = add(lps, times(this.origin, -1));
    const [rr, rd, dd] = [dot(this.right, this.right), dot(this.right, this.down), dot(this.down, this.down)];
    const [r, d] = [dot(from, this.right), dot(from, this.down)];
    const det = rr * dd - rd * rd;
    return [(r * dd - d * rd) / det + 0.5, (d * rr - r * rd) / det + 0.5];
  }
  mmPerPixel() { return Math.sqrt(dot(this.down, this.down)); }
}

/// A round length whose bar takes at most `room` pixels: 1, 2 or 5 times a power of ten.
export function scaleBar(mmPerPixel, room) {
  const most = mmPerPixel * room;
  if (!(most > 0) || !Number.isFinite(most)) return null;
  const power = 10 ** Math.floor(Math.log10(most));
  const mm = [5, 2, 1].find((factor) => factor * power <= most) * power;
  return {mm, pixels: mm / mmPerPixel};
}

const kSides = [['L', 'R'], ['P', 'A'], ['S', 'I']];

/// A place as radiologists read it: R 12.0, A 30.5, S 4.0.
export const sidesText = (lps) => lps.map((mm, a) => `${kSides[a][mm < 0 ? 1 : 0]} ${Math.abs(mm).toFixed(1)}`).join(', ');
