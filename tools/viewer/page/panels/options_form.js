// A form for options as the server describes them: names, bounds, defaults and texts are those of the
// command line's help.

import {checkbox, element, field, number, select} from '../elements.js';

/// Bounds from words such as "1 to 16384 pixels" or "0 or more mm".
export function boundsOf(allowed = '') {
  const range = /^(-?[\d.]+) to (-?[\d.]+)/.exec(allowed);
  if (range) return [Number(range[1]), Number(range[2])];
  const least = /^(-?[\d.]+) or more/.exec(allowed);
  return [least ? Number(least[1]) : undefined, undefined];
}

/// The form, and `values()`: those that differ from the default.
export class OptionsForm {
  constructor(options, changed = () => {}) {
    this.inputs = options.map((option) => [option, ...this.control(option, changed)]);
    this.root = element('div', {class: 'options'}, ...this.inputs.map(([option, node]) => node.classList.contains('check')
      ? node : field(option.name.replaceAll('_', ' '), node, option.unit, option.help)));
  }

  /// The element of an option and a function that reads it.
  control({type, name, choices, allowed, default: value, help}, changed) {
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
      const [min, max] = boundsOf(allowed);
      const input = number(value ?? '', changed, {min, max, step: type === 'integer' ? 1 : 'any'});
      return [input, () => input.value === '' ? undefined : input.valueAsNumber];
    }
    const text = element('input', {type: 'text', value: Array.isArray(value) ? value.join(', ') : value ?? '', onchange: changed});
    const read = () => type === 'vector' ? text.value.split(/[\s,;]+/).filter(Boolean).map(Number) : text.value;
    return [text, () => text.value.trim() === '' ? undefined : read()];
  }

  value(wanted) { return this.inputs.find(([{name}]) => name === wanted)?.[2](); }
  isValid() { return this.inputs.every(([, node]) => node.reportValidity?.() ?? true); }
  values() {
    const given = this.inputs.map(([{name, default: value}, , read]) => [name, read(), value]);
    return Object.fromEntries(given.filter(([, now, value]) => now !== undefined && JSON.stringify(now) !== JSON.stringify(value))
      .map(([name, now]) => [name, now]));
  }
}
