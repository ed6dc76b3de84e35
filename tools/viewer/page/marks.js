// Marks over a picture: the patient's sides, cube, scale bar, cross-hair, handles, measures, and what a
// tool draws. They are made anew from the scene, for the camera or plane of the picture that is seen.

import {heightAtTarget, kSides, sideLetters} from './camera.js';
import {anchorMarks, cutMarks} from './cut_marks.js';
import {svg, short} from './elements.js';
import {scaleBar} from './geometry.js';
import {allMeasures} from './measures.js';
import {distance, dot, minus, times} from './vectors.js';

const line = (cls, [x1, y1], [x2, y2]) => svg('line', {class: cls, x1, y1, x2, y2});
const text = (cls, x, y, words, anchor = 'middle') => {
  const made = svg('text', {class: cls, x, y, 'text-anchor': anchor});
  made.textContent = words;
  return made;
};

export function drawMarks(view) {
  const scene = view.session.scene;
  const all = [];
  if (scene && view.frame && view.directions()) {
    all.push(...letters(view), ...bar(view), ...crosshair(view), ...cutMarks(view), ...anchorMarks(view, (lps, mm) => isNear(view, lps, mm)), ...handles(view), ...allMeasures(view, (lps) => isNear(view, lps)),
             ...view.app.clips.marks(view), ...view.app.tools.marks(view));
    all.push(...legend(view));
    if (view.name === '3d') all.push(cube(view));
  }
  view.marks.replaceChildren(...all.filter(Boolean));
}

function letters(view) {
  const {right, up} = view.directions();
  const [w, h] = [view.picture.clientWidth, view.picture.clientHeight];
  return [text('letter', 6, h / 2 + 5, sideLetters(times(right, -1)), 'start'),
          text('letter', w - 6, h / 2 + 5, sideLetters(right), 'end'),
          text('letter', w / 2, 18, sideLetters(up)),
          text('letter', w / 2, h - 8, sideLetters(times(up, -1)))];
}

function bar(view) {
  const {scale} = view.fit();
  const camera = view.session.shownCamera();
  const mmPerPixel = view.name === '3d' ? heightAtTarget(camera) / view.size()[1] : view.plane.mmPerPixel();
  const found = scaleBar(mmPerPixel / scale, Math.min(160, view.picture.clientWidth / 4));
  if (!found) return [];
  const isNarrow = view.picture.clientWidth < 200;  // then above the letter in the middle
  const [x, y] = [10, view.picture.clientHeight - (isNarrow ? 28 : 10)];
  const note = view.name === '3d' && camera.projection !== 'orthographic' ? ' at target' : '';
  return [svg('path', {class: 'bar', d: `M${x},${y - 5}V${y}H${x + found.pixels}V${y - 5}`}),
          text('bar-text', x + 4, y - 7, `${found.mm} mm${note}`, 'start')];
}

function crosshair(view) {
  if (view.name !== '3d') return view.lines.marks();
  const place = view.app.slices.cursorLps();
  const pixel = place && view.pixelOf(place);
  if (!pixel || !view.app.settings.crosshair) return [];
  const [x, y] = view.toCss(pixel);
  return [line('cross', [x - 9, y], [x - 3, y]), line('cross', [x + 3, y], [x + 9, y]),
          line('cross', [x, y - 9], [x, y - 3]), line('cross', [x, y + 3], [x, y + 9])];
}

/// Within `mm` of a slice, or a voxel.
function isNear(view, lps, mm = 0) {
  return view.name === '3d' || view.distanceOf(lps) <= Math.max(mm, ...view.session.geometry.spacing);
}

function handles(view) {
  return (view.session.scene.handles ?? []).flatMap((handle, i) => {
    if (!handle.lps || !isNear(view, handle.lps)) return [];
    const now = view.pixelOf(handle.lps), rest = handle.rest_lps && view.pixelOf(handle.rest_lps);
    if (!now) return [];
    const [x, y] = view.toCss(now);
    return [rest && distance(handle.lps, handle.rest_lps) > 0.01 ? line('way', view.toCss(rest), [x, y]) : null,
            svg('circle', {class: 'handle', cx: x, cy: y, r: 5}), text('handle-text', x + 8, y - 6, i + 1, 'start')];
  });
}

const kCubeHalf = 21, kCubeMargin = 40;

/// The patient's directions; a face looks from its side when it is clicked.
function cube(view) {
  const {right, up, forward} = view.directions();
  const [cx, cy] = [view.picture.clientWidth - kCubeMargin, view.picture.clientHeight - kCubeMargin];
  const place = (v) => [cx + dot(v, right) * kCubeHalf, cy - dot(v, up) * kCubeHalf];
  const faces = Object.entries(kSides).filter(([, [from]]) => dot(from, forward) < -0.02);
  return svg('g', {class: 'cube'}, ...faces.flatMap(([side, [normal]]) => {
    const across = [0, 1, 2].filter((a) => normal[a] === 0);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([s, t]) => {
      const corner = [...normal];
      corner[across[0]] = s;
      corner[across[1]] = t;
      return place(corner).join(',');
    });
    const face = svg('polygon', {points: corners.join(' '), 'data-side': side,
                                 'fill-opacity': 0.35 + 0.4 * -dot(normal, forward)});
    const [x, y] = place(normal);
    return [face, text('cube-text', x, y + 4, side[0].toUpperCase())];
  }));
}

const kOverlays = {displacement: ['Displacement', ' mm'], det_f: ['det F', ''], energy: ['Strain energy', ' kPa']};

/// Colours of the overlay with their range, where it is painted.
function legend(view) {
  const slices = view.app.slices.now;
  const range = slices.overlay_range;
  const isPainted = view.name !== '3d' || slices.overlay_in_space;
  if (!slices.overlay || slices.overlay === 'none' || !isPainted || !range || view.picture.clientHeight < 150 || view.picture.clientWidth < 180) return [];
  const colours = slices.overlay_colours ?? [];
  const [name, unit] = kOverlays[slices.overlay] ?? [slices.overlay, ''];
  const [x, top, height] = [view.picture.clientWidth - 20, 34, view.picture.clientHeight / 2 - 60];
  if (height < 24) return [];
  const part = height / Math.max(1, colours.length);
  const boxes = colours.map((rgb, i) => svg('rect', {
    x, width: 10, y: top + height - (i + 1) * part, height: part + 0.5, fill: `rgb(${rgb.join(',')})`}));
  return [...boxes, svg('rect', {class: 'legend', x, y: top, width: 10, height}),
          text('legend-text', x + 10, top - 6, name, 'end'),
          text('legend-text', x - 4, top + 9, short(range[1], 3) + unit, 'end'),
          text('legend-text', x - 4, top + height, short(range[0], 3) + unit, 'end')];
}
