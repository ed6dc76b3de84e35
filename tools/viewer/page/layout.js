// Four views or one, and the panel beside them.

import {iconButton} from './icons.js';

export class Layout {
  constructor(app, root) {
    Object.assign(this, {app, root, maximised: null});
  }

  button(view) {
    const name = view.title;
    return iconButton('maximise', `Maximise ${name}`, () => this.toggle(view.name), {
      class: 'maximise', 'aria-pressed': 'false', title: 'Maximise (double click, Ctrl+Enter)'});
  }

  toggle(name) { this.maximise(this.maximised === name ? null : name); }
  maximise(name) {
    this.maximised = name;
    for (const view of this.app.views) {
      view.root.hidden = name !== null && view.name !== name;
      view.root.querySelector('.maximise').setAttribute('aria-pressed', String(view.name === name));
    }
    this.root.classList.toggle('single', name !== null);
    this.app.sizesChanged();
    if (name) this.app.view(name).picture.focus({preventScroll: true});
  }

  /// F6: the views that are seen, then the panel, and round again.
  next() {
    const stops = [...this.app.views.filter((view) => view.isVisible).map((view) => view.picture),
                   document.querySelector('#panel [role=tab][aria-selected=true]')];
    const at = stops.findIndex((stop) => stop.contains(document.activeElement));
    const inPanel = document.getElementById('panel').contains(document.activeElement);
    stops[((inPanel ? stops.length - 1 : at) + 1) % stops.length].focus();
  }
}

/// Tabs of the panel, one of them seen; arrow keys go from one to the next.
export function makeTabs(list) {
  const tabs = [...list.querySelectorAll('[role=tab]')];
  const choose = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute('aria-selected', String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      document.getElementById(tab.getAttribute('aria-controls')).hidden = tab !== chosen;
    }
  };
  for (const [i, tab] of tabs.entries()) {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', (event) => {
      const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
      if (!step) return;
      const next = tabs[(i + step + tabs.length) % tabs.length];
      choose(next);
      next.focus();
      event.stopPropagation();
    });
  }
  choose(tabs[0]);
  return (id) => choose(tabs.find((tab) => tab.getAttribute('aria-controls') === id));
}
