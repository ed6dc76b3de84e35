// Keys and gestures of the viewer: one table, from which keys are looked up and the help is made.
// They are 3D Slicer's, with F3D's and Blender's where Slicer has none.

/// `keys` are KeyboardEvent.key with the modifiers in front; `code:` names a place on the keyboard.
/// `where` says in which views they hold, `shown` stands for `keys` in lists.
export const kBindings = [
  {group: 'Deform', action: 'grab', keys: ['g'], where: 'any', text: 'Grab the tissue under the pointer and move it in the plane of the view'},
  {group: 'Deform', action: 'axis-x', keys: ['x'], where: 'grab', text: 'While grabbing: only to the patient’s left and right'},
  {group: 'Deform', action: 'axis-y', keys: ['y'], where: 'grab', text: 'While grabbing: only to anterior and posterior'},
  {group: 'Deform', action: 'axis-z', keys: ['z'], where: 'grab', text: 'While grabbing: only to superior and inferior'},
  {group: 'Deform', action: 'turn', keys: ['r'], where: 'grab', text: 'While a bone is grabbed: turn it about its middle; X, Y, Z and a number of degrees constrain, G moves again'},
  {group: 'Deform', action: 'nudge-left', keys: ['ArrowLeft'], where: 'grab', text: 'While grabbing: 1 mm (Shift: 10 mm) to the left of the picture'},
  {group: 'Deform', action: 'nudge-right', keys: ['ArrowRight'], where: 'grab', text: 'While grabbing: to the right of the picture'},
  {group: 'Deform', action: 'nudge-up', keys: ['ArrowUp'], where: 'grab', text: 'While grabbing: up in the picture'},
  {group: 'Deform', action: 'nudge-down', keys: ['ArrowDown'], where: 'grab', text: 'While grabbing: down in the picture'},
  {group: 'Deform', action: 'larger', keys: ['PageUp', ']'], where: 'grab', text: 'While grabbing: a larger handle (also the wheel)'},
  {group: 'Deform', action: 'smaller', keys: ['PageDown', '['], where: 'grab', text: 'While grabbing: a smaller handle'},
  {group: 'Deform', action: 'type', keys: ['0', '1', '2', '3', '4', '5', '6', '7', '8', '9', '.', ',', '-', 'Backspace'], where: 'grab',
   shown: ['0 … 9', '.', '-', 'Backspace'], text: 'While grabbing: so many mm along the axis, or the way that was led: G X 5 Enter'},
  {group: 'Deform', action: 'keep', keys: ['Enter'], where: 'tool', text: 'Keep what was moved; end the line of a cut'},
  {group: 'Deform', action: 'cancel', keys: ['Escape'], where: 'tool', text: 'Cancel, and restore what was'},
  {group: 'Deform', action: 'anchor', keys: ['a'], where: 'any', text: 'Fix the tissue under the pointer, within the radius of a handle'},
  {group: 'Deform', action: 'brush-larger', keys: [']'], where: 'any', text: 'A larger radius of handles and anchors'},
  {group: 'Deform', action: 'brush-smaller', keys: ['['], where: 'any', text: 'A smaller radius'},
  {group: 'Deform', action: 'cut', keys: ['k'], where: 'any', text: 'Cut along a line that is drawn: drag, or click point by point and press Enter'},
  {group: 'Deform', action: 'relax', keys: ['e'], where: 'any', text: 'Relax the body elastically'},
  {group: 'Deform', action: 'let-go', keys: ['Shift+A'], where: 'any', text: 'Let go of everything that is held or fixed'},
  {group: 'Deform', action: 'undo', keys: ['Ctrl+z'], where: 'any', text: 'Take the last step back'},
  {group: 'Deform', action: 'redo', keys: ['Ctrl+Shift+Z', 'Ctrl+y'], where: 'any', text: 'Make it again'},

  {group: 'Look', action: 'deformed', keys: [' '], where: 'any', text: 'Deformed or undeformed'},
  {group: 'Look', action: 'curtain', keys: ['c'], where: 'any', text: 'A curtain between the body at rest and deformed, or none'},
  {group: 'Look', action: 'blink', keys: ['v'], where: 'any', text: 'Blink: at rest and deformed in turn (Esc ends)'},
  {group: 'Look', action: 'clip-plane', keys: ['p'], where: 'any', text: 'A clip plane at the cross-hair, towards the viewer; arrow keys lead it, Delete takes it away'},
  {group: 'Look', action: 'clip-box', keys: ['Shift+P'], where: 'any', text: 'A clip box around the volume, whose faces are led inwards'},
  {group: 'Look', action: 'reset-view', keys: ['r', '0'], where: 'any', text: 'Reset the view; a turned slice is straight again'},
  {group: 'Look', action: 'side-anterior', keys: ['1'], where: 'any', text: 'From anterior (Shift: from posterior)'},
  {group: 'Look', action: 'side-left', keys: ['3'], where: 'any', text: 'From left (Shift: from right)'},
  {group: 'Look', action: 'side-superior', keys: ['7'], where: 'any', text: 'From superior (Shift: from inferior)'},
  {group: 'Look', action: 'side-posterior', keys: ['Shift+code:Digit1', 'Shift+code:Numpad1'], where: 'any', text: 'From posterior'},
  {group: 'Look', action: 'side-right', keys: ['Shift+code:Digit3', 'Shift+code:Numpad3'], where: 'any', text: 'From right'},
  {group: 'Look', action: 'side-inferior', keys: ['Shift+code:Digit7', 'Shift+code:Numpad7'], where: 'any', text: 'From inferior'},
  {group: 'Look', action: 'projection', keys: ['5'], where: 'any', text: 'Perspective or orthographic'},
  {group: 'Look', action: 'maximise', keys: ['Ctrl+Enter'], where: 'any', text: 'Maximise the view, or show all four (also double click)'},
  {group: 'Look', action: 'measure', keys: ['m'], where: 'any', text: 'Measure a distance: drag, or click twice'},
  {group: 'Look', action: 'angle', keys: ['n'], where: 'any', text: 'Measure an angle: three clicks, its corner second'},
  {group: 'Look', action: 'clear-measures', keys: ['Shift+M'], where: 'any', text: 'Take all measures away'},

  {group: 'View in space', action: 'turn-left', keys: ['ArrowLeft'], where: 'space', text: 'Turn to the left by 5 degrees'},
  {group: 'View in space', action: 'turn-right', keys: ['ArrowRight'], where: 'space', text: 'Turn to the right'},
  {group: 'View in space', action: 'turn-up', keys: ['ArrowUp'], where: 'space', text: 'Turn up'},
  {group: 'View in space', action: 'turn-down', keys: ['ArrowDown'], where: 'space', text: 'Turn down'},
  {group: 'View in space', action: 'pan-left', keys: ['Shift+ArrowLeft'], where: 'space', text: 'Move to the left'},
  {group: 'View in space', action: 'pan-right', keys: ['Shift+ArrowRight'], where: 'space', text: 'Move to the right'},
  {group: 'View in space', action: 'pan-up', keys: ['Shift+ArrowUp'], where: 'space', text: 'Move up'},
  {group: 'View in space', action: 'pan-down', keys: ['Shift+ArrowDown'], where: 'space', text: 'Move down'},
  {group: 'View in space', action: 'roll-left', keys: ['Ctrl+ArrowLeft'], where: 'space', text: 'Roll counterclockwise'},
  {group: 'View in space', action: 'roll-right', keys: ['Ctrl+ArrowRight'], where: 'space', text: 'Roll clockwise'},
  {group: 'View in space', action: 'zoom-in', keys: ['+', '='], where: 'any', text: 'Nearer'},
  {group: 'View in space', action: 'zoom-out', keys: ['-'], where: 'any', text: 'Further away'},

  {group: 'Slices', action: 'slice-next', keys: ['ArrowUp', 'ArrowRight', 'f', 'PageUp'], where: 'slice', text: 'Next slice'},
  {group: 'Slices', action: 'slice-previous', keys: ['ArrowDown', 'ArrowLeft', 'b', 'PageDown'], where: 'slice', text: 'Previous slice'},
  {group: 'Slices', action: 'crosshair-left', keys: ['Shift+ArrowLeft'], where: 'slice', text: 'Crosshair to the left by a voxel'},
  {group: 'Slices', action: 'crosshair-right', keys: ['Shift+ArrowRight'], where: 'slice', text: 'Crosshair to the right'},
  {group: 'Slices', action: 'crosshair-up', keys: ['Shift+ArrowUp'], where: 'slice', text: 'Crosshair up'},
  {group: 'Slices', action: 'crosshair-down', keys: ['Shift+ArrowDown'], where: 'slice', text: 'Crosshair down'},
  {group: 'Slices', action: 'window-level', keys: ['w'], where: 'any', text: 'Window and level by left drag, on or off'},

  {group: 'Program', action: 'open', keys: ['Ctrl+o'], where: 'any', text: 'Open a volume, state or scene'},
  {group: 'Program', action: 'save-state', keys: ['Ctrl+s'], where: 'any', text: 'Save the state'},
  {group: 'Program', action: 'screenshot', keys: ['F12'], where: 'any', text: 'Save a picture of the view'},
  {group: 'Program', action: 'link', keys: ['l'], where: 'any', text: 'A link to this view, into the clipboard and the address'},
  {group: 'Program', action: 'next-view', keys: ['F6'], where: 'any', text: 'Next view or panel'},
  {group: 'Program', action: 'help', keys: ['h', '?'], where: 'any', text: 'This list'},
];

/// What mice and fingers do, for the help.
export const kGestures = [
  ['Space: left drag, arrows', 'Rotate'],
  ['Space: Shift + left drag, or middle drag', 'Move'],
  ['Space: right drag, wheel', 'Zoom'],
  ['Space: Ctrl + left drag', 'Roll'],
  ['Slices: wheel', 'Next or previous slice'],
  ['Slices: left click or drag, Shift + move', 'Crosshair'],
  ['Slices: drag a dot of a line', 'Turn the slice that the line stands for'],
  ['Slices: right drag, Ctrl + wheel', 'Zoom'],
  ['Slices: Shift + left drag, or middle drag', 'Move'],
  ['Space: drag a ring or dot of a clip', 'Shift and turn the plane, or shift the face of the box'],
  ['All views: double click, double tap', 'Maximise, or show all four'],
  ['Touch: one finger', 'Rotate; in slices the crosshair'],
  ['Touch: two fingers', 'Move and zoom'],
  ['Touch: long press, then drag', 'Grab'],
  ['Grab: click on a bone', 'Take it: rings turn it, the dot moves it, a click beside them keeps it'],
  ['While grabbing: wheel', 'Size of the handle'],
  ['While grabbing: right click', 'Cancel, and restore what was'],
];

/// The names by which a key event may be bound, most precise first.
export function namesOf(event) {
  let prefix = '';
  if (event.ctrlKey || event.metaKey) prefix += 'Ctrl+';
  if (event.altKey) prefix += 'Alt+';
  const shift = event.shiftKey ? 'Shift+' : '';
  const letter = event.key.length === 1 && event.key.toLowerCase() !== event.key.toUpperCase();
  const key = letter ? (event.shiftKey ? event.key.toUpperCase() : event.key.toLowerCase()) : event.key;
  const names = [prefix + shift + 'code:' + event.code, prefix + shift + key];
  // Signs such as ? and + need Shift on many keyboards.
  if (event.shiftKey && event.key.length === 1 && !letter) names.push(prefix + key);
  return names;
}

/// The action of a key event where `scopes` lists what holds, first the most special one:
/// 'grab' and 'tool' while a tool is at work, then 'space' or 'slice', then 'any'.
export function actionOf(event, scopes) {
  const names = namesOf(event);
  for (const scope of scopes) {
    for (const name of names) {
      const found = kBindings.find((b) => b.where === scope && b.keys.includes(name));
      if (found) return found.action;
    }
  }
  return null;
}

const kShown = {' ': 'Space', ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓',
                Escape: 'Esc', PageUp: 'Page up', PageDown: 'Page down'};

/// The keys of a binding as lists show them.
export const shownKeys = ({keys, shown}) => [...new Set((shown ?? keys).map(shownKey))];

/// A key as the help writes it.
export function shownKey(key) {
  return key.replace(/code:(Digit|Numpad)/, '').split(/\+(?=.)/)
    .map((part) => kShown[part] ?? (part.length === 1 ? part.toUpperCase() : part)).join(' + ');
}
