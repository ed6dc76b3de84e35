// Keys to actions, and the list of all bindings.

import {actionOf, kBindings, kGestures, shownKeys} from './bindings.js';
import {button, element} from './elements.js';

const kWithin = ['Enter', ' ', 'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'PageUp', 'PageDown', 'Home', 'End'];

/// Whether a key is meant for the field or button that has the focus. A pointer over a view makes letters the
/// view's, where they are no input, and Space and Enter, where a click and not a key has led the focus.
function isForControl(event, isOverView) {
  const {key, target} = event;
  if (/^F\d+$/.test(key)) return false;
  const withCtrl = event.ctrlKey || event.metaKey;
  if (target.matches?.('input[type=text], textarea')) return !withCtrl || /^[acvxyz]$/i.test(key);
  if (target.matches?.('input[type=number]')) {
    if (withCtrl) return /^[acvxyz]$/i.test(key);
    return !(isOverView && /^[a-z]$/i.test(key) && key !== 'e');
  }
  if (withCtrl) return false;
  if (target.matches?.('select')) return !(isOverView && /^[a-z]$/i.test(key));
  const control = target.closest?.('button, summary, input, [role=tab], [role=menuitem], [role=listbox]');
  return Boolean(control) && kWithin.includes(key) && (!isOverView || target.matches(':focus-visible'));
}

/// Keys that write in a field.
const isTyping = ({key, target, ctrlKey, metaKey}) => target.matches?.('input[type=text], input[type=number], textarea') &&
  !ctrlKey && !metaKey && (key.length === 1 || ['Backspace', 'Delete', 'Tab', 'Home', 'End'].includes(key));

/// A stroke has taken the focus when it began, and owns the keys until it ends, but for what is written in a
/// field that was chosen since.
export function listenToKeys(app) {
  document.addEventListener('keydown', (event) => {
    if (document.querySelector('dialog[open]') || event.defaultPrevented) return;
    if (app.tools.stroke ? isTyping(event) : isForControl(event, app.hovered !== null)) return;
    const view = app.viewForTools();
    const own = document.activeElement?.closest?.('.view') || app.hovered ? [view.name === '3d' ? 'space' : 'slice'] : [];
    const action = actionOf(event, [...app.tools.scopes, ...own, 'any']);
    if (action && app.act(action, event)) event.preventDefault();
  });
}

export class Help {
  constructor() {
    const groups = [...new Set(kBindings.map(({group}) => group))];
    const rows = (group) => kBindings.filter((b) => b.group === group).map((binding) => element('tr', {},
      element('td', {}, ...shownKeys(binding).flatMap((key, i) => [i ? ' ' : '', element('kbd', {}, key)])), element('td', {}, binding.text)));
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
