#include "lib/body/smallest_motion.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kMostChanges = 1000;  // of the set for one half-space; some are usual
constexpr double kTiny = 1e-12;

void add_times(Vec6& a, double factor, const Vec6& b) {
  for (std::size_t n = 0; n < 6; ++n) a[n] += factor * b[n];
}

}  // namespace

double dot(const Vec6& a, const Vec6& b) {
  double sum = 0;
  for (std::size_t n = 0; n < 6; ++n) sum += a[n] * b[n];
  return sum;
}

/// Returns the part of a row that is no combination of the active rows (Gram-Schmidt, each twice),
/// and in `parts` the factors by which the active rows make up the rest of it.
Vec6 NearestPoint::combined_from(const Vec6& row, std::vector<double>& parts) const {
  const std::size_t count = m_active.size();
  std::vector<Vec6> axes;
  std::vector<std::vector<double>> along(count + 1);  // of each row, on the axes before it
  const auto reduce = [&](Vec6 left, std::vector<double>& ways) {
    ways.assign(axes.size(), 0);
    for (int again = 0; again < 2; ++again) {
      for (std::size_t a = 0; a < axes.size(); ++a) {
        const double way = dot(axes[a], left);
        ways[a] += way;
        add_times(left, -way, axes[a]);
      }
    }
    return left;
  };
  for (std::size_t n = 0; n < count; ++n) {
    Vec6 axis = reduce(m_active[n].row, along[n]);
    const double length = std::sqrt(dot(axis, axis));
    along[n].push_back(length);
    for (double& value : axis) value /= length;
    axes.push_back(axis);
  }
  const Vec6 left = reduce(row, along[count]);
  parts = along[count];
  for (std::size_t n = count; n-- > 0;) {
    for (std::size_t later = n + 1; later < count; ++later)
      parts[n] -= along[later][n] * parts[later];
    parts[n] /= along[n][n];
  }
  return left;
}

bool NearestPoint::add(const Vec6& row, double least) {
  double multiplier = 0;
  std::vector<double> rates;
  for (int n = 0; n < kMostChanges; ++n) {
    const Vec6 way = combined_from(row, rates);
    // The first active multiplier that the step would make negative leaves the set.
    double step = HUGE_VAL;
    std::size_t leaves = m_active.size();
    for (std::size_t a = 0; a < m_active.size(); ++a) {
      if (rates[a] <= kTiny || m_active[a].multiplier / rates[a] >= step) continue;
      step = m_active[a].multiplier / rates[a];
      leaves = a;
    }
    const double speed = dot(way, row);
    const bool can_move = m_active.size() < 6 && speed > kTiny * dot(row, row);
    if (!can_move && leaves == m_active.size()) return false;
    const double full = can_move ? (least - dot(row, m_x)) / speed : HUGE_VAL;
    const bool is_full = full <= step;
    step = std::min(step, full);
    if (can_move) add_times(m_x, step, way);
    multiplier += step;
    for (std::size_t a = 0; a < m_active.size(); ++a) m_active[a].multiplier -= step * rates[a];
    if (is_full) {
      m_active.push_back({row, multiplier});
      return true;
    }
    m_active.erase(m_active.begin() + std::ptrdiff_t(leaves));
  }
  return false;
}

bool factorize(std::array<Vec6, 6>& matrix) {
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = 0; c <= r; ++c) {
      double value = matrix[r][c];
      for (std::size_t k = 0; k < c; ++k) value -= matrix[r][k] * matrix[c][k];
      if (c == r && !(value > 0)) return false;
      matrix[r][c] = c == r ? std::sqrt(value) : value / matrix[c][c];
    }
  }
  return true;
}

Vec6 solve_lower(const std::array<Vec6, 6>& lower, Vec6 b) {
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = 0; c < r; ++c) b[r] -= lower[r][c] * b[c];
    b[r] /= lower[r][r];
  }
  return b;
}

Vec6 solve_upper(const std::array<Vec6, 6>& lower, Vec6 b) {
  for (std::size_t r = 6; r-- > 0;) {
    for (std::size_t c = r + 1; c < 6; ++c) b[r] -= lower[c][r] * b[c];
    b[r] /= lower[r][r];
  }
  return b;
}

namespace {

/// Margin for the rounding of shift, turn and present offset, half a unit of q each.
constexpr double kRoundingVoxels = 2.0 / kFixedOne;
constexpr double kConvergedVoxels = 1e-6;
constexpr int kMostIterations = 40;
constexpr int kMostConstraints = 1000;  // some dozens are usual
/// Longest turn of a step, radians: one that turns more is not linear and goes a part of its way.
constexpr double kLongestTurn = 0.3;

Vec3d unit_of(int axis) {
  Vec3d unit(0.0);
  unit[axis] = 1;
  return unit;
}

/// A small shift in mm and a small turn in radians, both LPS.
struct SmallMotion {
  Vec3d shift, turn;

  static SmallMotion of(const Vec6& x) { return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}; }
};

Vec6 joined(const Vec3d& a, const Vec3d& b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

/// A piece in LPS mm about its centre where its motion starts, and the motion that is sought.
class MotionSearch {
 public:
  MotionSearch(const Body& body, const RigidPiece& piece, const std::vector<ElementBounds>& bounds,
               double cube_mm, const Progress* progress)
      : m_body(body), m_piece(piece), m_bounds(bounds), m_progress(progress) {
    m_piece.pose = piece.motion_starts_at();
    Vec3d centre = m_piece.centre_index;
    for (int c = 0; c < 3; ++c) {
      centre[c] += double(m_piece.pose.shift_q[std::size_t(c)]) / kFixedOne;
    }
    const PoseOffsets offsets(body.geometry, m_piece);
    for (const ElementBounds& element : bounds) {
      m_starts.push_back(offsets(voxel_of(body.elements, element.slot)));
    }
    m_motion.about_lps_mm = body.geometry.world_from_index(centre);
    for (const ElementBounds& element : bounds) m_arms.push_back(arm_of(element.slot));
    piece.elements->for_each([&](Slot slot) {
      const Vec3d arm = arm_of(slot);
      for (int a = 0; a < 3; ++a) m_moments[std::size_t(a)] += arm * arm[a];
      m_radius_mm = std::max(m_radius_mm, arm.length());
      ++m_count;
    });
    // So a row of voxels or a single one has moments about all axes.
    const Vec3d spacing = body.geometry.spacing_mm();
    for (int a = 0; a < 3; ++a) {
      const double edge = std::max(spacing[a], cube_mm);
      m_moments[std::size_t(a)][a] += m_count * edge * edge / 12;
    }
    m_voxel_mm = std::min({spacing.x, spacing.y, spacing.z});
    for (int a = 0; a < 3; ++a) {
      const Vec3d column = body.geometry.index_vector_from_world(unit_of(a));
      for (int c = 0; c < 3; ++c) m_index_rows[std::size_t(c)][a] = column[c];
    }
  }

  std::optional<RigidPose> run() {
    for (int n = 0; n < kMostIterations; ++n) {
      Vec6 found;
      if (!find_step(found)) return {};
      const SmallMotion step = SmallMotion::of(found);
      const double angle = step.turn.length();
      const double part = angle > kLongestTurn ? kLongestTurn / angle : 1;
      m_motion.shift_lps_mm += step.shift * part;
      if (angle > 0) {
        m_motion.turn =
            (turn_about(step.turn, angle * part / kRadiansPerDegree) * m_motion.turn).unit();
      }
      if (step.shift.length() + angle * m_radius_mm < kConvergedVoxels * m_voxel_mm) break;
    }
    RigidPiece moved = m_piece;
    moved.pose = moved_by(m_motion, m_piece, m_body.geometry);
    if (!meets_bounds(moved)) return {};
    return moved.pose;
  }

 private:
  Vec3d arm_of(Slot slot) const {
    const Vec3d rest = Vec3d(voxel_of(m_body.elements, slot)) - m_piece.centre_index;
    return m_piece.pose.turn(m_body.geometry.world_vector_from_index(rest));
  }

  /// The sum of squares after a further shift v and turn w, by its minimum and L of its matrix
  /// L L^T. With s = T r the turn's part is - sum (exp(w) s) . r, of gradient sum r x s; its
  /// matrix is that of Gauss and Newton, sum |s|^2 - s s^T, since the full one need not be positive
  /// and both end at the same motion. About the centre shift and turn do not mix.
  bool expand(std::array<Vec6, 6>& lower, Vec6& minimum) const {
    const auto turned_rows = [&](const std::array<Vec3d, 3>& rows) {
      return std::array<Vec3d, 3>{m_motion.turn(rows[0]), m_motion.turn(rows[1]),
                                  m_motion.turn(rows[2])};
    };
    const std::array<Vec3d, 3> m = turned_rows(m_moments);  // sum r s^T
    const std::array<Vec3d, 3> squares =                    // sum s s^T
        turned_rows({Vec3d(m[0].x, m[1].x, m[2].x), Vec3d(m[0].y, m[1].y, m[2].y),
                     Vec3d(m[0].z, m[1].z, m[2].z)});
    const double trace = squares[0].x + squares[1].y + squares[2].z;
    lower = {};
    for (int a = 0; a < 3; ++a) {
      const auto row = std::size_t(a);
      lower[row][row] = m_count;
      for (int b = 0; b <= a; ++b) {
        lower[3 + row][3 + std::size_t(b)] = (a == b ? trace : 0) - squares[row][b];
      }
    }
    if (!factorize(lower)) return false;
    const Vec3d turning(m[2].y - m[1].z, m[0].z - m[2].x, m[1].x - m[0].y);
    minimum =
        solve_upper(lower, solve_lower(lower, joined(m_motion.shift_lps_mm * -m_count, turning)));
    return true;
  }

  /// The next small motion, under bounds that are linear about m_motion. With y = L^T (x - minimum)
  /// it is the point nearest to 0 within half-spaces. False where none meets all.
  bool find_step(Vec6& step) {
    std::array<Vec6, 6> lower;
    Vec6 minimum;
    if (!expand(lower, minimum)) return false;
    m_turned.clear();
    for (const Vec3d& arm : m_arms) m_turned.push_back(m_motion.turn(arm));
    NearestPoint nearest;
    for (int n = 0; n < kMostConstraints; ++n) {
      poll(m_progress);
      step = solve_upper(lower, nearest.x());
      for (std::size_t a = 0; a < 6; ++a) step[a] += minimum[a];
      Vec6 row;
      double missing = 0;
      if (!most_violated(SmallMotion::of(step), row, missing)) return true;
      const Vec6 scaled = solve_lower(lower, row);
      if (!nearest.add(scaled, dot(scaled, nearest.x()) + missing)) return false;
    }
    return false;
  }

  /// The bound that a small motion misses by most, as row . x >= row . step + missing; false where
  /// it meets all.
  bool most_violated(const SmallMotion& step, Vec6& row, double& missing) const {
    const Violation worst = parallel_reduce(
        m_arms.size(), Grain{2048}, Violation(),
        [&](std::size_t n, Violation& most) { look_at(n, step, most); },
        [](const Violation& a, const Violation& b) { return b.missing > a.missing ? b : a; });
    missing = worst.missing;
    if (worst.sign == 0) return false;
    // g . (v + w x s) = g . v + w . (s x g)
    const Vec3d gradient = m_index_rows[std::size_t(worst.coordinate)] * double(worst.sign);
    row = joined(gradient, m_turned[worst.element].cross(gradient));
    return true;
  }

  /// The bound that is missed by most, in voxels; the first one where several are missed alike.
  struct Violation {
    double missing = kRoundingVoxels / 4;
    std::size_t element = 0;
    int coordinate = 0, sign = 0;
  };

  void look_at(std::size_t n, const SmallMotion& step, Violation& most) const {
    const Vec3d way =
        m_turned[n] - m_arms[n] + m_motion.shift_lps_mm + step.shift + step.turn.cross(m_turned[n]);
    for (int c = 0; c < 3; ++c) {
      const double offset = m_index_rows[std::size_t(c)].dot(way);
      const auto [low, high] = room(n, std::size_t(c));
      const double excess = std::max(low - offset, offset - high);
      if (excess > most.missing) most = {excess, n, c, low > offset ? 1 : -1};
    }
  }

  /// How far the element may go from where it starts, in voxels.
  std::pair<double, double> room(std::size_t n, std::size_t c) const {
    const ElementBounds& bounds = m_bounds[n];
    const auto start = double(m_starts[n][c]);
    const double low = bounds.least[c] == -ElementBounds::kNone
                           ? -HUGE_VAL
                           : (bounds.least[c] - start) / kFixedOne;
    const double high =
        bounds.most[c] == ElementBounds::kNone ? HUGE_VAL : (bounds.most[c] - start) / kFixedOne;
    const double margin = std::min(kRoundingVoxels, (high - low) / 2);
    return {low + margin, high - margin};
  }

  bool meets_bounds(const RigidPiece& moved) const {
    const PoseOffsets offsets(m_body.geometry, moved);
    return std::all_of(m_bounds.begin(), m_bounds.end(), [&](const ElementBounds& bounds) {
      const std::array<std::int64_t, 3> q = offsets(voxel_of(m_body.elements, bounds.slot));
      for (std::size_t c = 0; c < 3; ++c) {
        if (q[c] < bounds.least[c] || q[c] > bounds.most[c]) return false;
      }
      return true;
    });
  }

  const Body& m_body;
  RigidPiece m_piece;                                 // where its motion starts
  std::vector<std::array<std::int64_t, 3>> m_starts;  // q of m_bounds, there
  const std::vector<ElementBounds>& m_bounds;
  std::vector<Vec3d> m_arms, m_turned;  // of m_bounds, from the centre, LPS mm
  std::array<Vec3d, 3> m_moments{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};  // sum r r^T of all
  std::array<Vec3d, 3> m_index_rows;                                   // LPS mm to voxels
  double m_count = 0, m_radius_mm = 0, m_voxel_mm = 1;
  RigidMotion m_motion;
  const Progress* m_progress;
};

}  // namespace

std::optional<RigidPose> smallest_pose(const Body& body, const RigidPiece& piece,
                                       const std::vector<ElementBounds>& bounds, double cube_mm,
                                       const Progress* progress) {
  return MotionSearch(body, piece, bounds, cube_mm, progress).run();
}

}  // namespace supple
