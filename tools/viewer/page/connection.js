// The socket to the server: numbered messages and their answers, binary frames, and another try with
// growing pauses where it is lost. The token comes from the address behind '#', which no request
// carries.

const kFirstPauseMs = 250, kLongestPauseMs = 8000;

/// `handlers`: opened(), closed(final), text(message), binary(buffer).
export class Connection {
  constructor(address, token, handlers, Socket = WebSocket) {
    Object.assign(this, {address, token, handlers, Socket});
    this.n = 0;
    this.tries = 0;
    this.waiting = new Map();
    this.open();
  }

  get isOpen() { return this.socket?.readyState === 1; }

  open() {
    clearTimeout(this.timer);
    const socket = new this.Socket(this.address, 'supple.' + this.token);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.n = 0;
      this.handlers.opened();
    };
    socket.onmessage = ({data}) => {
      if (this.socket !== socket) return;
      if (typeof data !== 'string') return this.handlers.binary(data);
      const message = JSON.parse(data);
      this.tries = 0;
      if ('re' in message) this.answered(message);
      else this.handlers.text(message);
    };
    socket.onclose = () => {
      if (this.socket === socket) this.lost();
    };
  }

  lost() {
    for (const {reject} of this.waiting.values()) reject(new Error('the connection is lost'));
    this.waiting.clear();
    this.handlers.closed();
    const pause = Math.min(kLongestPauseMs, kFirstPauseMs * 2 ** this.tries++);
    this.timer = setTimeout(() => this.open(), pause);
  }

  /// Tries at once, as a button or a network that is back asks for.
  retry() {
    if (this.isOpen || this.socket?.readyState === 0) return;
    this.tries = 0;
    this.open();
  }

  /// Sends one verb; its number, or 0 where there is no connection.
  post(verb, value) {
    if (!this.isOpen) return 0;
    this.socket.send(JSON.stringify({n: ++this.n, [verb]: value}));
    return this.n;
  }

  /// Sends one verb and gives what it is answered.
  ask(verb, value) {
    const n = this.post(verb, value);
    if (!n) return Promise.reject(new Error('the connection is lost'));
    return new Promise((resolve, reject) => this.waiting.set(n, {resolve, reject}));
  }

  ack(frame) {
    if (this.isOpen) this.socket.send(JSON.stringify({ack: frame}));
  }

  answered({re, ok, error}) {
    const one = this.waiting.get(re);
    this.waiting.delete(re);
    if (error !== undefined) {
      if (one) one.reject(new Error(error));
      else this.handlers.failed(re, error);
    } else {
      one?.resolve(ok);
    }
  }
}
