#include "lib/chainmail/mesh_links.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Furthest rest position in mm: rest + q 2^-16 is kept exactly enough there to read q back.
constexpr double kFurthestRest = 1e7;

void require_range(const MeshBody& body) {
  for (std::size_t n = 0; n < body.node_count(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (std::abs(body.rest_mm[n][c]) <= kFurthestRest) continue;
      throw InputError({"", "node " + std::to_string(n),
                        "a coordinate of " + number_text(body.rest_mm[n][c]) + " mm",
                        "coordinates within +-" + number_text(kFurthestRest) + " mm"});
    }
  }
}

void require_valid(const MeshLimits& limits, std::size_t link) {
  const auto require = [&](bool holds, const char* name, double value, const char* expected) {
    if (holds) return;
    throw InputError(
        {"", std::string(name) + " of link " + std::to_string(link), number_text(value), expected});
  };
  require(limits.max_length >= 1 && std::isfinite(limits.max_length), "max_length",
          limits.max_length, "1 or more");
  require(limits.min_length > 0 && limits.min_length <= 1, "min_length", limits.min_length,
          "more than 0 and at most 1");
  require(limits.shear >= 0 && std::isfinite(limits.shear), "shear", limits.shear, "0 or more");
}

/// The geometric mean of slacks that limit, as a power of two, less two: narrow enough that few
/// labels are corrected, wide enough that few buckets are empty.
int fitting_shift(const std::vector<MeshStep>& steps) {
  std::int64_t sum_of_logs = 0, count = 0;
  for (const MeshStep& step : steps) {
    if (step.out == 0 || step.out >= kUnlimitedSlack) continue;
    sum_of_logs += 31 - __builtin_clz(unsigned(step.out));
    ++count;
  }
  return count == 0 ? 0 : int(std::max<std::int64_t>(0, sum_of_logs / count - 2));
}

}  // namespace

LinkSlack slack_of(const Vec3d& rest_difference_mm, const MeshLimits& limits) {
  const Vec3d& r = rest_difference_mm;
  LinkSlack slack;
  for (int c = 0; c < 3; ++c) {
    const double along = std::abs(r[c]);  // |e_c| L
    const double p = r[(c + 1) % 3], q = r[(c + 2) % 3];
    const double sideways = limits.shear * std::sqrt(p * p + q * q);  // sqrt(1 - e_c^2) L
    const std::int32_t longer = fixed_slack((limits.max_length - 1) * along + sideways);
    const std::int32_t shorter = fixed_slack((1 - limits.min_length) * along + sideways);
    slack.upper[std::size_t(c)] = r[c] < 0 ? shorter : longer;
    slack.lower[std::size_t(c)] = r[c] < 0 ? longer : shorter;
  }
  return slack;
}

MeshLinks::MeshLinks(const MeshBody& body, const std::vector<MeshLimits>& limits) {
  if (limits.size() != body.links.size()) {
    throw InputError({"", "limits", std::to_string(limits.size()) + " entries",
                      "one for each of " + std::to_string(body.links.size()) + " links"});
  }
  require_range(body);
  m_first.assign(body.node_count() + 1, 0);
  for (const LinkNodes& link : body.links) {
    for (const int node : link) ++m_first[std::size_t(node) + 1];
  }
  for (std::size_t n = 0; n < body.node_count(); ++n) m_first[n + 1] += m_first[n];
  for (auto& steps : m_steps) steps.resize(2 * body.links.size());

  std::vector<std::size_t> next = m_first;
  for (std::size_t n = 0; n < body.links.size(); ++n) {
    require_valid(limits[n], n);
    const auto [a, b] = body.links[n];
    const LinkSlack slack = slack_of(body.rest_mm[b] - body.rest_mm[a], limits[n]);
    const std::size_t from_a = next[a]++, from_b = next[b]++;
    for (std::size_t c = 0; c < 3; ++c) {
      m_steps[c][from_a] = {Slot(b), slack.lower[c], slack.upper[c]};
      m_steps[c][from_b] = {Slot(a), slack.upper[c], slack.lower[c]};
    }
  }
  for (std::size_t c = 0; c < 3; ++c) m_bucket_shift[c] = fitting_shift(m_steps[c]);
}

std::size_t MeshLinks::bytes() const {
  std::size_t total = m_first.capacity() * sizeof(std::size_t);
  for (const auto& steps : m_steps) total += steps.capacity() * sizeof(MeshStep);
  return total;
}

}  // namespace supple
