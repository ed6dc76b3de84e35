// Cuts and anchors over a picture: where the server says that they are now.

import {svg} from './elements.js';
import {add, dot, minus, times} from './vectors.js';

/// Where triangles of the sheet cross a plane, as pairs of places; `side(place)`: mm from the plane.
export function crossings({line, down, up}, side) {
  const pairs = [];
  for (let i = 1; i < line.length; ++i) {
    const [a, b] = [line[i - 1], line[i]];
    for (const corners of [[add(a, up), add(b, up), add(b, down)], [add(a, up), add(b, down), add(a, down)]]) {
      const found = corners.flatMap((from, n) => {
        const to = corners[(n + 1) % 3];
        const [s, t] = [side(from), side(to)];
        return (s < 0) === (t < 0) ? [] : [add(from, times(minus(to, from), s / (s - t)))];
      });
      if (found.length === 2) pairs.push(found);
    }
  }
  return pairs;
}

const path = (view, cls, places) => {
  const pixels = places.map((lps) => view.pixelOf(lps));
  if (pixels.some((pixel) => !pixel)) return null;
  return svg('polyline', {class: cls, points: pixels.map((pixel) => view.toCss(pixel).join(',')).join(' ')});
};

/// In space the line that was drawn and how deep it goes; in a slice where the sheet crosses it.
export function cutMarks(view) {
  return (view.session.scene.cuts ?? []).flatMap(({sheet}) => {
    if (!sheet) return [];
    const {line, down} = sheet;
    if (view.name === '3d') {
      const bottom = line.map((place) => add(place, down));
      return [path(view, 'cut-made deep', [line[0], ...bottom, line.at(-1)]), path(view, 'cut-made', line)];
    }
    const {forward} = view.directions();
    return crossings(sheet, (place) => dot(minus(place, view.plane.origin), forward))
      .map((pair) => path(view, 'cut-made', pair));
  });
}

/// A triangle on its point, with the number of the list.
export function anchorMarks(view, isNear) {
  return (view.session.scene.anchors ?? []).flatMap(({lps, event, number}, i) => {
    const pixel = lps && isNear(lps, event?.radius ?? 0) && view.pixelOf(lps);
    if (!pixel) return [];
    const [x, y] = view.toCss(pixel);
    const label = svg('text', {class: 'anchor-text', x: x + 8, y: y - 4});
    label.textContent = number ?? i + 1;
    return [svg('path', {class: 'anchor', d: `M${x},${y}l-6,-10h12z`}), label];
  });
}
