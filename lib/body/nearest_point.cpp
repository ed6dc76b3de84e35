#include "lib/body/nearest_point.h"

#include <algorithm>
#include <cmath>

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

}  // namespace supple
