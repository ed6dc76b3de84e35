// The bar of what takes long: what is being done, for how long still, and a button that ends it. Work that says
// nothing of itself is told of, too, a second after it was asked for.

const kQuietMs = 1000, kTickMs = 250;
const kLeastPart = 0.03;  // of which the rest can be told

export class ProgressBar {
  /// `sending`: what is on its way from the page, which its button ends, too.
  constructor(session, sending) {
    Object.assign(this, {session, sending});
    this.bar = document.getElementById('progress');
    this.what = document.getElementById('progress-what');
    this.meter = document.getElementById('progress-part');
    session.on('progress', () => this.show());
    document.getElementById('progress-cancel').addEventListener('click', () => this.cancel());
    setInterval(() => this.show(), kTickMs);
  }

  get isBusy() { return Boolean(this.session.progress) || this.session.waitsMs() > kQuietMs; }
  /// Ends what runs and what waits behind it; whether there is anything.
  cancel() {
    if (!this.isBusy) return false;
    if (this.sending.isBusy) this.sending.cancel();
    else this.session.ask('cancel', true).catch(() => {});
    return true;
  }

  show() {
    const {progress} = this.session;
    this.bar.hidden = !this.isBusy;
    if (this.bar.hidden) return;
    this.what.textContent = progress ? progress.what + this.left() : 'working';
    if (Number.isFinite(progress?.part) && progress.part > 0) this.meter.value = progress.part;
    else this.meter.removeAttribute('value');
  }
  /// A relaxation comes in slices, and nobody knows how many.
  left() {
    const {progress: {part, ms}, scene} = this.session;
    if (scene?.relaxing || !(part >= kLeastPart) || !(ms > kQuietMs)) return '';
    const seconds = Math.ceil(ms / 1000 * (1 - part) / part);
    return seconds > 90 ? `, about ${Math.ceil(seconds / 60)} minutes left` : `, about ${seconds} s left`;
  }
}
