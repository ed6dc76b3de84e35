// Elements of the page in one line each, and fields with labels.

/// `attributes`: on… listeners, properties such as value or checked, everything else an attribute.
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else if (['value', 'checked', 'disabled', 'textContent', 'selected', 'open'].includes(key)) made[key] = value;
    else made.setAttribute(key, value === true ? '' : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

const kSvg = 'http://www.w3.org/2000/svg';
export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS(kSvg, tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) made.setAttribute(key, value);
  }
  made.append(...children.flat());
  return made;
}

export function button(text, onclick, attributes = {}) {
  return element('button', {type: 'button', onclick, ...attributes}, text);
}

let made = 0;
/// A label and its control side by side; `control` gets the id that the label names.
export function field(text, control, unit, help) {
  control.id ||= 'field-' + ++made;
  return element('div', {class: 'field', title: help},
                 element('label', {for: control.id}, text),
                 element('span', {class: 'control'}, control, unit ? element('span', {class: 'unit'}, unit) : null));
}

export function select(choices, value, onchange, attributes = {}) {
  const list = element('select', {onchange: () => onchange(list.value), ...attributes});
  choose(list, choices, value);
  return list;
}

/// Other choices in a list, each a name or [name, text].
export function choose(list, choices, value) {
  list.replaceChildren(...choices.map((choice) => {
    const [name, text] = Array.isArray(choice) ? choice : [choice, choice];
    return element('option', {value: name, selected: name === value}, text);
  }));
  if (value !== undefined) list.value = value;
}

/// A number that is told when it is whole and within its bounds; arrow keys tell at once.
export function number(value, onchange, attributes = {}) {
  const input = element('input', {
    type: 'number', step: 'any', value, inputmode: 'decimal', ...attributes,
    onchange: () => {
      if (input.value !== '' && input.checkValidity()) onchange(input.valueAsNumber);
      else input.reportValidity();
    }});
  return input;
}

export function checkbox(text, checked, onchange, attributes = {}) {
  const box = element('input', {type: 'checkbox', checked, onchange: () => onchange(box.checked), ...attributes});
  return element('label', {class: 'check'}, box, text);
}

/// Writes into a field unless the user is at it.
export function show(input, value) {
  if (document.activeElement !== input) input.value = value;
}

/// A part of a panel that opens and closes.
export function section(title, open, ...children) {
  return element('details', {class: 'section', open}, element('summary', {}, element('h2', {}, title)),
                 element('div', {class: 'content'}, ...children));
}

/// A byte count as people read it.
export function bytesText(bytes) {
  const units = ['bytes', 'KiB', 'MiB', 'GiB', 'TiB'];
  let unit = 0;
  while (bytes >= 1024 && unit < units.length - 1) {
    bytes /= 1024;
    ++unit;
  }
  return (unit ? bytes.toPrecision(3) : bytes) + ' ' + units[unit];
}

/// A number of few digits.
export function short(value, digits = 4) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : '–';
}

/// Which finite elements are under the hand, the error that is left and the force at the handle.
export function leadText({level, done, edge_voxels: edge, error_mm: error, force_n: force}) {
  if (level < 0) return 'ChainMail, until finite elements are there';
  const size = edge > 1 ? `finite elements of ${edge} voxels` : 'finite elements';
  const left = done ? 'solved' : error === undefined ? 'error not known yet' : `${short(error, 2)} mm left`;
  return `${size}, ${left}, ${short(force, 3)} N`;
}
