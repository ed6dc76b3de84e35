// What the page knows of the operation: the server's last words, and what was sent. Listeners hear of
// 'connection', 'scene', 'status', 'events', 'log', 'frame' and 'shown'.

import {Connection} from '../connection.js';
import {FrameGate, Latencies, parseFrame} from '../frames.js';
import {Trips} from './trips.js';

const kMostEvents = 500;

export class OperationSession {
  constructor(address, token, Socket) {
    this.listeners = new Map();
    this.hello = this.scene = this.status = null;
    this.events = [];
    this.log = [];
    this.state = 'connecting';  // connected, lost, ended
    this.counts = {frames: 0, shown: 0, stale: 0, connections: 0};
    this.latencies = new Latencies();
    this.trips = new Trips();
    this.gate = new FrameGate();
    this.connection = new Connection(address, token, {
      opened: () => this.opened(), closed: () => this.closed(),
      text: (message) => this.heard(message), binary: (buffer) => this.frame(buffer),
      failed: (n, text) => this.addLog({level: 'error', text})}, Socket);
  }

  on(topic, listener) {
    if (!this.listeners.has(topic)) this.listeners.set(topic, []);
    this.listeners.get(topic).push(listener);
  }
  tell(topic, value) {
    for (const listener of this.listeners.get(topic) ?? []) listener(value);
  }

  opened() {
    ++this.counts.connections;
    this.latencies.forget();
    this.trips.clear();
    this.gate.restart();
  }
  closed() {
    if (this.state !== 'ended') this.state = 'lost';
    this.tell('connection', this.state);
  }

  heard(message) {
    if ('hello' in message) {
      this.hello = message.hello;
      this.state = 'connected';
      this.tell('connection', this.state);
    }
    if ('scene' in message) this.tell('scene', this.scene = message.scene);
    if ('status' in message) this.tell('status', this.status = message.status);
    if ('events' in message) {
      this.events.push(...message.events);
      this.events.splice(0, Math.max(0, this.events.length - kMostEvents));
      this.tell('events', message.events);
    }
    if ('log' in message) this.addLog(message.log);
    if ('bye' in message) this.state = 'ended';
  }
  addLog(line) {
    this.log.push(line);
    this.tell('log', line);
  }

  /// What the status says of an instrument.
  instrument(name) { return this.status?.instruments.find((one) => one.name === name); }

  /// Asks for parts of a pose; `time` is when the user's input happened.
  lead(name, wish, time = performance.now()) {
    const n = this.connection.post('instrument', {name, ...wish});
    if (!n || this.status?.is_paused) return;
    this.latencies.sent(n, time);
    this.trips.sent(n, time, performance.now());
  }
  follow(name) { this.connection.post('instrument', {name, follow: true}); }
  takeModel(name, model) { this.connection.post('membrane', {name, model}); }
  view(wish) { this.connection.post('view', wish); }
  operation(what, more = {}) { return this.connection.ask('operation', {do: what, ...more}); }

  frame(buffer) {
    const frame = parseFrame(buffer);
    if (!frame) return;
    ++this.counts.frames;
    frame.connection = this.counts.connections;
    frame.came = performance.now();
    this.tell('frame', frame);
  }
  /// A picture is decoded: whether it is to be shown.
  passes(frame) {
    frame.decoded = performance.now();
    if (frame.connection !== this.counts.connections) return false;
    this.connection.ack(frame.frame);
    const passes = this.gate.pass(frame);
    if (!passes) ++this.counts.stale;
    return passes;
  }
  /// Milliseconds from input to the screen, and of the parts of that time: percentiles since the last
  /// `clear`.
  latency(clear = false) {
    const of = (ms) => ({count: ms.length, median: this.latencies.percentile(0.5, ms), p95: this.latencies.percentile(0.95, ms),
                         max: this.latencies.percentile(1, ms)});
    const all = {...of(this.latencies.ms), parts: Object.fromEntries(Object.entries(this.trips.ms).map(([part, ms]) => [part, of(ms)]))};
    if (clear) {
      this.latencies.ms = [];
      this.trips.clear();
    }
    return all;
  }
  /// The screen shows a frame.
  pictured(frame) {
    ++this.counts.shown;
    const now = performance.now();
    this.latencies.shown(frame.event, now);
    this.trips.shown(frame, now);
    this.tell('shown', frame);
  }
}
