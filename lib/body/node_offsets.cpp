#include "lib/body/node_offsets.h"

#include <cmath>
#include <string>

#include "lib/body/region.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kLargestOffset = 16383;                       // voxels
constexpr int kFractionBits = 16;                              // of an offset's fraction
constexpr double kFineOne = kFixedOne * (1 << kFractionBits);  // 2^-32 voxel

template <class T>
void clear_if_zero(BrickArray<T>& values) {
  if (values == BrickArray<T>()) values.clear();
}

}  // namespace

double offset_with_fraction(const Body& body, int c, Slot slot) {
  const std::size_t n = std::size_t(c);
  return body.q[n].at(slot) / kFixedOne + body.fraction[n].at(slot) / kFineOne;
}

NodeOffsets::NodeOffsets(const Body& body)
    : m_elements(body.elements),
      m_q(body.q),
      m_fraction(body.fraction),
      m_velocity(body.velocity_mm_s) {}

/// Stores the value of a slot; returns true where it was another one before.
template <class T>
bool NodeOffsets::set(BrickArray<T>& values, Slot slot, T value) {
  if (values.at(slot) == value) return false;
  if (values.brick_count() == 0) values.resize(m_elements.brick_count());
  values.set(slot, value);
  return true;
}

double NodeOffsets::set_offset(int c, Slot slot, double voxels) {
  constexpr std::int64_t kHalf = 1 << (kFractionBits - 1);
  if (!(std::abs(voxels) <= kLargestOffset)) {
    throw InputError({"", "voxel " + voxel_text(voxel_of(m_elements, slot)),
                      "an offset of " + number_text(voxels) + " voxels", "at most 16383"});
  }
  const double exact = voxels * kFineOne;
  const std::int64_t fine = std::llround(exact);
  const std::int64_t whole = (fine + kHalf) >> kFractionBits;
  set_whole(c, slot, std::int32_t(whole));
  set(m_fraction[std::size_t(c)], slot, std::int16_t(fine - whole * (1 << kFractionBits)));
  return std::abs(exact - double(fine)) / kFineOne;
}

void NodeOffsets::set_whole(int c, Slot slot, std::int32_t q) {
  m_has_moved |= set(m_q[std::size_t(c)], slot, q);
  set(m_fraction[std::size_t(c)], slot, std::int16_t(0));
}

void NodeOffsets::set_velocity(int c, Slot slot, double mm_s) {
  set(m_velocity[std::size_t(c)], slot, mm_s);
}

void NodeOffsets::give(Body& body) {
  for (auto& fraction : m_fraction) clear_if_zero(fraction);
  for (auto& velocity : m_velocity) clear_if_zero(velocity);
  body.q.swap(m_q);
  body.fraction.swap(m_fraction);
  body.velocity_mm_s.swap(m_velocity);
  if (m_has_moved) body.links_known_valid = false;
}

}  // namespace supple
