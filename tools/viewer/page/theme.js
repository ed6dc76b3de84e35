// Dark or light, as the browser's user or the system wants it; kept for the next time.

const kTheme = 'supple.theme';

/// `chooser` is a list of themes, the first one that of the system.
export function makeTheme(chooser) {
  const apply = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
  };
  let stored = '';
  try {
    stored = localStorage.getItem(kTheme) ?? '';
  } catch { /* then the system's */ }
  chooser.value = stored;
  apply(stored);
  chooser.addEventListener('change', () => {
    apply(chooser.value);
    try {
      localStorage.setItem(kTheme, chooser.value);
    } catch { /* until the page is closed */ }
  });
}
