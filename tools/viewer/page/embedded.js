// The viewer in a page of somebody else (supple-view.js): tells that page what happens, if it has greeted from an origin
// that the program was told of. Other pages hear nothing, and none may do anything.

export class Embedded {
  constructor(app) {
    Object.assign(this, {app, session: app.session, origin: null, greeting: null, seen: {}});
    if (window.parent === window) return;
    window.addEventListener('message', (event) => {
      if (event.source !== window.parent || event.data?.supple !== 'hello') return;
      this.greeting = event.origin;
      this.answer();
    });
    this.session.on('connection', () => this.answer());
    this.session.on('scene', (scene) => this.sceneChanged(scene));
    this.session.on('slices', () => this.crosshairMoved());
  }

  /// The server says which origins may hear.
  answer() {
    if (!this.greeting || !this.session.hello?.embed?.includes(this.greeting)) return;
    this.origin = this.greeting;
    this.greeting = null;
    this.tell('ready', {});
    this.seen.place = null;
    this.crosshairMoved();
  }
  tell(name, detail) {
    if (this.origin) window.parent.postMessage({supple: name, detail}, this.origin);
  }

  crosshairMoved() {
    const lps = this.app.slices.cursorLps(), key = String(lps);
    if (!lps || !this.origin || key === this.seen.place) return;
    this.seen.place = key;
    this.tell('crosshair', {lps, voxel: this.session.geometry.indexOfLps(lps).map(Math.round)});
  }
  /// A stroke is told once it has ended, and when it is taken back.
  sceneChanged(scene) {
    this.crosshairMoved();
    if (scene?.grab || scene?.settling) return;
    const undo = scene?.undo ?? [], before = this.seen.undo ?? undo;
    this.seen.undo = undo;
    if (undo.length === before.length && undo.at(-1)?.text === before.at(-1)?.text) return;
    const isUndone = undo.length < before.length;
    const {kind, text} = (isUndone ? before : undo).at(-1) ?? {};
    const handle = kind === 'drag' && !isUndone ? scene.handles.at(-1) : null;
    this.tell('stroke', {kind, text, isUndone, lps: handle?.lps ?? null, rest_lps: handle?.rest_lps ?? null});
  }
  saved({what, path, bytes}) { this.tell('saved', {what, path, bytes}); }
}
