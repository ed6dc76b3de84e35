// Who stops a drag. The server tells whether the sides of a cut or what is held and fixed did; of the latter the
// page names the nearest.

import {distance} from './vectors.js';

const rounded = (voxel) => voxel.map(Math.round).join(', ');

/// mm from a place at rest to what an anchor or handle holds there; none: it has no middle.
function apart({rest_lps: middle, event}, place) {
  if (!middle) return Infinity;
  return Math.max(0, distance(middle, place) - (event?.radius ?? 0));
}

/// A subject with its verb, "anchor 1 at 127, 235, 29 stops". `voxel`: what is grabbed.
export function stopper({scene, geometry}, voxel) {
  if (scene.drag.stopped_by === 'cut') return 'the sides of a cut stop';
  const place = geometry.lpsOfIndex(voxel);
  const isGrabbed = ({voxel: other}) => other && other.every((at, a) => at === voxel[a]);
  const all = [...(scene.anchors ?? []).map((one, i) => ({...one, name: `anchor ${i + 1}`})),
               ...(scene.handles ?? []).map((one, i) => ({...one, name: `handle ${i + 1}`}))].filter((one) => !isGrabbed(one));
  if (!all.length) return 'what is held stops';
  const nearest = all.reduce((best, one) => apart(one, place) < apart(best, place) ? one : best);
  const where = nearest.voxel ? ` at ${rounded(nearest.voxel)}` : '';
  return all.length > 1 ? `what is held, nearest ${nearest.name}${where}, stops` : `${nearest.name}${where} stops`;
}
