#include "lib/mesh/tets/lattice_cuts.h"

#include <limits>

#include "lib/mesh/tets/cleaving.h"
#include "lib/mesh/tets/tet_shape.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Rounds over all vertices; what is too near after the last one is held apart.
constexpr int kMostRounds = 6;
/// The way of a vertex to a place where three labels meet, in its shortest edges.
constexpr double kJunctionReach = 0.4;

bool is_long(const Vec3i& step) {
  const int unit = std::abs(step.x);
  return unit == 0 || std::abs(step.y) != unit || std::abs(step.z) != unit;
}

/// Offsets of groups from their counts.
void add_up(std::vector<std::int32_t>& counts) {
  std::int32_t sum = 0;
  for (std::int32_t& count : counts) {
    const std::int32_t own = count;
    count = sum;
    sum += own;
  }
}

/// The shortest step after which a few linear functions are zero, by their normal equations; false
/// where they have none.
bool solve_shortest(const Vec3d* rows, const double* values, int count, Vec3d& step) {
  double a[3][4] = {};
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) a[i][j] = rows[i].dot(rows[j]);
    a[i][3] = -values[i];
  }
  for (int i = 0; i < count; ++i) {
    int pivot = i;
    for (int r = i + 1; r < count; ++r)
      pivot = std::abs(a[r][i]) > std::abs(a[pivot][i]) ? r : pivot;
    if (std::abs(a[pivot][i]) < 1e-9) return false;
    for (int c = 0; c < 4; ++c) std::swap(a[i][c], a[pivot][c]);
    for (int r = 0; r < count; ++r) {
      if (r == i) continue;
      const double factor = a[r][i] / a[i][i];
      for (int c = 0; c < 4; ++c) a[r][c] -= factor * a[i][c];
    }
  }
  step = Vec3d(0);
  for (int i = 0; i < count; ++i) step += rows[i] * (a[i][3] / a[i][i]);
  return true;
}

}  // namespace

LatticeCuts::LatticeCuts(const LabelField& field, const BccLattice& lattice,
                         const LatticeTets& tets)
    : m_field(field),
      m_lattice(lattice),
      m_tets(tets),
      m_per_unit(1.0 / tets.per_half),
      m_is_proven(tets.is_uniform && field.labels().size() == 1),
      m_guard_cosine(std::cos(kGuardDeg * kRadiansPerDegree)) {}

void LatticeCuts::find_labels() {
  m_places.resize(m_tets.places.size());
  m_labels.resize(m_places.size());
  m_moved.assign(m_places.size(), -1);
  parallel_for(m_places.size(), Grain{1024}, [&](std::size_t n) {
    m_places[n] = Vec3d(m_tets.places[n]);
    m_labels[n] = m_field.at(index_at(m_places[n]));
  });
}

void LatticeCuts::find_edges() {
  for (const auto& tet : m_tets.tets) {
    const auto label_of = [&](std::size_t c) { return label(tet[c]); };
    if (label_of(0) == label_of(1) && label_of(0) == label_of(2) && label_of(0) == label_of(3)) {
      continue;
    }
    for (const auto& [a, b] : kTetEdges) {
      if (label_of(std::size_t(a)) == label_of(std::size_t(b))) continue;
      const auto [p, q] = std::minmax(tet[std::size_t(a)], tet[std::size_t(b)]);
      m_cuts.push_back({p, q, 0, true});
    }
  }
  const auto before = [](const EdgeCut& a, const EdgeCut& b) {
    return a.p != b.p ? a.p < b.p : a.q < b.q;
  };
  parallel_sort(m_cuts.begin(), m_cuts.end(), before);
  const auto is_same = [](const EdgeCut& a, const EdgeCut& b) { return a.p == b.p && a.q == b.q; };
  m_cuts.erase(std::unique(m_cuts.begin(), m_cuts.end(), is_same), m_cuts.end());
  parallel_for(m_cuts.size(), Grain{256},
               [&](std::size_t n) { m_cuts[n].part = cut_part(m_cuts[n]); });
}

/// Links vertices with the cuts of their edges and with their tetrahedra.
void LatticeCuts::link() {
  const std::size_t vertices = m_places.size();
  m_first_cut.assign(vertices + 1, 0);
  m_first_end.assign(vertices + 1, 0);
  for (const EdgeCut& cut : m_cuts) {
    ++m_first_cut[std::size_t(cut.p)];
    ++m_first_end[std::size_t(cut.p)];
    ++m_first_end[std::size_t(cut.q)];
  }
  add_up(m_first_cut);
  add_up(m_first_end);
  m_ends.resize(2 * m_cuts.size());
  std::vector<std::int32_t> next = m_first_end;
  for (std::size_t n = 0; n < m_cuts.size(); ++n) {
    m_ends[std::size_t(next[std::size_t(m_cuts[n].p)]++)] = {std::int32_t(n), true};
    m_ends[std::size_t(next[std::size_t(m_cuts[n].q)]++)] = {std::int32_t(n), false};
  }
  if (m_is_proven) return;
  const auto is_cut = [&](std::int32_t vertex) {
    return m_first_end[std::size_t(vertex)] < m_first_end[std::size_t(vertex) + 1];
  };
  m_first_tet.assign(vertices + 1, 0);
  for (const auto& tet : m_tets.tets) {
    for (const std::int32_t vertex : tet)
      m_first_tet[std::size_t(vertex)] += is_cut(vertex) ? 1 : 0;
  }
  add_up(m_first_tet);
  m_tets_of.resize(std::size_t(m_first_tet.back()));
  next = m_first_tet;
  for (std::size_t t = 0; t < m_tets.tets.size(); ++t) {
    for (const std::int32_t vertex : m_tets.tets[t]) {
      if (is_cut(vertex)) m_tets_of[std::size_t(next[std::size_t(vertex)]++)] = std::int32_t(t);
    }
  }
}

std::int32_t LatticeCuts::cut_between(std::int32_t p, std::int32_t q) const {
  if (p > q) std::swap(p, q);
  const std::int32_t end = m_first_cut[std::size_t(p) + 1];
  for (std::int32_t n = m_first_cut[std::size_t(p)]; n < end; ++n) {
    if (m_cuts[std::size_t(n)].q == q) return m_cuts[std::size_t(n)].is_there ? n : -1;
  }
  return -1;
}

/// The place on an edge where the labels of one end begin to be nearer than those of the other: the
/// false position method as Illinois has it, and bisection where that is slow.
double LatticeCuts::cut_part(const EdgeCut& cut) const {
  const LabelSet at_p = labels_at(cut.p), at_q = labels_at(cut.q);
  const Vec3d from = index_at(place(cut.p)), step = index_at(place(cut.q)) - from;
  const auto value_at = [&](double part) { return m_field.beyond(at_p, at_q, from + step * part); };
  double a = 0, b = 1, fa = value_at(0), fb = value_at(1);
  if (fa >= 0) return 0;
  if (fb <= 0) return 1;
  const double small = 1e-6 * m_lattice.spacing_mm() * m_per_unit;
  for (int n = 0; n < 20; ++n) {
    const double middle = n % 4 == 3 ? (a + b) / 2 : a + (b - a) * (fa / (fa - fb));
    const double value = value_at(middle);
    if (std::abs(value) <= small) return middle;
    if (value < 0) {
      a = middle, fa = value, fb /= 2;
    } else {
      b = middle, fb = value, fa /= 2;
    }
  }
  return (a + b) / 2;
}

double LatticeCuts::threshold(const EdgeCut& cut) const {
  const Vec3i step = m_tets.places[std::size_t(cut.q)] - m_tets.places[std::size_t(cut.p)];
  return is_long(step) ? kWarpLong : kWarpShort;
}

/// True if the tetrahedra around a vertex keep their shape where it moves.
bool LatticeCuts::keeps_shape(std::int32_t vertex, const Vec3d& to) const {
  const std::int32_t end = m_first_tet[std::size_t(vertex) + 1];
  for (std::int32_t n = m_first_tet[std::size_t(vertex)]; n < end; ++n) {
    std::array<Vec3d, 4> corners;
    const auto& tet = m_tets.tets[std::size_t(m_tets_of[std::size_t(n)])];
    for (std::size_t c = 0; c < 4; ++c) corners[c] = tet[c] == vertex ? to : place(tet[c]);
    if (tet_volume(corners) <= 0) return false;
    const TetAngles angles(corners);
    if (std::max(angles.largest_cosine, -angles.least_cosine) > m_guard_cosine) return false;
  }
  return true;
}

/// Looks near a place for one where all the labels are as near: Newton's steps, each the shortest.
bool LatticeCuts::find_junction(const LabelSet& labels, double reach, Vec3d& at) const {
  const int count = std::min(labels.size(), 4);
  const Vec3d start = at;
  const auto levels = [&](const Vec3d& where, double* out) {
    double values[4];
    m_field.levels(labels.begin(), count, index_at(where), values);
    for (int n = 1; n < count; ++n) out[n - 1] = values[n] - values[0];
  };
  const double delta = 0.1 * reach;
  for (int round = 0; round < 5; ++round) {
    double values[3], low[3], high[3];
    Vec3d rows[3];
    levels(at, values);
    for (int a = 0; a < 3; ++a) {
      Vec3d step(0);
      step[a] = delta;
      levels(at - step, low);
      levels(at + step, high);
      for (int n = 0; n + 1 < count; ++n) rows[n][a] = (high[n] - low[n]) / (2 * delta);
    }
    Vec3d step;
    if (!solve_shortest(rows, values, count - 1, step)) return false;
    at += step;
    if (!((at - start).length() <= reach)) return false;
    if (step.length() < 0.02 * reach) return true;
  }
  return false;
}

/// Adds a label of `other` that is at a place to those of a vertex that has moved.
bool LatticeCuts::touch(std::int32_t vertex, std::int32_t other, const Vec3d& at) {
  LabelSet& labels = m_sets[std::size_t(m_moved[std::size_t(vertex)])];
  labels.add(m_field.best(labels_at(other), index_at(at)));
  return labels.meets(labels_at(other));
}

/// Finds the cuts of a vertex that has moved anew, and takes those away that are too near. True if
/// one is too near to a vertex that has not moved.
bool LatticeCuts::settle(std::int32_t vertex) {
  bool is_near_other = false;
  const std::int32_t end = m_first_end[std::size_t(vertex) + 1];
  for (std::int32_t n = m_first_end[std::size_t(vertex)]; n < end; ++n) {
    EdgeCut& cut = m_cuts[std::size_t(m_ends[std::size_t(n)].cut)];
    if (!cut.is_there) continue;
    cut.is_there = !labels_at(cut.p).meets(labels_at(cut.q));
    if (!cut.is_there) continue;
    cut.part = cut_part(cut);
    const bool is_near_p = cut.part < threshold(cut), is_near_q = 1 - cut.part < threshold(cut);
    if (is_near_p && has_moved(cut.p)) {
      cut.is_there = !touch(cut.p, cut.q, place(cut));
    } else if (is_near_q && has_moved(cut.q)) {
      cut.is_there = !touch(cut.q, cut.p, place(cut));
    } else {
      is_near_other |= is_near_p || is_near_q;
    }
  }
  return is_near_other;
}

bool LatticeCuts::move(std::int32_t vertex, const Vec3d& to, const LabelSet& labels) {
  if (!m_is_proven && !keeps_shape(vertex, to)) return false;
  m_moved[std::size_t(vertex)] = std::int32_t(m_sets.size());
  m_sets.push_back(labels);
  m_places[std::size_t(vertex)] = to;
  return true;
}

/// Moves a vertex to the nearest cut that is too near, or where several labels come too near, to
/// the place where they meet.
bool LatticeCuts::warp_vertex(std::int32_t vertex) {
  double nearest = std::numeric_limits<double>::infinity(), shortest = nearest;
  Vec3d to;
  LabelSet at_nearest, around(label(vertex));
  const std::int32_t end = m_first_end[std::size_t(vertex) + 1];
  for (std::int32_t n = m_first_end[std::size_t(vertex)]; n < end; ++n) {
    const EdgeCut& cut = m_cuts[std::size_t(m_ends[std::size_t(n)].cut)];
    const bool is_p = m_ends[std::size_t(n)].is_p;
    const double length = (place(cut.q) - place(cut.p)).length();
    shortest = std::min(shortest, length);
    const double part = is_p ? cut.part : 1 - cut.part;
    if (!cut.is_there || part >= threshold(cut)) continue;
    const Vec3d at = place(cut);
    const LabelNumber beyond = m_field.best(labels_at(is_p ? cut.q : cut.p), index_at(at));
    around.add(beyond);
    if (part * length >= nearest) continue;
    nearest = part * length;
    to = at;
    at_nearest = LabelSet(label(vertex));
    at_nearest.add(beyond);
  }
  if (!std::isfinite(nearest)) return false;
  Vec3d junction = place(vertex);
  const bool meet = around.size() > 2 && find_junction(around, kJunctionReach * shortest, junction);
  if (meet && move(vertex, junction, around)) return true;
  return move(vertex, to, at_nearest);
}

void LatticeCuts::run() {
  find_labels();
  find_edges();
  link();
  // One after the other: a vertex that has moved takes the cuts of its edges away.
  bool has_changed = true;
  for (int round = 0; round < kMostRounds && has_changed; ++round) {
    has_changed = false;
    for (std::size_t n = 0; n < m_places.size(); ++n) {
      const auto vertex = std::int32_t(n);
      if (m_first_end[n] == m_first_end[n + 1] || has_moved(vertex)) continue;
      if (warp_vertex(vertex)) has_changed |= settle(vertex);
    }
  }
  for (EdgeCut& cut : m_cuts) {
    const double part = std::clamp(cut.part, threshold(cut), 1 - threshold(cut));
    m_held_apart += cut.is_there && part != cut.part ? 1 : 0;
    cut.part = part;
  }
}

}  // namespace supple
