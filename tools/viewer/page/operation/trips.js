// Shares of the time from an input to the screen, of the oldest input of each picture: until it is
// sent, in the server until its picture is encoded, on the way back, decoding, and until the screen
// shows it.

const kRoom = 1000;
export const kTripParts = ['page', 'server', 'way', 'decoding', 'screen'];

export class Trips {
  constructor() { this.clear(); }
  clear() {
    this.pending = [];  // {n, input, sent}, ascending
    this.ms = Object.fromEntries(kTripParts.map((part) => [part, []]));
  }

  sent(n, input, sent) { this.pending.push({n, input, sent}); }
  /// `frame` came and was decoded at these times; the screen shows it now.
  shown({event, serverMs, came, decoded}, now) {
    const oldest = this.pending[0]?.n <= event ? this.pending[0] : null;
    while (this.pending[0]?.n <= event) this.pending.shift();
    if (!oldest) return;
    const parts = [oldest.sent - oldest.input, serverMs, came - oldest.sent - serverMs, decoded - came, now - decoded];
    kTripParts.forEach((part, i) => {
      this.ms[part].push(parts[i]);
      if (this.ms[part].length > kRoom) this.ms[part].shift();
    });
  }
}
