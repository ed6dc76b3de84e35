// Beside the picture: instruments, tasks, tissue, scores and what has happened.

import {button, element, field, select, short, show} from '../elements.js';

const kMostShown = 40;

/// Events that a person is told of, and those that are alarms.
const kTexts = {
  touch: ({instrument, at}) => `${instrument} touches ${at}`,
  touch_ended: ({instrument, at, value}) => `${instrument} has left ${at}, at most ${forceText(value)}`,
  bleeding: ({at}) => `${at} bleeds`,
  gripped: ({at}) => `${at} gripped`, released: ({at}) => `${at} released`,
  edge_torn: ({at}) => `${at} tears`, piece_lost: ({at}) => `a piece of ${at} came off`,
};
const kAlarms = ['touch', 'bleeding'];
const kModels = {springs: 'Springs', ecm: 'ChainMail'};

export const forceText = (newton) => `${short(newton * 1000, 2)} mN`;
export const eventText = (event) => kTexts[event.kind]?.(event) ?? null;
export const isAlarm = ({kind, at}) => kAlarms.includes(kind) && (at === 'retina' || at === 'lens');

const fact = (name, value) => [element('dt', {}, name), element('dd', {}, value)];

export class OperationPanel {
  constructor(app) {
    this.app = app;
    for (const id of ['instruments', 'tasks', 'tissue', 'models', 'scores', 'events']) this[id] = document.getElementById(id);
    app.session.on('scene', (scene) => this.makeInstruments(scene));
    app.session.on('scene', (scene) => this.makeModels(scene));
    app.session.on('status', (status) => this.show(status));
    app.session.on('events', (events) => this.addEvents(events));
  }

  makeInstruments(scene) {
    this.rows = (scene?.instruments ?? []).map(({name, kind}, n) => {
      const note = element('span', {class: 'note'});
      const row = button('', () => this.app.choose(n), {'aria-pressed': 'false', title: `${kind}, key ${n + 1}`});
      row.append(element('kbd', {}, String(n + 1)), element('span', {}, name), note);
      return {row, note};
    });
    this.instruments.replaceChildren(...this.rows.map(({row}) => row));
  }

  /// Chooses the model of each membrane.
  makeModels(scene) {
    this.choices = (scene?.membranes ?? []).map((name) => select(
      Object.entries(kModels), 'springs', (model) => this.app.session.takeModel(name, model), {title: 'Model that moves it (M)'}));
    this.models.replaceChildren(...this.choices.map((choice, n) => field(`Model of ${scene.membranes[n]}`, choice)));
  }

  show(status) {
    status.membranes.forEach(({model}, n) => this.choices?.[n] && show(this.choices[n], model));
    status.instruments.forEach(({is_led: isLed, force_n: force}, n) => {
      const {row, note} = this.rows?.[n] ?? {};
      if (!row) return;
      row.setAttribute('aria-pressed', String(n === this.app.chosen));
      note.textContent = (isLed ? 'by hand' : 'by track') + (force > 0 ? `, ${forceText(force)}` : '');
    });
    this.showTissue(status);
    this.showScore(status.score);
  }
  showTissue({clinging_mm2: clinging, vitreous_left: left, bleedings_mm: spots}) {
    const {membranes = [], has_vitreous: hasVitreous} = this.app.session.scene ?? {};
    this.tissue.replaceChildren(
      ...(membranes.length ? fact('Membrane still clings', `${short(clinging, 3)} mm²`) : []),
      ...(hasVitreous ? fact('Vitreous left', `${Math.round(left * 100)} %`) : []),
      ...fact('Bleedings', String(spots.length)));
  }
  showScore({total, categories, tasks}) {
    document.getElementById('tasks-part').hidden = !tasks.length;
    document.getElementById('scores-part').hidden = !Object.keys(categories).length;
    this.tasks.replaceChildren(...tasks.map(({name, progress, done_s: done}) => element('div', {class: 'task'},
      element('div', {}, name, done === undefined ? '' : `, done after ${short(done, 3)} s`),
      element('progress', {max: 1, value: progress, 'aria-label': name}))));
    this.scores.replaceChildren(
      ...Object.values(categories).flatMap(({title, points}) => fact(title, String(Math.round(points)))),
      ...fact('Total', String(Math.round(total))));
  }

  addEvents(events) {
    for (const event of events) {
      const text = eventText(event);
      if (!text) continue;
      this.events.prepend(element('li', {class: isAlarm(event) ? 'warning' : null},
                                  element('time', {}, event.time_s.toFixed(1)), text));
      if (this.events.children.length > kMostShown) this.events.lastChild.remove();
      this.app.tellEvent(event, text);
    }
  }
}
