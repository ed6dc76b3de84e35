// Keys and mouse of an operation: one table, from which keys are looked up and the help is made.

import {namesOf, shownKeys} from '../bindings.js';
import {button, element} from '../elements.js';

export const kOperationKeys = [
  {group: 'Instrument', action: 'choose', keys: ['1', '2', '3', '4', '5', '6', '7', '8', '9'], shown: ['1 … 9'], text: 'Choose an instrument'},
  {group: 'Instrument', action: 'next', keys: ['n'], text: 'Choose the next one'},
  {group: 'Instrument', action: 'take', keys: ['Enter'], text: 'Take it; once more: keep it closed or sucking, or let it be'},
  {group: 'Instrument', action: 'let-go', keys: ['Escape', 't'], text: 'Let it go: its track leads it again'},
  {group: 'Instrument', action: 'hold', keys: [' '], text: 'Close forceps, suck, switch the lamp, as long as it is held'},
  {group: 'Instrument', action: 'left', keys: ['ArrowLeft'], text: 'Tip to the left by 0.05 mm (Shift: 0.5 mm)', move: [-1, 0, 0]},
  {group: 'Instrument', action: 'right', keys: ['ArrowRight'], text: 'Tip to the right', move: [1, 0, 0]},
  {group: 'Instrument', action: 'up', keys: ['ArrowUp'], text: 'Tip up in the picture', move: [0, -1, 0]},
  {group: 'Instrument', action: 'down', keys: ['ArrowDown'], text: 'Tip down in the picture', move: [0, 1, 0]},
  {group: 'Instrument', action: 'deeper', keys: ['PageDown'], text: 'Tip away from you', move: [0, 0, 1]},
  {group: 'Instrument', action: 'nearer', keys: ['PageUp'], text: 'Tip towards you', move: [0, 0, -1]},
  {group: 'Instrument', action: 'roll-left', keys: ['q'], text: 'Roll by 5 degrees'},
  {group: 'Instrument', action: 'roll-right', keys: ['e'], text: 'Roll the other way'},
  {group: 'Microscope', action: 'zoom-in', keys: ['+', '='], text: 'Nearer'},
  {group: 'Microscope', action: 'zoom-out', keys: ['-'], text: 'Further away'},
  {group: 'Microscope', action: 'focus-tip', keys: ['f'], text: 'Over the tip, and in focus there'},
  {group: 'Microscope', action: 'focus-deeper', keys: [']'], text: 'Focus 0.2 mm deeper'},
  {group: 'Microscope', action: 'focus-nearer', keys: ['['], text: 'Focus 0.2 mm nearer'},
  {group: 'Microscope', action: 'stereo', keys: ['v'], text: 'One picture, side by side, red and cyan'},
  {group: 'Operation', action: 'models', keys: ['m'], text: 'Exchange the model that moves membranes'},
  {group: 'Operation', action: 'pause', keys: ['p'], text: 'Pause or go on'},
  {group: 'Operation', action: 'restart', keys: ['Shift+R'], text: 'From the beginning'},
  {group: 'Operation', action: 'save', keys: ['Ctrl+s'], text: 'Save what was done, to be replayed'},
  {group: 'Operation', action: 'help', keys: ['h', '?'], text: 'This list'},
];

const kMouse = [
  ['Click', 'Take the instrument'],
  ['Move', 'Tip parallel to the picture'],
  ['Wheel, right drag', 'Tip deeper or nearer'],
  ['Shift + wheel', 'Roll'],
  ['Left button held', 'Close forceps, suck, switch the lamp'],
];

/// The binding of a key event; null where there is none. Shift only makes moves larger.
export function bindingOf(event) {
  const names = namesOf(event);
  if (event.shiftKey) names.push(event.key);
  for (const name of names) {
    const found = kOperationKeys.find(({keys}) => keys.includes(name));
    if (found && (name !== event.key || !event.shiftKey || found.move || event.key === '+' || event.key === '?')) return found;
  }
  return null;
}

export class OperationHelp {
  constructor() {
    const table = (title, rows) => element('table', {}, element('caption', {}, title), element('tbody', {}, ...rows));
    const row = (keys, text) => element('tr', {}, element('td', {}, ...keys), element('td', {}, text));
    const rows = (group) => kOperationKeys.filter((one) => one.group === group).map((one) =>
      row(shownKeys(one).flatMap((key, i) => [i ? ' ' : '', element('kbd', {}, key)]), one.text));
    const groups = [...new Set(kOperationKeys.map(({group}) => group))];
    this.dialog = element('dialog', {class: 'dialog help', 'aria-label': 'Keys and mouse'},
      element('div', {class: 'row'}, element('h2', {}, 'Keys and mouse'), button('Close', () => this.dialog.close(), {class: 'end'})),
      element('div', {class: 'columns'}, ...groups.map((group) => table(group, rows(group))),
              table('Mouse', kMouse.map(([what, text]) => row([what], text)))));
    document.body.append(this.dialog);
    this.dialog.addEventListener('keydown', (event) => {
      if (event.key === 'h' || event.key === '?') this.dialog.close();
    });
  }
  show() { this.dialog.showModal(); }
}
