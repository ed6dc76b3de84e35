// Clips by hand: planes and boxes that cut the picture in space, led by grips. What was asked for last counts until
// the session has it; of what a frame of the screen asks for, only the last is sent.

import {alongAxis} from './camera.js';
import {svg} from './elements.js';
import {planeInBox} from './geometry.js';
import {Grip} from './grips.js';
import {add, distance, dot, minus, normalized, times, turned} from './vectors.js';

const kArm = 0.18;       // from a plane to the grip that turns it, of the volume's diagonal
const kApartPixels = 26;  // of two grips, at least
const rounded = (v, digits = 1000) => v.map((x) => Math.round(x * digits) / digits);

export class Clips {
  constructor(app) {
    Object.assign(this, {app, session: app.session, asked: null, grips: [], key: ''});
    this.session.on('opened', () => { this.asked = null; });
    this.session.on('connection', () => { this.asked = null; });
    this.session.on('scene', () => {
      if (!this.request && this.session.lastCarriedOut >= this.sent) this.asked = null;
    });
  }
  get view() { return this.app.view('3d'); }
  get list() { return this.asked ?? this.session.scene?.view.clips ?? []; }
  set(list) {
    if (!this.session.scene) return;
    this.asked = list;
    this.sent = Infinity;
    this.request ??= requestAnimationFrame((time) => {
      this.request = null;
      this.sent = this.session.event({kind: 'clip', clip: this.asked}, time);
    });
    this.view.refresh();
  }
  change(i, clip) { this.set(this.list.map((one, k) => k === i ? clip : one)); }
  remove(i) { this.set(this.list.filter((_, k) => k !== i)); }
  /// Its grip gets the focus where keys asked for it.
  add(clip, takesFocus = false) {
    if (!this.session.scene) return;
    this.set([...this.list, clip]);
    this.focuses = takesFocus;
  }

  /// What lies between the viewer and the cross-hair is cut away.
  addPlane(takesFocus) {
    if (!this.session.scene) return;
    const {forward} = this.view.directions();
    this.add({plane: {point: rounded(this.app.slices.cursorLps()), normal: rounded(forward)}, space: 'deformed'}, takesFocus);
    if (takesFocus) this.app.say('Clip plane: drag its rings, or arrow keys; Delete takes it away');
  }
  /// Nothing is cut away until one of its faces is led inwards.
  addVolumeBox(takesFocus) {
    if (!this.session.scene) return;
    const {dims} = this.session.geometry;
    this.add({box: [...dims.map(() => -0.5), ...dims.map((n) => n - 0.5)], keep: 'inside', space: 'deformed'}, takesFocus);
    if (takesFocus) this.app.say('Clip box: drag its faces inwards, or arrow keys; Delete takes it away');
  }
  /// The octant from the cross-hair to the corner of the volume that is nearest to the viewer.
  addOctant() {
    if (!this.session.scene) return;
    const {geometry} = this.session;
    const cursor = this.app.slices.now.cursor.map(Math.round);
    const eye = geometry.indexOfLps(this.session.camera().position);
    const corner = geometry.dims.map((n, a) => eye[a] > cursor[a] ? n - 1 : 0);
    this.add({box: [...cursor.map((c, a) => Math.min(c, corner[a])), ...cursor.map((c, a) => Math.max(c, corner[a]))],
              keep: 'outside', space: 'deformed'});
  }

  /// Outlines in the picture, and the grips at their places.
  marks(view) {
    if (view !== this.view) return [];
    const key = JSON.stringify(this.list.map(({box}) => Boolean(box)));
    if (key !== this.key) {
      for (const grip of this.grips.flat()) grip.remove();
      this.grips = this.list.map((clip, i) => clip.box ? this.boxGrips(i) : this.planeGrips(i));
      this.key = key;
    }
    const marks = this.list.flatMap((clip, i) => clip.box ? this.boxMarks(clip, this.grips[i]) : this.planeMarks(clip, this.grips[i]));
    if (this.focuses) this.grips.at(-1)?.[0].focus();
    this.focuses = false;
    return marks;
  }
  at(lps) {
    const pixel = this.view.pixelOf(lps);
    return pixel && this.view.toCss(pixel);
  }
  outline(places) {
    const points = places.map((lps) => this.at(lps));
    return points.length > 2 && points.every(Boolean) ? [svg('polygon', {class: 'clip', points: points.map((p) => p.join(',')).join(' ')})] : [];
  }
  /// The way in LPS that the pointer leads from one place of the picture to another, at the depth of `near`.
  wayAt(near, to, from) {
    const place = (css) => this.view.placeBeside(near, ...this.view.toPixels(...css));
    return minus(place(to), place(from));
  }

  // A plane: one grip shifts it along its normal, one turns it.
  /// The ring lies at its point, or in the middle of what the plane cuts out of the volume's box where that lies outside.
  middleOf({plane: {point, normal}}) {
    const {geometry} = this.session;
    const corners = planeInBox(geometry, point, normal);
    const isInside = geometry.indexOfLps(point).every((v, a) => v >= -0.5 && v <= geometry.dims[a] - 0.5);
    if (isInside || corners.length < 3) return {corners, middle: point};
    return {corners, middle: corners.reduce((sum, c) => add(sum, times(c, 1 / corners.length)), [0, 0, 0])};
  }
  get arm() {
    const corners = this.session.geometry.corners();
    return kArm * distance(corners[0], corners[7]);
  }
  planeGrips(i) {
    const name = `Clip plane ${i + 1}`;
    let before, middle;
    const begins = () => {
      before = this.list[i];
      ({middle} = this.middleOf(before));
    };
    const shifted = (clip, mm) => {
      const {point, normal} = clip.plane;
      this.change(i, {...clip, plane: {point: rounded(add(point, times(normalized(normal), mm))), normal}});
    };
    const turnedTo = (clip, about, normal) => this.change(i, {...clip, plane: {point: rounded(about), normal: rounded(normal, 1e5)}});
    const shift = new Grip(this.view, {
      look: 'ring', label: name + ', place', hint: 'drag, or arrow keys: 1 mm (Shift: 10 mm); Delete takes it away', begins,
      moves: (to, from) => {
        const normal = normalized(before.plane.normal);
        shifted(before, dot(alongAxis(this.view.directions(), this.wayAt(middle, to, from), normal), normal));
      },
      steps: (right, up) => shifted(this.list[i], right + up), removes: () => this.remove(i)});
    const turn = new Grip(this.view, {
      look: 'dot', label: name + ', direction', hint: 'drag, or arrow keys: 1° (Shift: 10°)', begins,
      moves: (to, from) => {
        const {right, up, forward} = this.view.directions();
        const tip = times(normalized(before.plane.normal), -this.arm);
        const led = add(tip, this.wayAt(middle, to, from));
        const [x, y] = [dot(led, right), dot(led, up)];
        const depth = Math.sqrt(Math.max(0, this.arm ** 2 - x * x - y * y)) * (dot(tip, forward) > 0 ? 1 : -1);
        turnedTo(before, middle, normalized(add(add(times(right, -x), times(up, -y)), times(forward, -depth))));
      },
      steps: (toRight, toUp) => {
        const {right, up} = this.view.directions();
        const clip = this.list[i];
        turnedTo(clip, this.middleOf(clip).middle, turned(turned(normalized(clip.plane.normal), up, toRight), right, -toUp));
      },
      removes: () => this.remove(i)});
    return [shift, turn];
  }
  planeMarks(clip, [shift, turn]) {
    const {corners, middle} = this.middleOf(clip);
    const normal = normalized(clip.plane.normal);
    const at = this.at(middle);
    let tip = this.at(add(middle, times(normal, -this.arm)));
    if (at && tip && Math.hypot(tip[0] - at[0], tip[1] - at[1]) < kApartPixels) tip = [at[0] + kApartPixels, at[1] - kApartPixels];
    const mm = dot(clip.plane.point, normal);
    shift.place(at, Math.round(mm), `${mm.toFixed(1)} mm along its normal`);
    turn.place(tip, 0, `normal ${rounded(normal, 100).join(', ')} LPS`);
    const stick = at && tip ? [svg('line', {class: 'clip', x1: at[0], y1: at[1], x2: tip[0], y2: tip[1]})] : [];
    return [...this.outline(corners), ...stick];
  }

  // A box: a grip in each of its faces, which goes by whole voxels.
  boxGrips(i) {
    return [0, 1, 2, 3, 4, 5].map((face) => {
      const axis = face % 3;
      const name = `Clip box ${i + 1}, ${'ijk'[axis]} ${face < 3 ? 'from' : 'to'}`;
      let before;
      const led = (clip, voxels) => {
        const box = [...clip.box];
        const last = this.session.geometry.dims[axis] - 0.5;
        const [least, most] = face < 3 ? [Math.min(-0.5, box[axis]), box[axis + 3]] : [box[axis], Math.max(last, box[axis + 3])];
        box[face] = Math.min(most, Math.max(least, box[face] + Math.round(voxels)));
        this.change(i, {...clip, box});
      };
      const way = () => normalized(this.session.geometry.axes[axis]);
      return new Grip(this.view, {
        look: 'dot', label: name, hint: 'drag, or arrow keys: one voxel (Shift: 10); Delete takes the box away',
        begins: () => { before = this.list[i]; },
        moves: (to, from) => {
          const shift = alongAxis(this.view.directions(), this.wayAt(this.faceMiddle(before.box, face), to, from), way());
          led(before, dot(shift, way()) / this.session.geometry.spacing[axis]);
        },
        steps: (right, up) => led(this.list[i], right + up), removes: () => this.remove(i)});
    });
  }
  faceMiddle(box, face) {
    const index = [0, 1, 2].map((a) => (box[a] + box[a + 3]) / 2);
    index[face % 3] = box[face];
    return this.session.geometry.lpsOfIndex(index);
  }
  boxMarks({box}, grips) {
    const {geometry} = this.session;
    grips.forEach((grip, face) => grip.place(this.at(this.faceMiddle(box, face)), box[face], `voxel ${box[face]}`));
    const corner = (...at) => geometry.lpsOfIndex(at.map((far, a) => box[a + 3 * far]));
    return [0, 1].flatMap((k) => this.outline([corner(0, 0, k), corner(1, 0, k), corner(1, 1, k), corner(0, 1, k)]))
      .concat([[0, 0], [1, 0], [1, 1], [0, 1]].flatMap(([i, j]) => {
        const [a, b] = [this.at(corner(i, j, 0)), this.at(corner(i, j, 1))];
        return a && b ? [svg('line', {class: 'clip', x1: a[0], y1: a[1], x2: b[0], y2: b[1]})] : [];
      }));
  }
}
