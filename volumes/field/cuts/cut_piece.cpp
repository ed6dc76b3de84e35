#include "volumes/field/cuts/cut_piece.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kTolerance = 1e-4;
constexpr int kMaxSteps = 20;
// Rounding that still belongs to a cell, in voxels.
constexpr double kEdge = 1e-5;
// A side carries on this far from the middle of its cell, in voxels.
constexpr double kBeyond = 3;
// A node that is off by less is the same, in voxels.
constexpr double kNear = 1e-3;
// A place that was found is nearer to where it is than this, in voxels.
constexpr double kRefined = 0.01;
// Cells of less volume are flat, in voxels^3.
constexpr double kFlat = 1e-9;
// Cells of less have no map.
constexpr double kThin = 1e-3;
// A map is solved to this, in voxels, well below the width of its edge; what rounding leaves of the
// preconditioned equation; and how far inside a face a place is not near it.
constexpr double kMapTolerance = 3e-6;
constexpr float kFloatNoise = 5e-7f, kMapEdge = 2e-5f;
// Half width of the box on which a map is tested for injectivity, and det J of the preconditioned
// map above which Newton goes on.
constexpr float kInjectiveHalf = 0.75f, kRegular = 1e-3f;

float largest(const Vec3f& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The present place of `local` of the cell, relative to the cell, and its derivatives.
Vec3d moved(const CutPiece& piece, const Vec3d& local, Vec3d (&columns)[3]) {
  const Vec3d& t = local;
  Vec3d sum(0);
  for (auto& column : columns) column = Vec3d(0);
  for (int n = 0; n < 8; ++n) {
    const bool hx = n & 4, hy = n & 2, hz = n & 1;
    const Vec3d p = Vec3d(hx, hy, hz) + Vec3d(piece.u[std::size_t(n)]);
    const double wx = hx ? t.x : 1 - t.x, wy = hy ? t.y : 1 - t.y, wz = hz ? t.z : 1 - t.z;
    sum += p * (wx * wy * wz);
    columns[0] += p * ((hx ? 1 : -1) * wy * wz);
    columns[1] += p * (wx * (hy ? 1 : -1) * wz);
    columns[2] += p * (wx * wy * (hz ? 1 : -1));
  }
  return sum;
}

}  // namespace

std::uint8_t beyond_border(const Vec3i& cell, const Vec3i& dims) {
  unsigned beyond = 0;
  for (int a = 0; a < 3; ++a) {
    if (dims[a] == 1) continue;
    if (cell[a] == 0) beyond |= 1u << (2 * a);
    if (cell[a] == dims[a] - 2) beyond |= 2u << (2 * a);
  }
  return std::uint8_t(beyond);
}

CutPiece::CutPiece(const Vec3i& at, const std::array<Vec3f, 8>& moves,
                   const std::array<float, 8>& depths)
    : CutPiece(at, moves) {
  depth = depths;
  is_whole = false;
}

CutPiece::CutPiece(const Vec3i& at, const std::array<Vec3f, 8>& moves) : cell(at), u(moves) {
  depth.fill(1);
  is_translated = std::all_of(u.begin(), u.end(), [&](const Vec3f& v) { return v == u[0]; });
  is_folded = !is_translated && supple::is_folded(corners());
  lo = Vec3f(HUGE_VALF);
  hi = Vec3f(-HUGE_VALF);
  for (int n = 0; n < 8; ++n) {
    const Vec3f p = Vec3f(float(n >> 2), float(n >> 1 & 1), float(n & 1)) + u[std::size_t(n)];
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], p[a]);
      hi[a] = std::max(hi[a], p[a]);
    }
  }
}

void CutPiece::go_on(const Vec3i& dims) {
  if (is_translated && u[0] == Vec3f(0)) return;
  beyond = beyond_border(cell, dims);
  if (beyond == 0) return;
  const CellCorners reached = ends();
  for (int a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax_element(reached.p[a], reached.p[a] + 8);
    lo[a] = float(*least);
    hi[a] = float(*most);
  }
  folds_beyond = !is_translated && supple::is_folded(reached);
}

bool CutPiece::is_own(const Vec3d& t) const {
  if (is_whole) return true;
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    sum += depth[std::size_t(n)] *
           ((n & 4 ? t.x : 1 - t.x) * (n & 2 ? t.y : 1 - t.y) * (n & 1 ? t.z : 1 - t.z));
  }
  return sum >= 0;
}

CellCorners CutPiece::corners() const {
  CellCorners corners;
  for (int n = 0; n < 8; ++n) {
    const Vec3i step = cell_corner(n);
    for (int a = 0; a < 3; ++a) corners.p[a][n] = step[a] + double(u[std::size_t(n)][a]);
  }
  return corners;
}

CellCorners CutPiece::ends() const {
  if (beyond == 0) return corners();
  CellCorners ends;
  Vec3d columns[3];
  for (int n = 0; n < 8; ++n) {
    Vec3d local;
    for (int a = 0; a < 3; ++a) local[a] = cell_corner(n)[a] ? to(a) : from(a);
    const Vec3d end = moved(*this, local, columns);
    for (int a = 0; a < 3; ++a) ends.p[a][n] = end[a];
  }
  return ends;
}

bool CutPiece::source_of(const Vec3d& x, Vec3d& X) const {
  const Vec3d at = x - Vec3d(cell);
  for (int a = 0; a < 3; ++a) {
    const double slack = kEdge * (1 + std::abs(at[a]));
    if (!(at[a] >= lo[a] - slack && at[a] <= hi[a] + slack)) return false;
  }
  if (is_translated) {
    X = x - Vec3d(u[0]);
    return is_own(X - Vec3d(cell));
  }
  Vec3d local;
  const bool folds = is_folded || folds_beyond;
  const DeformedCell deformed(ends(), folds);
  auto outcome = deformed.solve(at, kTolerance, kMaxSteps, local);
  if (outcome == DeformedCell::Outcome::outside) return false;
  if (folds || outcome == DeformedCell::Outcome::undecided) {
    outcome = deformed.solve_by_bisection(at, kTolerance, kMaxSteps, local);
  }
  if (outcome != DeformedCell::Outcome::inside) return false;
  for (int a = 0; a < 3 && beyond != 0; ++a) local[a] = from(a) + local[a] * (to(a) - from(a));
  X = Vec3d(cell) + local;
  return is_own(local);
}

bool CutPiece::source_beyond(const Vec3d& x, Vec3d& X) const {
  if (is_translated) {
    X = x - Vec3d(u[0]);
    return true;
  }
  const Vec3d at = x - Vec3d(cell);
  Vec3d local(0.5), columns[3];
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vec3d residual = at - moved(*this, local, columns);
    const Vec3d yz = columns[1].cross(columns[2]);
    const double volume = columns[0].dot(yz);
    if (residual.length2() < 1e-18) break;
    if (std::abs(volume) < kFlat) return false;
    const Vec3d xr = columns[0].cross(residual);
    local += Vec3d(residual.dot(yz), xr.dot(columns[2]), -xr.dot(columns[1])) / volume;
    if (!((local - Vec3d(0.5)).length() < kBeyond)) return false;
  }
  X = Vec3d(cell) + local;
  return residual(x, X) < kTolerance;
}

bool CutPiece::refine(const Vec3d& x, Vec3d& X) const {
  if (is_translated) return true;
  const Vec3d at = x - Vec3d(cell);
  Vec3d local = X - Vec3d(cell), columns[3];
  for (int step = 0; step < 3; ++step) {
    const Vec3d residual = at - moved(*this, local, columns);
    const Vec3d yz = columns[1].cross(columns[2]);
    const double volume = columns[0].dot(yz);
    if (std::abs(volume) < kFlat) return true;
    const Vec3d xr = columns[0].cross(residual);
    const Vec3d change = Vec3d(residual.dot(yz), xr.dot(columns[2]), -xr.dot(columns[1])) / volume;
    if (!(change.length() < kRefined)) return true;
    local += change;
  }
  X = Vec3d(cell) + local;
  for (int a = 0; a < 3; ++a) {
    if (!(local[a] >= from(a) - 2 * kEdge && local[a] <= to(a) + 2 * kEdge)) return false;
  }
  return true;
}

bool CutPiece::has(const Vec3d& x, const Vec3d& offset) const {
  const Vec3d X = x + offset, local = X - Vec3d(cell);
  for (int a = 0; a < 3; ++a) {
    if (!(local[a] >= from(a) - kNear && local[a] <= to(a) + kNear)) return false;
  }
  return residual(x, X) < kNear;
}

/// dX/dx is the inverse of (I + grad u), whose columns are the derivatives of the moved place.
Vec3d CutPiece::pull_back(const Vec3d& X, const Vec3d& gradient) const {
  if (is_translated) return gradient;
  Vec3d columns[3];
  moved(*this, X - Vec3d(cell), columns);
  const Vec3d yz = columns[1].cross(columns[2]);
  const double volume = columns[0].dot(yz);
  if (std::abs(volume) < kFlat) return gradient;
  return (yz * gradient.x + columns[2].cross(columns[0]) * gradient.y +
          columns[0].cross(columns[1]) * gradient.z) /
         volume;
}

CutPiece::Joint CutPiece::joint_with(const CutPiece& other) const {
  const Vec3i step = other.cell - cell;
  if (std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)}) > 1) return Joint::none;
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i corner = cell_corner(n) - step;  // of the other
    if (std::min({corner.x, corner.y, corner.z}) < 0) continue;
    if (std::max({corner.x, corner.y, corner.z}) > 1) continue;
    const int same = 4 * corner.x + 2 * corner.y + corner.z;
    if (u[std::size_t(n)] != other.u[std::size_t(same)]) return Joint::torn;
  }
  return Joint::joined;
}

bool CutPiece::is_beyond(const Vec3d& X) const {
  for (int a = 0; a < 3 && beyond != 0; ++a) {
    if (X[a] < cell[a] || X[a] > cell[a] + 1) return true;
  }
  return false;
}

Content CutPiece::content_at(const Vec3d& X) const {
  if (elements == 0xff) return is_beyond(X) ? Content::surface : Content::tissue;
  int nearest = 0;
  for (int a = 0; a < 3; ++a) nearest = 2 * nearest + (X[a] - cell[a] >= 0.5 ? 1 : 0);
  return elements >> nearest & 1 ? Content::surface : Content::air;
}

double CutPiece::residual(const Vec3d& x, const Vec3d& X) const {
  Vec3d columns[3];
  return (moved(*this, X - Vec3d(cell), columns) - (x - Vec3d(cell))).length();
}

Vec3d CutPiece::middle() const {
  Vec3d sum(0);
  int count = 0;
  for (int n = 0; n < 8; ++n) {
    if (depth[std::size_t(n)] < 0) continue;
    sum += Vec3d(cell_corner(n));
    ++count;
  }
  return Vec3d(cell) + sum / double(count);
}

/// A cell maps into the hull of its corners. The margin is that of source_of(), with rounding.
PieceMap::PieceMap(const CutPiece& piece)
    : m_centre(0),
      m_rows{Vec3f(0), Vec3f(0), Vec3f(0)},
      m_lo(-HUGE_VALF),
      m_hi(HUGE_VALF),
      m_xy(0),
      m_yz(0),
      m_xz(0),
      m_xyz(0),
      m_beyond(piece.beyond) {
  const CellCorners corners = piece.ends();
  Vec3d columns[3] = {Vec3d(0), Vec3d(0), Vec3d(0)};
  Vec3d bent[4] = {Vec3d(0), Vec3d(0), Vec3d(0), Vec3d(0)};  // of xy, yz, xz, xyz
  for (int n = 0; n < 8; ++n) {
    const Vec3d p = corners.corner(n);
    const double x = n & 4 ? 1 : -1, y = n & 2 ? 1 : -1, z = n & 1 ? 1 : -1;
    m_centre += p * 0.125;
    columns[0] += p * (0.25 * x);
    columns[1] += p * (0.25 * y);
    columns[2] += p * (0.25 * z);
    bent[0] += p * (0.5 * x * y);
    bent[1] += p * (0.5 * y * z);
    bent[2] += p * (0.5 * x * z);
    bent[3] += p * (x * y * z);
  }
  const Vec3d yz = columns[1].cross(columns[2]);
  const double volume = columns[0].dot(yz);
  const Vec3d middle = m_centre;
  m_centre += Vec3d(piece.cell);
  if (!(std::abs(volume) > kThin)) return;
  const Vec3d rows[3] = {yz / volume, columns[2].cross(columns[0]) / volume,
                         columns[0].cross(columns[1]) / volume};
  double longest = 0;
  for (int a = 0; a < 3; ++a) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int n = 0; n < 8; ++n) {
      const double t = rows[a].dot(corners.corner(n) - middle);
      lo = std::min(lo, t);
      hi = std::max(hi, t);
    }
    const double margin = 2e-3 + 2 * kTolerance * rows[a].length();
    m_rows[std::size_t(a)] = Vec3f(rows[a]);
    m_lo[a] = float(lo - margin);
    m_hi[a] = float(hi + margin);
    m_xy[a] = float(rows[a].dot(bent[0]));
    m_yz[a] = float(rows[a].dot(bent[1]));
    m_xz[a] = float(rows[a].dot(bent[2]));
    m_xyz[a] = float(rows[a].dot(bent[3]));
    longest = std::max(longest, columns[a].length());
  }
  constexpr float kHalf = kInjectiveHalf;
  float rest = 0;  // the largest row sum of N' on that box
  for (int a = 0; a < 3; ++a) {
    const float pairs = std::abs(m_xy[a]) + std::abs(m_yz[a]) + std::abs(m_xz[a]);
    m_bend = std::max(m_bend, pairs + 7 * std::abs(m_xyz[a]));
    rest = std::max(rest, pairs * (2 * kHalf) + std::abs(m_xyz[a]) * (3 * kHalf * kHalf));
  }
  m_is_injective = rest < 1;
  m_tolerance = float(kMapTolerance / longest);
  m_is_regular = !piece.is_folded && !piece.folds_beyond && m_tolerance > kFloatNoise;
}

inline Vec3d PieceMap::local_of(const Vec3f& eta) const {
  Vec3d local;
  for (int a = 0; a < 3; ++a) local[a] = std::clamp(double(eta[a]) + 0.5, 0.0, 1.0);
  for (int a = 0; a < 3 && m_beyond != 0; ++a) {
    const double lowest = lowest_place(m_beyond, a);
    local[a] = lowest + local[a] * (highest_place(m_beyond, a) - lowest);
  }
  return local;
}

inline Vec3f PieceMap::value(const Vec3f& eta) const {
  return eta + m_xy * (eta.x * eta.y) + m_yz * (eta.y * eta.z) + m_xz * (eta.x * eta.z) +
         m_xyz * (eta.x * eta.y * eta.z);
}

/// The Jacobian of the preconditioned map.
inline PieceMap::Jacobian PieceMap::jacobian(const Vec3f& eta) const {
  Jacobian j{m_xy * eta.y + m_xz * eta.z + m_xyz * (eta.y * eta.z),
             m_xy * eta.x + m_yz * eta.z + m_xyz * (eta.x * eta.z),
             m_yz * eta.y + m_xz * eta.x + m_xyz * (eta.x * eta.y)};
  j.x.x += 1;
  j.y.y += 1;
  j.z.z += 1;
  return j;
}

PieceMap::Outcome PieceMap::newton(const Vec3f& t, Vec3d& local) const {
  if (!m_is_regular) return Outcome::undecided;
  Vec3f eta;
  for (int a = 0; a < 3; ++a) eta[a] = std::clamp(t[a], -0.5f, 0.5f);
  for (int step = 0;; ++step) {
    const Vec3f residual = value(eta) - t;
    if (largest(residual) <= m_tolerance) break;
    if (step == kMaxSteps) return Outcome::undecided;
    const Jacobian j = jacobian(eta);
    const Vec3f yz = j.y.cross(j.z), xr = j.x.cross(residual);
    const float volume = j.x.dot(yz);
    if (!(std::abs(volume) > kRegular)) return Outcome::undecided;
    const Vec3f change = Vec3f(residual.dot(yz), xr.dot(j.z), -xr.dot(j.y)) / volume;
    eta -= change;
    const float size = largest(change);
    if (!(largest(eta) <= 2)) return Outcome::undecided;
    // The residual after a step is of second order in it; often that saves another look.
    if (size < 1 && m_bend * size * size <= m_tolerance) break;
  }
  const float reached = largest(eta);
  local = local_of(eta);
  if (reached < 0.5f - kMapEdge) return Outcome::inside;
  if (reached <= 0.5f + float(kEdge)) return Outcome::edge;
  return m_is_injective && reached <= kInjectiveHalf ? Outcome::outside : Outcome::undecided;
}

/// dX/dx is the inverse of G (I + N'), whose columns are the derivatives of the moved place.
Vec3d PieceMap::pull_back(const Vec3d& local, const Vec3d& gradient) const {
  Vec3d eta = local - Vec3d(0.5), along = gradient;
  for (int a = 0; a < 3 && m_beyond != 0; ++a) {
    const double lowest = lowest_place(m_beyond, a);
    const double size = highest_place(m_beyond, a) - lowest;
    eta[a] = (local[a] - lowest) / size - 0.5;
    along[a] *= size;
  }
  const Jacobian j = jacobian(Vec3f(eta));
  const Vec3f yz = j.y.cross(j.z), g(along);
  const float volume = j.x.dot(yz);
  if (!(std::abs(volume) > kRegular)) return gradient;
  const Vec3f w = (yz * g.x + j.z.cross(j.x) * g.y + j.x.cross(j.y) * g.z) / volume;
  return Vec3d(m_rows[0] * w.x + m_rows[1] * w.y + m_rows[2] * w.z);
}

}  // namespace supple
