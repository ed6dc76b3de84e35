// A link to what is seen: camera, look, clips, slices, the part of the displacement that is shown and the
// view that fills the window, behind the token in the fragment of the address, which no request carries.
// Numbers are those of the session, digit by digit, so that pictures of the same size have the same bytes.

const kSlices = ['cursor', 'window', 'level', 'overlay', 'overlay_in_space', 'outline', 'outline_in_space', 'zoom', 'centre', 'turned'];
const kViewKey = '&view=';

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const picked = (from, keys) => Object.fromEntries(keys.filter((key) => from?.[key] !== undefined).map((key) => [key, from[key]]));

/// Token and view of a fragment; the view null where there is none or it cannot be read.
export function partsOf(hash) {
  const [token, text] = hash.replace(/^#/, '').split(kViewKey);
  if (text === undefined) return {token, view: null, isBroken: false};
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
    return {token, view: JSON.parse(new TextDecoder().decode(bytes)), isBroken: false};
  } catch {
    return {token, view: null, isBroken: true};
  }
}
export function hashOf(token, view) {
  const bytes = new TextEncoder().encode(JSON.stringify(view));
  const text = btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
  return `#${token}${kViewKey}${text}`;
}

/// The view of a scene, as a link keeps it.
export function viewOf(scene, maximised) {
  const {camera, preset, transfer, clips} = scene.view;
  return {camera, ...(preset ? {preset} : {transfer}), clips, slices: picked(scene.slices, kSlices), amount: scene.amount, maximised};
}
/// The events that bring a scene's view there, those left out that would change nothing.
export function eventsTo(view, scene) {
  const {camera, preset, transfer, clips} = scene.view;
  const events = [];
  if (view.preset && view.preset !== preset) events.push({kind: 'look', preset: view.preset});
  if (view.transfer && !same(view.transfer, transfer)) events.push({kind: 'look', transfer: view.transfer});
  if (view.clips && !same(view.clips, clips)) events.push({kind: 'clip', clip: view.clips});
  if (view.camera && !same(view.camera, camera)) events.push({kind: 'camera', camera: view.camera});
  return events;
}
/// The slices of a view; planes that it leaves in the middle of the volume are led back there.
export function slicesTo(view, scene) {
  const centre = {...view.slices?.centre};
  for (const plane of Object.keys(scene.slices.centre ?? {})) centre[plane] ??= scene.volume.dims.map((n) => (n - 1) / 2);
  return {turned: {}, ...picked(view.slices, kSlices), centre};
}

export class ViewLink {
  constructor(app) {
    Object.assign(this, {app, session: app.session, isPending: true});
    this.session.on('opened', (scene) => scene && this.begin());
    window.addEventListener('hashchange', () => this.restore());
  }

  /// What is opened first has the view of the address; else what is remembered counts.
  begin() {
    if (!(this.isPending && this.restore())) this.app.looks.begin();
  }
  /// Brings the view there that the address names; false where it names none.
  restore() {
    const {scene} = this.session;
    if (!scene) return false;
    this.isPending = false;
    const {view, isBroken} = partsOf(location.hash);
    if (isBroken) this.app.say('The view in the address cannot be read; what follows its key is damaged');
    if (!view || typeof view !== 'object') return false;
    for (const event of eventsTo(view, scene)) {
      if (event.kind === 'camera') this.session.setCamera(event.camera);
      else this.session.event(event);
    }
    this.app.slices.set(slicesTo(view, scene));
    if (Number.isFinite(view.amount)) this.app.showAmount(view.amount);
    if (this.app.view(view.maximised) || view.maximised === null) this.app.layout.maximise(view.maximised);
    this.app.say('The view of the link');
    return true;
  }
  /// Puts what is seen into the address, and into the clipboard where that is allowed.
  async copy() {
    const {scene} = this.session;
    if (!scene) return;
    history.replaceState(null, '', hashOf(partsOf(location.hash).token, viewOf(scene, this.app.layout.maximised)));
    try {
      await navigator.clipboard.writeText(location.href);
      this.app.say('A link to this view is in the clipboard and in the address');
    } catch {
      this.app.say('A link to this view is in the address');
    }
  }
}
