// Mouse, pen and fingers over one view, as what they mean: drags, two fingers, a long press, a double
// click. Moves are gathered and told once per frame of the screen.

const kLongPressMs = 500, kStillPixels = 8, kDoubleTapMs = 350;
const kFrameMs = 16;

/// `handler`: press, drag, lift, pinch, longPress, doubleClick, wheel, hover, leave, lost. Places are CSS
/// pixels in `target`.
export class Gestures {
  constructor(target, handler) {
    this.target = target;
    this.handler = handler;
    this.pointers = new Map();
    this.lastTap = 0;
    this.lastTouch = -Infinity;
    this.moves = null;
    this.flushed = -Infinity;
    const on = (type, listener) => target.addEventListener(type, listener, {passive: false});
    on('pointerdown', (event) => this.down(event));
    on('pointermove', (event) => this.move(event));
    on('pointerup', (event) => this.up(event));
    on('pointercancel', (event) => this.up(event, true));
    on('pointerleave', () => this.handler.leave());
    on('wheel', (event) => this.wheel(event));
    on('contextmenu', (event) => event.preventDefault());
    on('dblclick', (event) => {
      if (event.timeStamp - this.lastTouch > 1000) this.handler.doubleClick(this.place(event));
    });
  }

  place(event) {
    const box = this.target.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top, time: event.timeStamp,
            shift: event.shiftKey, ctrl: event.ctrlKey || event.metaKey, button: event.button,
            touch: event.pointerType === 'touch', side: event.target.dataset?.side};
  }

  down(event) {
    const place = this.place(event);
    this.flush();
    this.target.setPointerCapture?.(event.pointerId);
    this.pointers.set(event.pointerId, place);
    if (place.touch && this.pointers.size === 2) return this.secondFinger();
    if (this.pointers.size > 1) return;
    this.start = place;
    this.isDrag = !place.touch;
    if (this.isDrag) this.handler.press(place);
    else this.timer = setTimeout(() => this.held(), kLongPressMs);
    this.target.focus({preventScroll: true});
    if (event.button === 1) event.preventDefault();
  }

  held() {
    this.isDrag = true;
    this.isLong = true;
    navigator.vibrate?.(15);
    this.handler.longPress(this.start);
  }

  secondFinger() {
    clearTimeout(this.timer);
    if (this.isDrag) this.handler.lost();
    this.isDrag = false;
    this.isPinch = true;
  }

  move(event) {
    const place = this.place(event);
    const before = this.pointers.get(event.pointerId);
    if (!before) return this.gather('hover', place);
    if (this.isPinch) return this.pinched(event.pointerId, place);
    this.pointers.set(event.pointerId, place);
    if (!this.isDrag) {
      if (Math.hypot(place.x - this.start.x, place.y - this.start.y) < kStillPixels) return;
      clearTimeout(this.timer);
      this.isDrag = true;
      this.handler.press(this.start);
    }
    this.gather('drag', {...place, button: this.start.button}, place.x - before.x, place.y - before.y);
  }

  pinched(id, place) {
    const spread = () => {
      const [a, b] = [...this.pointers.values()];
      return b && {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y)};
    };
    const before = spread();
    this.pointers.set(id, place);
    const after = spread();
    if (!before || !(before.size > 0 && after.size > 0)) return;
    this.gather('pinch', {...place, x: after.x, y: after.y}, after.x - before.x, after.y - before.y,
                after.size / before.size);
  }

  up(event, cancelled = false) {
    this.flush();
    clearTimeout(this.timer);
    const place = this.place(event);
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.isPinch) {
      this.isPinch = this.pointers.size > 0;
      return;
    }
    if (this.pointers.size > 0) return;
    if (cancelled) {
      if (this.isDrag) this.handler.lost();
    } else if (this.isDrag) {
      this.handler.lift({...place, button: this.start.button});
    } else {
      this.tapped(place);
    }
    this.isDrag = this.isLong = false;
  }

  tapped(place) {
    this.lastTouch = place.time;
    if (place.time - this.lastTap < kDoubleTapMs) {
      this.lastTap = 0;
      return this.handler.doubleClick(place);
    }
    this.lastTap = place.time;
    this.handler.press(this.start);
    this.handler.lift(place);
  }

  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? event.deltaY * 33 : event.deltaMode === 2 ? event.deltaY * 400 : event.deltaY;
    // Shift turns the wheel sideways in some browsers.
    const steps = (lines || event.deltaX) / 100;
    this.gather('wheel', this.place(event), steps, 0);
  }

  /// Moves of one kind since the last frame add up, factors multiply; the first after a while goes
  /// at once.
  gather(kind, place, dx = 0, dy = 0, factor = 1) {
    if (this.moves && this.moves.kind !== kind) this.flush();
    if (!this.moves) {
      this.moves = {kind, dx: 0, dy: 0, factor: 1, time: place.time};
      this.request = requestAnimationFrame(() => this.flush());
    }
    Object.assign(this.moves, {place, dx: this.moves.dx + dx, dy: this.moves.dy + dy,
                               factor: this.moves.factor * factor});
    if (place.time - this.flushed > kFrameMs) this.flush();
  }

  flush() {
    if (!this.moves) return;
    cancelAnimationFrame(this.request);
    const {kind, place, dx, dy, factor, time} = this.moves;
    this.moves = null;
    this.flushed = place.time;
    this.handler[kind]({...place, time, dx, dy, factor});
  }
}
