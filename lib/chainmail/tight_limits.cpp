#include "lib/chainmail/tight_limits.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// The factor by which a length differs from 1, either way.
double strength(double length) {
  return std::max(length, 1 / length);
}

/// Sum over an element's links along each axis: by how much they are longer than at rest, in 2^-16
/// voxel, and how many these are. Two links span the difference of two offsets, which fits.
struct LinkSums {
  std::array<std::int32_t, 3> stretch{};
  std::array<std::uint8_t, 3> count{};
};

LinkSums link_sums(const Body& body, const LinkOffsets& q, Slot slot) {
  LinkSums sums;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int32_t places[2];
    for (const bool ahead : {false, true}) {
      places[ahead] = q[axis].at(slot);
      Slot other;
      if (!neighbour_slot(body.elements, body.cuts, slot, int(axis), ahead, other)) continue;
      places[ahead] = q[axis].at(other);
      ++sums.count[axis];
    }
    sums.stretch[axis] = places[1] - places[0];
  }
  return sums;
}

/// Mean length of the links along `axis` at both elements; 1 without any.
double mean_length(const LinkSums& a, const LinkSums& b, std::size_t axis) {
  const int count = a.count[axis] + b.count[axis];
  if (count == 0) return 1;
  return 1 + (double(a.stretch[axis]) + b.stretch[axis]) / (count * kFixedOne);
}

/// The material's own range.
StretchRange range_of(const Body& body, int axis, Slot low, Slot high) {
  const std::uint8_t a = body.classes[low], b = body.classes[high];
  return {-body.slacks.lower(axis, axis, a, b), body.slacks.upper(axis, axis, a, b)};
}

/// The change of a length that brings it into the range.
std::int32_t missing_in(const StretchRange& range, std::int32_t stretch) {
  return std::clamp(stretch, range.least, range.most) - stretch;
}

/// Bricks with a stored offset, their neighbours, and theirs: a link is tightened by one that ends
/// at most a diagonal away.
std::vector<std::uint8_t> bricks_near_offsets(const Body& body, const LinkOffsets& q) {
  const std::size_t count = body.elements.brick_count();
  std::vector<std::uint8_t> near(count);
  for (std::size_t b = 0; b < count; ++b) {
    near[b] = std::any_of(q.begin(), q.end(),
                          [&](const BrickValues& values) { return values.brick(b) != nullptr; });
  }
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::uint8_t> before = near;
    for (std::size_t b = 0; b < count; ++b) {
      for (int face = 0; face < 6; ++face) {
        const std::int32_t other = body.elements.neighbour(b, face);
        if (other >= 0 && before[std::size_t(other)] != 0) near[b] = 1;
      }
    }
  }
  return near;
}

/// Square of an excess, in 2^-24 voxel^2; that of 8 voxels for more, so that no sum overflows.
std::int64_t square_of(std::int64_t excess) {
  const std::int64_t rounded = std::min<std::int64_t>((excess + 8) >> 4, 1 << 15);
  return rounded * rounded;
}

TightCheck sum_of(const TightCheck& a, const TightCheck& b) {
  return {a.links + b.links, a.violated + b.violated, std::max(a.worst, b.worst),
          a.squares + b.squares};
}

/// tight_range() of a link whose ends have these sums.
TightRange range_between(const Body& body, const LinkOffsets& q, int axis, Slot low, Slot high,
                         const LinkSums& at_low, const LinkSums& at_high) {
  const StretchRange own = range_of(body, axis, low, high);
  double driving = 1;
  for (int across = 0; across < 3; ++across) {
    if (across == axis) continue;
    const double length = mean_length(at_low, at_high, std::size_t(across));
    if (strength(length) > strength(driving)) driving = length;
  }
  const BrickValues& along = q[std::size_t(axis)];
  const double length = 1 + (double(along.at(high)) - along.at(low)) / kFixedOne;
  if (!(strength(driving) > strength(length))) return {own, false};

  const double wanted = std::round((1 / std::sqrt(driving) - 1) * kFixedOne);
  const auto limit = std::int32_t(std::clamp(wanted, double(own.least), double(own.most)));
  if (driving > 1) return {{own.least, limit}, limit < own.most};
  return {{limit, own.most}, limit > own.least};
}

/// The sums of all elements near offsets, found once for the links that share them.
class SumsNearOffsets {
 public:
  SumsNearOffsets(const Body& body, const LinkOffsets& q, const std::vector<std::uint8_t>& near)
      : m_body(body), m_q(q), m_of_brick(near.size()) {
    parallel_for(near.size(), Grain{8}, [&](std::size_t b) {
      if (near[b] == 0) return;
      m_of_brick[b].resize(kBrickVoxels);
      for_each_active(body.elements.mask(b), [&](int offset) {
        m_of_brick[b][std::size_t(offset)] =
            link_sums(body, q, Slot(b * kBrickVoxels + std::size_t(offset)));
      });
    });
  }

  LinkSums of(Slot slot) const {
    const std::vector<LinkSums>& sums = m_of_brick[slot / kBrickVoxels];
    return sums.empty() ? link_sums(m_body, m_q, slot) : sums[slot % kBrickVoxels];
  }

 private:
  const Body& m_body;
  const LinkOffsets& m_q;
  std::vector<std::vector<LinkSums>> m_of_brick;  // empty where all is at rest
};

}  // namespace

double TightCheck::norm_voxels() const {
  return std::sqrt(double(squares)) / 4096;
}

TightRange tight_range(const Body& body, const LinkOffsets& q, int axis, Slot low, Slot high) {
  return range_between(body, q, axis, low, high, link_sums(body, q, low), link_sums(body, q, high));
}

TightCheck check_tight(const Body& body, const LinkOffsets& q, double tolerance,
                       LinkOffsets& missing) {
  const std::vector<std::uint8_t> near = bricks_near_offsets(body, q);
  for (BrickValues& values : missing) {
    values = BrickValues(body.elements.brick_count());
    for (std::size_t b = 0; b < near.size(); ++b) {
      if (near[b] != 0) values.touch(b);
    }
  }
  const SumsNearOffsets sums(body, q, near);
  const auto allowed = std::int64_t(tolerance * kFixedOne);
  return parallel_reduce(
      near.size(), Grain{8}, TightCheck{},
      [&](std::size_t b, TightCheck& check) {
        if (near[b] == 0) return;
        for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
          const TightRange tight =
              range_between(body, q, axis, low, high, sums.of(low), sums.of(high));
          const BrickValues& along = q[std::size_t(axis)];
          const std::int32_t change = missing_in(tight, along.at(high) - along.at(low));
          missing[std::size_t(axis)].touch(b)[low % kBrickVoxels] = change;
          const std::int64_t excess = std::abs(std::int64_t(change));
          check = sum_of(check, {tight.is_tightened, excess > allowed, excess, square_of(excess)});
        });
      },
      sum_of);
}

}  // namespace supple
