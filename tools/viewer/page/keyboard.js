// Keys to actions, and the list of all bindings.

import {actionOf, kBindings, kGestures, shownKey} from './bindings.js';
import {button, element} from './elements.js';

/// Where typing is meant for a field, only keys with Ctrl and function keys are ours.
function isTyping(event) {
  const {target} = event;
  const fields = target.closest?.('input:not([type=checkbox], [type=range], [type=color]), select, textarea, [contenteditable]');
  return Boolean(fields) && !event.ctrlKey && !event.metaKey && !/^F\d+$/.test(event.key);
}

/// Enter and Space press what has the focus; arrows move it within.
function isForControl(event) {
  const control = event.target.closest?.('button, summary, input, [role=tab], [role=menuitem], [role=listbox]');
  if (!control) return false;
  return ['Enter', ' ', 'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'PageUp', 'PageDown', 'Home', 'End'].includes(event.key) &&
    !event.ctrlKey;
}

export function listenToKeys(app) {
  document.addEventListener('keydown', (event) => {
    if (document.querySelector('dialog[open]') || event.defaultPrevented) return;
    if (isTyping(event) || isForControl(event)) return;
    const typingUndo = event.target.matches?.('input[type=text], input[type=number]') && /^[zy]$/i.test(event.key);
    if (typingUndo) return;
    const view = app.viewForTools();
    const own = document.activeElement?.closest?.('.view') || app.hovered ? [view.name === '3d' ? 'space' : 'slice'] : [];
    const action = actionOf(event, [...app.tools.scopes, ...own, 'any']);
    if (action && app.act(action, event)) event.preventDefault();
  });
}

export class Help {
  constructor() {
    const groups = [...new Set(kBindings.map(({group}) => group))];
    const rows = (group) => kBindings.filter((b) => b.group === group).map(({keys, text}) => element('tr', {},
      element('td', {}, ...keys.flatMap((key, i) => [i ? ' ' : '', element('kbd', {}, shownKey(key))])), element('td', {}, text)));
    const table = (title, body) => element('table', {}, element('caption', {}, title), element('tbody', {}, ...body));
    this.dialog = element('dialog', {class: 'dialog help', 'aria-label': 'Keys, mouse and touch'},
      element('div', {class: 'row'}, element('h2', {}, 'Keys, mouse and touch'), button('Close', () => this.dialog.close(), {class: 'end'})),
      element('div', {class: 'columns'}, ...groups.map((group) => table(group, rows(group))),
        table('Mouse and touch', kGestures.map(([what, text]) => element('tr', {}, element('td', {}, what), element('td', {}, text))))));
    document.body.append(this.dialog);
    this.dialog.addEventListener('keydown', (event) => {
      if (event.key === 'h' || event.key === '?') this.dialog.close();
    });
  }
  show() { this.dialog.showModal(); }
}
