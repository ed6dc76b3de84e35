// A session that ended with something unsaved: whether to go on where it ended.

export class LeftSession {
  constructor(app) {
    Object.assign(this, {app, session: app.session, root: document.getElementById('left')});
    document.getElementById('left-go-on').addEventListener('click', () => this.answer(true));
    document.getElementById('left-begin').addEventListener('click', () => this.answer(false));
    this.session.on('connection', () => this.refresh());
  }

  refresh() {
    const left = this.session.state === 'connected' ? this.session.hello?.left : null;
    this.root.hidden = !left;
    if (left) document.getElementById('left-text').textContent = `Go on where it ended? There is ${left.text}.`;
    this.app.sizesChanged();
  }

  async answer(goesOn) {
    this.root.hidden = true;
    if (this.session.hello) this.session.hello.left = null;
    this.app.sizesChanged();
    try {
      await this.session.ask('go_on', goesOn);
      this.app.say(goesOn ? 'The session goes on where it ended' : 'Begun anew; the earlier session stays on disk until it is pruned');
    } catch (error) {
      this.app.say(error.message);
    }
  }
}
