// What the page knows of the session: the server's last words, and what was sent. Panels and views
// listen to topics: 'connection', 'scene', 'opened' (another volume), 'progress', 'log', 'shown'.

import {Connection} from './connection.js';
import {FrameGate, Latencies, kViews, parseFrame} from './frames.js';
import {Geometry} from './geometry.js';
import {cameraKeys} from './camera.js';

const kLogLines = 500;
/// Events that always lead to another picture, whose time is measured.
const kSeen = ['camera', 'look', 'clip', 'drag'];

export class Session {
  constructor(address, token, Socket) {
    this.listeners = new Map();
    this.hello = null;
    this.scene = null;
    this.geometry = null;
    this.progress = null;
    this.log = [];
    this.state = 'connecting';  // connected, lost, ended
    this.lastSent = 0;
    this.lastCarriedOut = 0;
    this.waitsSince = 0;  // for the next event to be carried out
    this.counts = {frames: 0, stale: 0, connections: 0, restarts: 0};
    this.latencies = new Latencies();
    this.timedView = '3d';  // whose pictures end an event's time
    this.gates = Object.fromEntries(kViews.map((view) => [view, new FrameGate()]));
    this.restGates = Object.fromEntries(kViews.map((view) => [view, new FrameGate()]));
    this.cameras = [];  // {n, camera} that were sent and that no frame shows yet
    this.own = null;    // the last of them, until the scene has it
    this.seen = null;   // the one of the frame that is shown, if it is one of them
    this.connection = new Connection(address, token, {
      opened: () => this.opened(), closed: () => this.closed(),
      text: (message) => this.heard(message), binary: (buffer) => this.frame(buffer),
      failed: (n, error) => this.refused(n, error)}, Socket);
  }

  on(topic, listener) {
    if (!this.listeners.has(topic)) this.listeners.set(topic, []);
    this.listeners.get(topic).push(listener);
  }
  tell(topic, value) {
    for (const listener of this.listeners.get(topic) ?? []) listener(value);
  }

  carriedOut(n) {
    if (n > this.lastCarriedOut) this.waitsSince = performance.now();
    this.lastCarriedOut = Math.max(this.lastCarriedOut, n);
  }
  sent(n) {
    if (this.lastSent <= this.lastCarriedOut) this.waitsSince = performance.now();
    this.lastSent = n;
  }
  /// For how long nothing has come of what was sent.
  waitsMs() {
    const waits = this.state === 'connected' && this.lastSent > this.lastCarriedOut;
    return waits ? performance.now() - this.waitsSince : 0;
  }

  /// An event that the server does not take has been dealt with.
  refused(n, text) {
    this.carriedOut(n);
    this.addLog({level: 'error', text, n});
  }

  opened() {
    ++this.counts.connections;
    this.lastSent = this.lastCarriedOut = 0;
    this.cameras = [];
    this.own = this.seen = null;
    this.latencies.forget();
    for (const gate of [...Object.values(this.gates), ...Object.values(this.restGates)]) gate.restart();
  }

  closed() {
    if (this.state !== 'ended') this.state = 'lost';
    this.tell('connection', this.state);
  }

  heard(message) {
    if ('hello' in message) this.greeted(message.hello);
    if ('scene' in message) this.sceneChanged(message.scene);
    if ('progress' in message) {
      this.progress = message.progress;
      this.tell('progress', this.progress);
    }
    if ('log' in message) this.addLog(message.log);
    if ('bye' in message) {
      this.state = 'ended';
      this.addLog({level: 'note', text: 'the server ends: ' + message.bye.reason});
    }
  }

  greeted(hello) {
    const restarted = this.hello && this.hello.session !== hello.session;
    this.hello = hello;
    this.state = 'connected';
    if (restarted) {
      ++this.counts.restarts;
      this.addLog({level: 'warning', text: 'the server was started again: what was not saved is gone'});
    }
    this.tell('connection', restarted ? 'restarted' : 'connected');
  }

  sceneChanged(scene) {
    const before = this.scene;
    this.scene = scene;
    if (scene) this.carriedOut(scene.event ?? 0);
    this.adoptCamera();
    const other = JSON.stringify(scene?.volume ?? null) !== JSON.stringify(before?.volume ?? null);
    if (other) {
      this.geometry = scene ? new Geometry(scene.volume) : null;
      this.tell('opened', scene);
    }
    for (const text of (scene?.warnings ?? []).filter((w) => other || !before?.warnings?.includes(w))) {
      this.addLog({level: 'warning', text});
    }
    this.tell('scene', scene);
  }

  addLog(line) {
    const last = this.log[this.log.length - 1];
    if (last && last.text === line.text && last.level === line.level) {
      last.times = (last.times ?? 1) + 1;
    } else {
      this.log.push({...line, time: new Date()});
      if (this.log.length > kLogLines) this.log.shift();
    }
    this.tell('log', line);
  }

  /// One event of a journal; `time` is when the user's input happened. Its number, 0 unsent.
  event(event, time = performance.now()) {
    const n = this.connection.post('event', event);
    if (!n) return 0;
    this.sent(n);
    if (kSeen.includes(event.kind)) this.latencies.sent(n, time);
    return n;
  }

  /// The same, with an answer as soon as it is queued.
  askEvent(event) {
    const answer = this.connection.ask('event', event);
    this.sent(this.connection.n);
    return answer;
  }

  /// A verb whose error goes to the log, for what needs no answer.
  post(verb, value) { return this.connection.post(verb, value); }
  ask(verb, value) { return this.connection.ask(verb, value); }

  /// The camera as it will be seen: the last one sent, until the scene has it.
  camera() { return this.own?.camera ?? this.scene?.view.camera ?? null; }
  /// The camera of the picture that is seen now.
  shownCamera() { return this.seen?.camera ?? this.scene?.view.camera ?? null; }
  turnCamera(camera, time) { return this.setCamera(cameraKeys(camera), time); }
  /// The keys of a camera, as they are.
  setCamera(keys, time) {
    const n = this.event({kind: 'camera', camera: keys}, time);
    if (n) this.cameras.push(this.own = {n, camera: keys});
    return n;
  }

  frame(buffer) {
    const frame = parseFrame(buffer);
    if (!frame) return;
    ++this.counts.frames;
    frame.connection = this.counts.connections;
    this.tell('frame', frame);
  }

  /// A picture is decoded: whether it is to be shown.
  passes(frame) {
    // Another connection counts anew; what it has not sent says nothing.
    if (frame.connection !== this.counts.connections) return false;
    this.connection.ack(frame.frame);
    const passes = (frame.isAtRest ? this.restGates : this.gates)[frame.view].pass(frame);
    if (!passes) ++this.counts.stale;
    if (passes && frame.view === '3d' && !frame.isAtRest) this.followCamera(frame.event);
    return passes;
  }

  /// The screen shows a frame.
  pictured(view, frame) {
    if (view === this.timedView) this.latencies.shown(frame.event, performance.now());
    this.tell('shown', frame);
  }

  followCamera(event) {
    while (this.cameras.length && this.cameras[0].n <= event) this.seen = this.cameras.shift();
  }

  adoptCamera() {
    if (this.own && this.lastCarriedOut >= this.own.n) this.own = null;
    if (!this.cameras.length && !this.own) this.seen = null;
  }
}
