// Lines drawn by a pointer: fewer points (Ramer 1972, Douglas and Peucker 1973), and their length.

function offLine([x, y], [x0, y0], [x1, y1]) {
  const long = Math.hypot(x1 - x0, y1 - y0);
  if (long === 0) return Math.hypot(x - x0, y - y0);
  return Math.abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / long;
}

/// The points without those that lie within `tolerance` pixels of the line through the others.
export function simplified(points, tolerance) {
  if (points.length < 3) return points;
  const [first, last] = [points[0], points[points.length - 1]];
  let far = 0, index = 0;
  for (let i = 1; i + 1 < points.length; ++i) {
    const off = offLine(points[i], first, last);
    if (off > far) [far, index] = [off, i];
  }
  if (far <= tolerance) return [first, last];
  return [...simplified(points.slice(0, index + 1), tolerance).slice(0, -1),
          ...simplified(points.slice(index), tolerance)];
}

export function strokeLength(points) {
  return points.slice(1).reduce(
    (sum, [x, y], i) => sum + Math.hypot(x - points[i][0], y - points[i][1]), 0);
}
