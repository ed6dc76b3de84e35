#include "lib/contact/lip_facings.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// A slope beyond this is not carried on (volumes/field/cuts/virtual_nodes.cpp).
constexpr double kSteepestCarried = 1;

double cross(double ux, double uy, double vx, double vy) {
  return ux * vy - uy * vx;
}

/// Weights inside a cell with corners (0, 0), (1, 0), (0, 1), (1, 1), or on its border; else false.
bool weights_in(const std::array<double, 8>& corners, double x, double y,
                std::array<double, 4>& weights) {
  double s = 0.5, t = 0.5;
  for (int step = 0; step < 12; ++step) {
    weights = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    double dx = x, dy = y;
    for (std::size_t n = 0; n < 4; ++n) {
      dx -= weights[n] * corners[2 * n];
      dy -= weights[n] * corners[2 * n + 1];
    }
    if (std::abs(dx) + std::abs(dy) < 1e-9) break;
    const double sx = (1 - t) * (corners[2] - corners[0]) + t * (corners[6] - corners[4]);
    const double sy = (1 - t) * (corners[3] - corners[1]) + t * (corners[7] - corners[5]);
    const double tx = (1 - s) * (corners[4] - corners[0]) + s * (corners[6] - corners[2]);
    const double ty = (1 - s) * (corners[5] - corners[1]) + s * (corners[7] - corners[3]);
    const double det = cross(sx, sy, tx, ty);
    if (!(std::abs(det) > 1e-6)) return false;
    s = std::clamp(s + cross(dx, dy, tx, ty) / det, -1.0, 2.0);
    t = std::clamp(t + cross(sx, sy, dx, dy) / det, -1.0, 2.0);
  }
  constexpr double kBorder = 1e-6;
  return s >= -kBorder && s <= 1 + kBorder && t >= -kBorder && t <= 1 + kBorder;
}

void insert_into(std::vector<int>& sorted, int n) {
  sorted.insert(std::lower_bound(sorted.begin(), sorted.end(), n), n);
}
void erase_from(std::vector<int>& sorted, int n) {
  sorted.erase(std::lower_bound(sorted.begin(), sorted.end(), n));
}

void sort_unique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

LipFacings::LipFacings(const Body& body, const LinkCuts& cuts, const LipSheets& sheets, int axis)
    : m_body(body),
      m_cuts(cuts),
      m_sheets(sheets),
      m_axis(axis),
      m_u(axis == 0 ? 1 : 0),
      m_v(axis == 2 ? 1 : 2),
      m_cells_of(sheets.lips.size()) {
  for (std::size_t c = 0; c < sheets.cells.size(); ++c) {
    for (const int lip : sheets.cells[c].lips) {
      std::vector<int>& cells = m_cells_of[std::size_t(lip)];
      if (cells.empty() || cells.back() != int(c)) cells.push_back(int(c));
    }
  }
  for (int side = 0; side < 2; ++side) list_carriers(side);
}

/// Lists the elements that carry a side on to its other end, as torn cells have it.
void LipFacings::list_carriers(int side_number) {
  const LinkCuts none;
  Side& side = m_sides[std::size_t(side_number)];
  for (std::size_t n = 0; n < m_sheets.lips.size(); ++n) {
    side.first_carrier.push_back(std::int32_t(side.carriers.size()));
    const Slot own = m_sheets.lips[n].ends[std::size_t(side_number)];
    const Slot beyond = m_sheets.lips[n].ends[std::size_t(1 - side_number)];
    const int lip = 2 * int(n) + side_number;
    read_by(own, lip);
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool positive : {false, true}) {
        Slot near, behind;
        if (!neighbour_slot(m_body.elements, none, beyond, axis, positive, near)) continue;
        if (neighbour_slot(m_body.elements, m_cuts, beyond, axis, positive, behind)) continue;
        if (!neighbour_slot(m_body.elements, m_cuts, near, axis, positive, behind)) continue;
        side.carriers.push_back({near, behind});
        read_by(near, lip);
        read_by(behind, lip);
      }
    }
  }
  side.first_carrier.push_back(std::int32_t(side.carriers.size()));
}

void LipFacings::read_by(Slot slot, int lip) {
  std::vector<int>& lips = m_bricks[slot / kBrickVoxels].lips;
  if (lips.empty() || lips.back() != lip) lips.push_back(lip);
}

Vec3d LipFacings::displacement(Slot slot) const {
  return Vec3d(m_body.q[0].at(slot), m_body.q[1].at(slot), m_body.q[2].at(slot)) / kFixedOne;
}

/// The place at which a lip ends now.
Vec3d LipFacings::point(int side_number, std::size_t n) const {
  const Side& side = m_sides[std::size_t(side_number)];
  const LipSheets::Lip& lip = m_sheets.lips[n];
  const Vec3d own = displacement(lip.ends[std::size_t(side_number)]);
  Vec3d sum(0);
  int count = 0;
  for (std::int32_t k = side.first_carrier[n]; k < side.first_carrier[n + 1]; ++k) {
    const Vec3d near = displacement(side.carriers[std::size_t(k)].near);
    const Vec3d slope = near - displacement(side.carriers[std::size_t(k)].behind);
    if (!(slope.length() < kSteepestCarried) || (near - own).length() > 1) continue;
    sum += near + slope;
    ++count;
  }
  const Vec3d beyond = count == 0 ? own : sum / double(count);
  Vec3d point =
      Vec3d(lip.low) + own + (beyond - own) * (side_number == 0 ? lip.place : 1 - lip.place);
  point[m_axis] += lip.place;
  return point;
}

/// Takes the offsets of a brick over; true where they are others than before.
bool LipFacings::take_over(std::size_t b, Brick& brick) const {
  const bool is_new = brick.q.empty();
  brick.q.resize(3 * kBrickVoxels);
  bool is_other = is_new;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int32_t* const now = m_body.q[c].brick_or_zero(b);
    std::int32_t* const before = brick.q.data() + c * kBrickVoxels;
    if (!is_new && std::equal(now, now + kBrickVoxels, before)) continue;
    std::copy_n(now, kBrickVoxels, before);
    is_other = true;
  }
  return is_other;
}

void LipFacings::follow() {
  std::array<std::vector<int>, 2> moved;  // lips
  for (auto& [b, brick] : m_bricks) {
    if (!take_over(b, brick)) continue;
    for (const int lip : brick.lips) moved[std::size_t(lip & 1)].push_back(lip >> 1);
  }
  std::array<Marks, 2> is_stale;
  for (std::size_t side = 0; side < 2; ++side) {
    sort_unique(moved[side]);
    if (moved[side].empty()) continue;
    for (Marks& marks : is_stale) marks.resize(m_sheets.lips.size());
  }
  std::array<std::vector<int>, 2> others;  // lips whose points are others
  for (std::size_t side = 0; side < 2; ++side) {
    others[side] = move_points(int(side), moved[side], is_stale[side]);
  }
  for (std::size_t side = 0; side < 2; ++side) {
    move_cells(int(side), others[1 - side], is_stale[side]);
  }
  for (int side = 0; side < 2; ++side) {
    const Marks& marks = is_stale[std::size_t(side)];
    parallel_for(marks.size(), [&](std::size_t n) {
      if (marks[n]) m_sides[std::size_t(side)].facings[n] = facings_of(side, n);
    });
  }
}

Vec3i LipFacings::square_of(std::size_t lip, const Vec3d& point) const {
  return {m_sheets.lips[lip].sheet, int(std::floor(point[m_u])), int(std::floor(point[m_v]))};
}

/// Puts points of a side where they are now. Returns the lips whose points have moved.
std::vector<int> LipFacings::move_points(int side_number, const std::vector<int>& lips,
                                         Marks& is_stale) {
  Side& side = m_sides[std::size_t(side_number)];
  const bool is_new = side.points.empty();
  side.points.resize(m_sheets.lips.size());
  side.facings.resize(m_sheets.lips.size());
  std::vector<Vec3d> now(lips.size());
  parallel_for(lips.size(),
               [&](std::size_t n) { now[n] = point(side_number, std::size_t(lips[n])); });
  std::vector<int> others;
  for (std::size_t n = 0; n < lips.size(); ++n) {
    const auto lip = std::size_t(lips[n]);
    if (!is_new && now[n] == side.points[lip]) continue;
    is_stale[lip] = 1;
    others.push_back(lips[n]);
    const Vec3i square = square_of(lip, now[n]);
    const Vec3i before = is_new ? square : square_of(lip, side.points[lip]);
    if (!(square == before)) erase_from(side.squares[before].points, lips[n]);
    if (is_new || !(square == before)) insert_into(side.squares[square].points, lips[n]);
    side.points[lip] = now[n];
  }
  return others;
}

/// Calls `visit(square)` for the squares over which a cell may lie.
template <class Visit>
void LipFacings::for_squares(const LipSheets::Cell& cell, const std::array<double, 8>& c,
                             Visit&& visit) const {
  constexpr double kBorder = 1e-5;
  constexpr int kWidest = 64;  // voxels: cells torn further face nothing
  const auto [x0, x1] = std::minmax({c[0], c[2], c[4], c[6]});
  const auto [y0, y1] = std::minmax({c[1], c[3], c[5], c[7]});
  if (x1 - x0 > kWidest || y1 - y0 > kWidest) return;
  const int sheet = m_sheets.lips[std::size_t(cell.lips[0])].sheet;
  for (int x = int(std::floor(x0 - kBorder)); x <= int(std::floor(x1 + kBorder)); ++x) {
    for (int y = int(std::floor(y0 - kBorder)); y <= int(std::floor(y1 + kBorder)); ++y) {
      visit(Vec3i(sheet, x, y));
    }
  }
}

/// Puts the cells that points of a side may face where the points of the other side are now.
void LipFacings::move_cells(int side_number, const std::vector<int>& of_lips, Marks& is_stale) {
  Side& side = m_sides[std::size_t(side_number)];
  const std::vector<Vec3d>& others = m_sides[std::size_t(1 - side_number)].points;
  const bool is_new = side.corners.empty();
  side.corners.resize(m_sheets.cells.size());
  std::vector<int> cells;
  for (const int lip : of_lips) {
    const std::vector<int>& of_lip = m_cells_of[std::size_t(lip)];
    cells.insert(cells.end(), of_lip.begin(), of_lip.end());
  }
  sort_unique(cells);
  for (const int n : cells) {
    const LipSheets::Cell& cell = m_sheets.cells[std::size_t(n)];
    std::array<double, 8> now;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3d& point = others[std::size_t(cell.lips[k])];
      now[2 * k] = point[m_u] + cell.beyond[2 * k];
      now[2 * k + 1] = point[m_v] + cell.beyond[2 * k + 1];
    }
    std::array<double, 8>& corners = side.corners[std::size_t(n)];
    const auto mark = [&](const Square& square) {
      for (const int point : square.points) is_stale[std::size_t(point)] = 1;
    };
    if (!is_new) {
      for_squares(cell, corners, [&](const Vec3i& at) {
        mark(side.squares[at]);
        erase_from(side.squares[at].cells, n);
      });
    }
    corners = now;
    for_squares(cell, corners, [&](const Vec3i& at) {
      mark(side.squares[at]);
      insert_into(side.squares[at].cells, n);
    });
  }
}

/// True where a lip may face a cell: in a sheet of several layers only those that it lay on.
bool LipFacings::is_of_one_layer(std::size_t n, const LipSheets::Cell& cell) const {
  bool is_layered = m_sheets.lips[n].is_layered, is_own = false;
  for (const int corner : cell.lips) {
    is_layered = is_layered || m_sheets.lips[std::size_t(corner)].is_layered;
    is_own = is_own || std::size_t(corner) == n;
  }
  return is_own || !is_layered;
}

std::vector<LipFacings::Facing> LipFacings::facings_of(int side_number, std::size_t n) const {
  const Side& side = m_sides[std::size_t(side_number)];
  const std::vector<Vec3d>& others = m_sides[std::size_t(1 - side_number)].points;
  const LipSheets::Lip& lip = m_sheets.lips[n];
  const Vec3d& point = side.points[n];
  std::vector<Facing> facings;
  std::array<double, 4> w;
  for (const int c : side.squares.at(square_of(n, point)).cells) {
    const LipSheets::Cell& cell = m_sheets.cells[std::size_t(c)];
    if (!weights_in(side.corners[std::size_t(c)], point[m_u], point[m_v], w)) continue;
    if (!is_of_one_layer(n, cell)) continue;
    double height = 0;
    Vec3d from(0);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto corner = std::size_t(cell.lips[k]);
      height += w[k] * others[corner][m_axis];
      from += w[k] * Vec3d(m_sheets.lips[corner].low);
      from[m_u] += w[k] * cell.beyond[2 * k];
      from[m_v] += w[k] * cell.beyond[2 * k + 1];
    }
    Vec3d slid = from - Vec3d(lip.low);
    slid[m_axis] = 0;
    const double gap = side_number == 0 ? height - point[m_axis] : point[m_axis] - height;
    facings.push_back({std::size_t(c), w, gap, slid.length()});
  }
  return facings;
}

}  // namespace supple
