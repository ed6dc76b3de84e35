// A form for options as the server describes them: names, bounds, defaults and texts are those of the
// command line's help.

import {checkbox, element, field, number, select} from '../elements.js';

/// The form, and `values()`: those that differ from the default.
export class OptionsForm {
  constructor(options, changed = () => {}) {
    this.inputs = options.map((option) => [option, ...this.control(option, changed)]);
    this.root = element('div', {class: 'options'}, ...this.inputs.map(([option, node]) => node.classList.contains('check')
      ? node : field(option.name.replaceAll('_', ' '), node, option.unit, option.help)));
  }

  /// The element of an option and a function that reads it.
  control({type, name, choices, least, most, default: value, help}, changed) {
    if (type === 'bool') {
      const box = checkbox(name.replaceAll('_', ' '), value === true, changed, {});
      box.title = help ?? '';
      return [box, () => box.querySelector('input').checked];
    }
    if (type === 'choice') {
      const list = select(choices, value ?? choices[0], changed, {title: help});
      return [list, () => list.value];
    }
    if (type === 'number' || type === 'integer') {
      const input = number(value ?? '', changed, {min: least, max: most, step: type === 'integer' ? 1 : 'any'});
      return [input, () => input.value === '' ? undefined : input.valueAsNumber];
    }
    const text = element('input', {type: 'text', value: Array.isArray(value) ? value.join(', ') : value ?? '', onchange: changed});
    const read = () => type === 'vector' ? text.value.split(/[\s,;]+/).filter(Boolean).map(Number) : text.value;
    return [text, () => text.value.trim() === '' ? undefined : read()];
  }

  isValid() { return this.inputs.every(([, node]) => node.reportValidity?.() ?? true); }
  values() {
    const given = this.inputs.map(([{name, default: value}, , read]) => [name, read(), value]);
    return Object.fromEntries(given.filter(([, now, value]) => now !== undefined && JSON.stringify(now) !== JSON.stringify(value))
      .map(([name, now]) => [name, now]));
  }
}
