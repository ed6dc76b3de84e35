#include "lib/fem/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr std::size_t kSampleNodes = 2000;
constexpr double kPercentile = 0.95;
/// Factor and power were found by the bodies of rows `error` of `supple-lab bench fem`.
constexpr double kErrorFactor = 2.5, kRitzPower = 0.4;
/// Iterations that converge slowest find their smallest Ritz value last.
constexpr double kSlowRitzValue = 1e-3, kSlowRitzPower = 0.3;
/// Contrasts of stiffness whose stiff pieces may have motions that are still hidden.
constexpr double kHidingContrast = 100, kContrastPower = 0.25;
/// The first step counts for more, since nothing is known of how steps converge.
constexpr double kFirstFactor = 3;
constexpr double kUnknownError = std::numeric_limits<double>::infinity();

double change_between(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> squares(a.size() / 3);
  if (squares.empty()) return 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    const double d = a[n] - b[n];
    squares[n / 3] += d * d;
  }
  const auto at = squares.begin() + std::lround(kPercentile * double(squares.size() - 1));
  std::nth_element(squares.begin(), at, squares.end());
  return std::sqrt(*at);
}

/// How much more than by their changes displacements may still go.
double slowness(double ritz_value) {
  const double beyond = std::max(1.0, kSlowRitzValue / ritz_value);
  return std::pow(ritz_value, -kRitzPower) * std::pow(beyond, kSlowRitzPower);
}

}  // namespace

ErrorEstimate::ErrorEstimate(const HeldBits& held, double contrast, double ritz_value)
    : m_factor(kErrorFactor * std::pow(std::max(1.0, contrast / kHidingContrast), kContrastPower)),
      m_ritz_value(ritz_value),
      m_error_mm(kUnknownError) {
  std::vector<std::size_t> free;
  for (std::size_t n = 0; n < held.size(); ++n) {
    if (held[n] != kAllHeld) free.push_back(n);
  }
  const std::size_t count = std::min(kSampleNodes, free.size());
  for (std::size_t n = 0; n < count; ++n) {
    m_nodes.push_back(free[(2 * n + 1) * free.size() / (2 * count)]);
  }
}

std::vector<double> ErrorEstimate::sample_of(const std::vector<double>& u_mm) const {
  std::vector<double> sample;
  sample.reserve(3 * m_nodes.size());
  for (const std::size_t node : m_nodes) {
    for (std::size_t a = 0; a < 3; ++a) sample.push_back(u_mm[3 * node + a]);
  }
  return sample;
}

void ErrorEstimate::start(const std::vector<double>& u_mm) {
  m_steps.clear();
  m_recent = {};
  m_last_mm = {};
  m_recent[0] = sample_of(u_mm);
}

void ErrorEstimate::take(const std::vector<double>& u_mm, const CgStep& step) {
  m_steps.push_back(step);
  m_recent[2] = std::move(m_recent[1]);
  m_recent[1] = std::move(m_recent[0]);
  m_recent[0] = sample_of(u_mm);
  const double last = change_between(m_recent[0], m_recent[1]);
  const double change = m_steps.size() < 2
                            ? kFirstFactor * last
                            : std::max(last, change_between(m_recent[0], m_recent[2]) / 2);
  m_ritz_value = std::min(m_ritz_value, smallest_ritz_value(m_steps));
  m_last_mm = {m_ritz_value > 0 ? m_factor * change * slowness(m_ritz_value) : kUnknownError,
               m_last_mm[0], m_last_mm[1]};
  m_error_mm = *std::max_element(m_last_mm.begin(), m_last_mm.end());
}

std::size_t ErrorEstimate::bytes() const {
  return m_nodes.size() * (sizeof(std::size_t) + 9 * sizeof(double)) +
         m_steps.capacity() * sizeof(CgStep);
}

/// Bisects: as many pivots of T - x are negative as eigenvalues are below x.
double smallest_ritz_value(const std::vector<CgStep>& steps) {
  std::vector<double> diagonal, square_beside;  // of T; the latter in front of each
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < steps.size(); ++n) {
    // A cycle that is not quite linear may make beta negative, which is rounding to T.
    const double beta = n > 0 ? std::max(0.0, steps[n].beta) : 0;
    const double before = n > 0 ? steps[n - 1].alpha : 1;
    diagonal.push_back(1 / steps[n].alpha + beta / before);
    square_beside.push_back(beta / (before * before));
    most = std::min(most, diagonal.back());
  }
  constexpr int kHalvings = 50;
  double low = 0;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double x = (low + most) / 2;
    bool is_above = false;
    double pivot = 1;
    for (std::size_t n = 0; n < diagonal.size() && !is_above; ++n) {
      pivot = diagonal[n] - x - square_beside[n] / pivot;
      is_above = !(pivot > 0);
    }
    (is_above ? most : low) = x;
  }
  return low;
}

}  // namespace supple
