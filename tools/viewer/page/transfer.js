// Transfer functions as their files hold them (docs/pictures.md, "Looks"): `opacity` is a list of
// [density, opacity], `colour` one of [density, red, green, blue], linear between key points and
// constant beyond. Every function gives a new transfer function; key points stay in order.

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const kLeastGap = 1e-3;  // densities of neighbours differ by more, so that curves stay functions

/// The values of a list at a density.
export function at(points, density) {
  if (!(density > points[0][0])) return points[0].slice(1);
  for (let i = 1; i < points.length; ++i) {
    const [a, ...from] = points[i - 1];
    const [b, ...to] = points[i];
    if (density <= b) return from.map((v, c) => v + (to[c] - v) * (density - a) / (b - a));
  }
  return points[points.length - 1].slice(1);
}

function between(points, index, density) {
  const low = index > 0 ? points[index - 1][0] + kLeastGap : -Infinity;
  const high = index + 1 < points.length ? points[index + 1][0] - kLeastGap : Infinity;
  return clamp(density, low, high);
}

function replaced(transfer, list, index, point) {
  const points = transfer[list].map((p, i) => i === index ? point : p);
  return {...transfer, [list]: points};
}

/// A point moved; it does not pass its neighbours, and its opacity stays within 0 and 1.
export function opacityMoved(transfer, index, density, opacity) {
  return replaced(transfer, 'opacity', index,
                  [between(transfer.opacity, index, density), clamp(opacity, 0, 1)]);
}

export function colourMoved(transfer, index, density) {
  const [, ...colour] = transfer.colour[index];
  return replaced(transfer, 'colour', index, [between(transfer.colour, index, density), ...colour]);
}

export function recoloured(transfer, index, [r, g, b]) {
  return replaced(transfer, 'colour', index, [transfer.colour[index][0], r, g, b]);
}

/// A point more at a density, with the given or the interpolated values; and where it now stands.
export function inserted(transfer, list, density, values = at(transfer[list], density)) {
  const points = transfer[list];
  if (points.some(([d]) => Math.abs(d - density) < kLeastGap)) return {transfer, index: -1};
  const index = points.filter(([d]) => d < density).length;
  const all = [...points.slice(0, index), [density, ...values], ...points.slice(index)];
  return {transfer: {...transfer, [list]: all}, index};
}

/// A point less; the last one stays.
export function removed(transfer, list, index) {
  if (transfer[list].length < 2) return transfer;
  return {...transfer, [list]: transfer[list].filter((_, i) => i !== index)};
}

/// All of both curves moved along the densities, as the slider "Shift" of 3D Slicer.
export function shifted(transfer, by) {
  const move = (points) => points.map(([density, ...values]) => [density + by, ...values]);
  return {...transfer, opacity: move(transfer.opacity), colour: move(transfer.colour)};
}

/// The densities that both curves span.
export function domain(transfer) {
  const all = [...transfer.opacity, ...transfer.colour].map(([d]) => d);
  return [Math.min(...all), Math.max(...all)];
}

export function hexOf([r, g, b]) {
  return '#' + [r, g, b].map((v) => Math.round(clamp(v, 0, 1) * 255).toString(16).padStart(2, '0')).join('');
}

export function rgbOf(hex) {
  return [1, 3, 5].map((i) => Math.round(parseInt(hex.slice(i, i + 2), 16) / 255 * 1e4) / 1e4);
}

/// The text of a file that `supple render --preset FILE` reads.
export function toToml(transfer) {
  const line = ([key, value]) => key + ' = ' + JSON.stringify(value);
  return Object.entries(transfer).filter(([, value]) => value !== undefined && value !== null)
    .map(line).join('\n') + '\n';
}
