// Tools that the pointer or a key starts: grab (grab_stroke.js), anchor, cut along a line, measure (measures.js). At
// most one stroke is under way; it takes the pointer until it ends.

import {GrabStroke} from './grab_stroke.js';
import {CutStroke} from './line_strokes.js';
import {MeasureStroke} from './measures.js';
import {svg} from './elements.js';

export const kTools = [
  ['none', 'Turn and cross-hair', ''], ['grab', 'Grab', 'G'], ['anchor', 'Anchor', 'A'], ['cut', 'Cut', 'K'],
  ['measure', 'Measure', 'M'], ['angle', 'Angle', 'N'], ['window-level', 'Window and level', 'W']];

const kHints = {
  none: 'Left drag turns, in slices it leads the cross-hair', grab: 'Grab: drag the tissue', anchor: 'Anchor: click the tissue that is to stay',
  cut: 'Cut: draw a line, or click point by point and press Enter', measure: 'Measure: drag, or click twice',
  angle: 'Angle: click three times, its corner second; or drag its first side and click',
  'window-level': 'Window and level: drag over a slice'};

const kStrokes = {grab: GrabStroke, cut: CutStroke, measure: MeasureStroke, angle: MeasureStroke};

export class Tools {
  constructor(app) {
    this.app = app;
    this.name = 'none';
    this.stroke = null;
    app.session.on('opened', () => {
      this.stroke?.end();
      this.select('none');
    });
    app.session.on('scene', () => this.stroke?.sceneChanged?.());
    app.session.on('connection', () => this.stroke?.connectionChanged?.());
    app.session.on('log', (line) => {
      if (line.level === 'error' && line.n) this.stroke?.failed?.(line);
    });
  }

  /// A tool of the bar stays until another is taken; one that a key starts is for one stroke.
  select(name, once = false) {
    this.stroke?.cancel();
    this.name = name;
    this.once = once;
    this.app.toolChanged();
  }
  /// The same by a person, who is told what to do with it.
  choose(name, once = false) {
    this.select(name, once);
    this.app.say(kHints[name]);
  }
  toggle(name) { this.choose(this.name === name ? 'none' : name); }

  /// A key: acts at once where the pointer or the cross-hair is.
  start(name) {
    if (!this.app.session.scene) return this.app.say('Open a volume first');
    const view = this.app.viewForTools();
    if (name === 'anchor') return this.anchorAt(view, view.placeForKeys());
    if (name === 'grab') return this.grabAt(view, view.placeForKeys());
    view.picture.focus({preventScroll: true});
    this.choose(this.name === name ? 'none' : name, true);
  }

  /// Fields tell their values when they lose the focus, before the stroke asks for them.
  grabAt(view, place) {
    if (this.isCovered(view, place)) return;
    this.stroke?.cancel();
    this.showBody();
    view.picture.focus({preventScroll: true});
    this.begin(new GrabStroke(this, view, place));
  }
  /// Where a curtain shows the body at rest, there is nothing for hands.
  isCovered(view, {x}) {
    const isCovered = this.app.curtain.covers(view, x);
    if (isCovered) this.app.say('The body at rest is shown here: tools work where it is shown deformed (V, C)');
    return isCovered;
  }
  /// Hands and cuts meet the body itself, not a part of its displacement.
  showBody() {
    if (this.app.amount() !== 1) this.app.showAmount(1);
  }
  begin(stroke) {
    this.stroke = stroke;
    this.app.toolChanged();
  }
  ended(stroke) {
    if (this.stroke !== stroke) return;
    this.stroke = null;
    if (this.once) this.name = 'none';
    this.once = false;
    this.app.toolChanged();
    this.app.refreshViews();
  }

  async anchorAt(view, {x, y}) {
    const {app} = this;
    if (this.isCovered(view, {x})) return;
    try {
      const hit = await app.session.ask('pick', {view: view.name, at: view.toPixels(x, y)});
      if (!hit?.element) return app.say('There is no tissue to fix here');
      const {radius} = app.settings;
      app.session.event(radius > 0 ? {kind: 'anchor', grab_ball: hit.voxel, radius} : {kind: 'anchor', grab: hit.voxel});
      app.say(`Fixed at voxel ${hit.voxel.join(', ')}` + (radius > 0 ? ` within ${radius} mm` : ''));
    } catch (error) {
      app.say(error.message);
    }
  }

  // What views hand on; true where it is the tool's.
  press(view, place) {
    if (this.stroke) {
      if (this.stroke.view !== view) return true;
      if (place.button === 2) this.stroke.cancel();
      else this.stroke.press(place);
      return true;
    }
    const plain = place.button === 0 && !place.shift && !place.ctrl;
    if (!plain || !this.app.session.scene || !view.frame) return false;
    if (this.name === 'anchor') {
      this.anchorAt(view, place);
      return true;
    }
    const Stroke = kStrokes[this.name];
    if (!Stroke) return false;
    if (Stroke !== MeasureStroke && this.isCovered(view, place)) return true;
    if (Stroke !== MeasureStroke) this.showBody();
    this.begin(new Stroke(this, view, place));
    this.stroke.press(place);
    return true;
  }
  move(view, place) {
    if (this.name === 'anchor' || this.name === 'grab') view.refresh();
    if (!this.stroke) return false;
    if (this.stroke.view === view) this.stroke.move(place);
    return true;
  }
  lift(view, place) {
    if (!this.stroke || this.stroke.view !== view) return false;
    this.stroke.lift(place);
    return true;
  }
  lost(view) {
    if (this.stroke?.view === view) this.stroke.cancel();
  }
  wheel(view, place) {
    if (!this.stroke?.wheel || this.stroke.view !== view) return false;
    this.stroke.wheel(place);
    return true;
  }
  doubleClick() {
    if (!this.stroke) return ['cut', 'measure', 'angle', 'anchor', 'grab'].includes(this.name);
    this.stroke.keep();
    return true;
  }

  /// Actions of keys while a stroke is under way.
  act(action, event) {
    const hasEnded = action === 'cancel' && this.app.progress.cancel();
    if (!this.stroke) {
      if (hasEnded) return true;
      if (action === 'cancel' && this.name !== 'none') {
        this.select('none');
        return true;
      }
      return false;
    }
    if (action === 'keep') this.stroke.keep();
    else if (action === 'cancel') this.stroke.cancel();
    else return this.stroke.act?.(action, event) ?? false;
    return true;
  }
  get scopes() {
    if (this.stroke instanceof GrabStroke) return ['grab', 'tool'];
    return this.stroke || this.name !== 'none' || this.app.progress.isBusy || this.app.curtain.mode ? ['tool'] : [];
  }

  marks(view) {
    if (this.stroke) return this.stroke.view === view ? this.stroke.marks() : [];
    if (!['anchor', 'grab'].includes(this.name) || !view.pointer) return [];
    return [this.brush(view, view.pointer.x, view.pointer.y)];
  }
  /// A ring as large as a handle is where the picture is in focus.
  brush(view, x, y, radius = this.app.settings.radius) {
    return svg('circle', {class: 'brush', cx: x, cy: y, r: Math.max(4, radius * view.pixelsPerMm())});
  }
}
