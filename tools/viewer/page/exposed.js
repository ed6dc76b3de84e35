// `window.supple`: what the page knows, to be read by tests. Copies, so that nothing can be changed.

const copy = (value) => value === undefined ? undefined : JSON.parse(JSON.stringify(value));

export function exposed(app) {
  const {session, tools} = app;
  return Object.freeze({
    get state() { return session.state; },
    get hello() { return copy(session.hello); },
    get scene() { return copy(session.scene); },
    get slices() { return copy(app.slices.now); },
    get camera() { return copy(session.camera()); },
    get progress() { return copy(session.progress); },
    get log() { return session.log.map(({level, text}) => ({level, text})); },
    get sent() { return session.lastSent; },
    get carriedOut() { return session.lastCarriedOut; },
    get counts() { return {...session.counts}; },
    get tool() { return tools.stroke ? tools.stroke.constructor.name : tools.name; },
    /// Values under the pointer, where on the page that was asked, and milliseconds from events to answers.
    get pointer() { return copy(app.pointerValues.told); },
    get curtain() { return copy(app.curtain.told()); },
    get settings() { return copy(app.settings); },
    /// Sends what changes nothing and is shown in slices after all that was sent before; its number.
    barrier() { return session.post('slices', {}); },
    get decoding() { return app.views.reduce((sum, view) => sum + view.decoding, 0); },
    /// Of each view: the event and frame that it shows, how many it has shown, whether any went back.
    get views() { return Object.fromEntries(app.views.map((view) => [view.name, {...view.shown}])); },
    /// Where a place in LPS mm is on the page, in CSS pixels of the window; null where it is not seen.
    place(name, lps) {
      const view = app.view(name);
      const pixel = view.isVisible ? view.pixelOf(lps) : null;
      if (!pixel) return null;
      const [x, y] = view.toCss(pixel);
      const box = view.picture.getBoundingClientRect();
      return [box.left + x, box.top + y];
    },
    /// Milliseconds from input to the screen: percentiles and count since the last `clear`.
    latency(clear = false) {
      const of = (part) => session.latencies.percentile(part);
      const all = {count: session.latencies.ms.length, median: of(0.5), p95: of(0.95), max: of(1)};
      if (clear) session.latencies.ms = [];
      return all;
    },
  });
}
