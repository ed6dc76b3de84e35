#include "lib/relax/fine_offsets.h"

#include <algorithm>
#include <cmath>

#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Takes fractions back until every link and bound holds.
class FractionFilter {
 public:
  FractionFilter(const Body& body, const LinkTable& table, BrickArray<double>& fine)
      : m_body(body), m_table(table), m_c(std::size_t(table.coordinate())), m_fine(fine) {}

  void keep_bounds(const std::vector<Bound>& at_least, const std::vector<Bound>& at_most) {
    for (const Bound& bound : at_least) {
      if (m_fine.at(bound.slot) < bound.value * kFinePerUnit) drop(bound.slot);
    }
    for (const Bound& bound : at_most) {
      if (m_fine.at(bound.slot) > bound.value * kFinePerUnit) drop(bound.slot);
    }
  }

  /// Takes the fractions at broken links back. That may break the next link, so it is repeated
  /// until nothing changes; without any fraction all hold.
  void keep_links() {
    const auto& fractions = m_body.fraction[m_c];
    std::vector<char> due(m_body.elements.brick_count(), 0);
    for (std::size_t b = 0; b < fractions.brick_count(); ++b) {
      if (fractions.brick(b) != nullptr) add_due(b, due);
    }
    while (true) {
      std::vector<std::uint32_t> bricks;
      for (std::size_t b = 0; b < due.size(); ++b) {
        if (due[b]) bricks.push_back(std::uint32_t(b));
      }
      std::vector<std::vector<Slot>> broken(bricks.size());
      parallel_for(bricks.size(), Grain{4},
                   [&](std::size_t n) { broken[n] = ends_of_broken_links(bricks[n]); });
      std::fill(due.begin(), due.end(), 0);
      bool is_done = true;
      for (const std::vector<Slot>& ends : broken) {
        for (const Slot end : ends) {
          if (!drop(end)) continue;
          is_done = false;
          add_due(end / kBrickVoxels, due);
        }
      }
      if (is_done) return;
    }
  }

 private:
  /// Takes the fraction of an element back; returns true where there was one.
  bool drop(Slot slot) {
    const double whole = m_body.q[m_c].at(slot) * kFinePerUnit;
    if (m_fine.at(slot) == whole) return false;
    m_fine.set(slot, whole);
    return true;
  }

  /// Marks the bricks whose links, counted at their lower ends, meet brick b.
  void add_due(std::size_t b, std::vector<char>& due) const {
    due[b] = 1;
    if (m_table.links() != 6) {
      for (const std::int32_t other : neighbours_of(m_body.elements, b)) {
        if (other >= 0) due[std::size_t(other)] = 1;
      }
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t lower = m_body.elements.neighbour(b, 2 * axis);
      if (lower >= 0) due[std::size_t(lower)] = 1;
    }
  }

  std::vector<Slot> ends_of_broken_links(std::size_t b) const {
    std::vector<Slot> ends;
    for_each_link(m_body, m_table.links(), b, [&](int kind, Slot low, Slot high) {
      if (holds(kind, low, high)) return;
      ends.push_back(low);
      ends.push_back(high);
    });
    return ends;
  }

  bool holds(int kind, Slot low, Slot high) const {
    const std::uint8_t a = m_body.classes[low], b = m_body.classes[high];
    const double stretch = m_fine.at(high) - m_fine.at(low);
    if (m_table.is_rigid(kind, a, b)) return stretch == 0;
    const LinkValues& limits = m_table.values(kind, a, b);
    return stretch <= limits.upper * kFinePerUnit && -stretch <= limits.lower * kFinePerUnit;
  }

  const Body& m_body;
  const LinkTable& m_table;
  const std::size_t m_c;
  BrickArray<double>& m_fine;
};

}  // namespace

BrickArray<double> fine_offsets(const Body& body, const LinkTable& table, const Holds& held) {
  const std::size_t c = std::size_t(table.coordinate());
  BrickArray<double> fine(body.elements.brick_count());
  const auto& fractions = body.fraction[c];
  for (std::size_t b = 0; b < fine.brick_count(); ++b) {
    if (body.q[c].brick(b) == nullptr && fractions.brick(b) == nullptr) continue;
    const std::int32_t* values = body.q[c].brick_or_zero(b);
    const std::int16_t* parts = fractions.brick_or_zero(b);
    double* sums = fine.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) sums[n] = values[n] * kFinePerUnit + parts[n];
  }
  if (fractions.empty()) return fine;
  FractionFilter filter(body, table, fine);
  filter.keep_bounds(held.at_least[c], held.at_most[c]);
  filter.keep_links();
  return fine;
}

void store_fine(const BrickArray<double>& fine, int coordinate, Body& body) {
  BrickValues& q = body.q[std::size_t(coordinate)];
  BrickArray<std::int16_t>& fractions = body.fraction[std::size_t(coordinate)];
  q.resize(fine.brick_count());
  fractions.resize(fine.brick_count());
  constexpr double kHalf = kFinePerUnit / 2;
  for (std::size_t b = 0; b < fine.brick_count(); ++b) {
    const double* from = fine.brick(b);
    if (from == nullptr) continue;
    std::int32_t whole[kBrickVoxels];
    std::int16_t part[kBrickVoxels];
    for (int n = 0; n < kBrickVoxels; ++n) {
      const double rounded = std::floor(from[n] / kFinePerUnit + 0.5);
      const double within = std::clamp(rounded, -double(kMaxOffset), double(kMaxOffset));
      whole[n] = std::int32_t(within);
      part[n] = std::int16_t(std::clamp(from[n] - within * kFinePerUnit, -kHalf, kHalf - 1));
    }
    const auto is_zero = [](auto value) { return value == 0; };
    if (q.brick(b) != nullptr || !std::all_of(whole, whole + kBrickVoxels, is_zero)) {
      std::copy_n(whole, kBrickVoxels, q.touch(b));
    }
    if (fractions.brick(b) != nullptr || !std::all_of(part, part + kBrickVoxels, is_zero)) {
      std::copy_n(part, kBrickVoxels, fractions.touch(b));
    }
  }
}

}  // namespace supple
