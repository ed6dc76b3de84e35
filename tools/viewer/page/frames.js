// Binary frames of the server (tools/viewer/README.md, "Protocol"), their order, and the time from an
// event to the picture that shows it.

export const kViews = ['3d', 'axial', 'coronal', 'sagittal'];
const kHeader = 24, kPlane = 72;

/// A frame's header and picture, or null where the bytes are none of the protocol.
export function parseFrame(buffer) {
  const bytes = new DataView(buffer);
  if (buffer.byteLength < kHeader || bytes.getUint32(0) !== 0x53564631) return null;  // SVF1
  const view = kViews[bytes.getUint8(12)];
  if (!view) return null;
  const plane = view === '3d' ? null : [];
  const start = kHeader + (plane ? kPlane : 0);
  if (buffer.byteLength < start) return null;
  for (let i = 0; plane && i < 9; ++i) plane.push(bytes.getFloat64(kHeader + 8 * i, true));
  return {
    event: bytes.getUint32(4, true), frame: bytes.getUint32(8, true), view,
    type: bytes.getUint8(13) === 1 ? 'image/png' : 'image/jpeg', settled: bytes.getUint8(14) === 1, isAtRest: bytes.getUint8(15) === 1,
    width: bytes.getUint16(16, true), height: bytes.getUint16(18, true),
    serverMs: bytes.getFloat32(20, true), plane, picture: new Uint8Array(buffer, start)};
}

/// Lets through what is newer than what a view shows. Pictures are decoded side by side, so that
/// they may come out of order; frames and events never go back.
export class FrameGate {
  constructor() {
    this.dropped = 0;
    this.restart();
  }
  /// A new connection counts events and frames anew.
  restart() {
    this.frame = -1;
    this.event = -1;
  }
  isNewer(frame) { return frame.frame > this.frame && frame.event >= this.event; }
  /// Takes the frame for shown; false where something newer is.
  pass(frame) {
    if (!this.isNewer(frame)) {
      ++this.dropped;
      return false;
    }
    this.frame = frame.frame;
    this.event = frame.event;
    return true;
  }
}

/// Times from events to pictures, of the last `room` events.
export class Latencies {
  constructor(room = 20000) {
    this.room = room;
    this.pending = [];  // [n, time], ascending
    this.ms = [];
  }
  sent(n, time) { this.pending.push([n, time]); }
  /// A picture shows everything up to event n.
  shown(n, time) {
    while (this.pending.length && this.pending[0][0] <= n) {
      this.ms.push(time - this.pending.shift()[1]);
    }
    if (this.ms.length > this.room) this.ms.splice(0, this.ms.length - this.room);
  }
  forget() { this.pending = []; }
  /// The value that a part of all times does not exceed; null where there are none.
  percentile(part, times = this.ms) {
    if (!times.length) return null;
    const sorted = [...times].sort((a, b) => a - b);
    return sorted[Math.min(sorted.length - 1, Math.max(0, Math.ceil(part * sorted.length) - 1))];
  }
}
