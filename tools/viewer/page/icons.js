// Signs of buttons, drawn on a square of 16.

import {button, svg} from './elements.js';

const kPaths = {
  'maximise': 'M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10',
  'fit': 'M8 1.5v4M8 10.5v4M1.5 8h4M10.5 8h4M6.5 4 8 5.5 9.5 4M6.5 12 8 10.5 9.5 12M4 6.5 5.5 8 4 9.5M12 6.5 10.5 8l1.5 1.5',
  'curtain': 'M2 3h12v10H2ZM8 1.500v13M5.500 6 3.500 8l2 2M10.500 6l2 2-2 2',
  'remove': 'M4 4l8 8M12 4l-8 8',
  'none': 'M8 1.5v13M1.5 8h13M8 1.5 6.5 3.5M8 1.5l1.5 2M8 14.5l-1.5-2M8 14.5l1.5-2M1.5 8l2-1.5M1.5 8l2 1.5M14.5 8l-2-1.5M14.5 8l-2 1.5',
  'grab': 'M5 8V4a1 1 0 0 1 2 0v3-4.500a1 1 0 0 1 2 0V7 3.500a1 1 0 0 1 2 0V8 5.500a1 1 0 0 1 2 0V10q0 4.500-4.500 4.500Q6 14.500 4.800 12L3 9q-.4-1.300.6-1.500T5 8.600Z',
  'anchor': 'M8 5v9.500M5 7.500h6M2.500 9.500Q3 14.500 8 14.500t5.500-5M8 1.500a1.750 1.750 0 1 0 .01 0Z',
  'cut': 'M2 14 12.500 2l1.500 1.500L7 11M2 14l4.500-1L7 11M5.500 10 7 11',
  'measure': 'M1.500 10.500l9-9 4 4-9 9ZM4 8l1.500 1.500M6 6l2.200 2.200M8 4l1.500 1.500',
  'angle': 'M2 13.500h12M2 13.500 11 2.500M7.500 13.500q0-3-2-5',
  'window-level': 'M8 1.500a6.500 6.500 0 1 0 .01 0ZM8 1.500v13M10 3v10M12 4.500v7',
};

export function iconButton(name, label, onclick, attributes = {}) {
  const made = button('', onclick, {title: label, 'aria-label': label, ...attributes});
  made.classList.add('icon');
  made.append(svg('svg', {viewBox: '0 0 16 16', 'aria-hidden': 'true'}, svg('path', {d: kPaths[name]})));
  return made;
}
