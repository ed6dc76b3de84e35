#include "lib/relax/link_table.h"

#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr float kUnlimited = std::numeric_limits<float>::infinity();

float limit_of(std::int32_t slack) {
  if (slack >= kUnlimitedSlack) return kUnlimited;
  const float rounded = float(slack);
  return double(rounded) > slack ? std::nextafter(rounded, 0.0f) : rounded;
}

}  // namespace

LinkTable::LinkTable(const Body& body, int coordinate, RigidLinks rigid)
    : m_stride(body.slacks.stride()),
      m_coordinate(coordinate),
      m_has_yield(body.material.has_yield_strain()) {
  const MaterialClasses classes(body.material);
  const Vec3d spacing = body.geometry.spacing_mm();
  const std::size_t entries = std::size_t(kLastClass) * m_stride + kLastClass + 1;
  for (int axis = 0; axis < 3; ++axis) {
    m_rows[axis].assign(entries + 1, {0, kUnlimited, kUnlimited, kUnlimited});
    m_rigid[axis].assign(entries, 0);
    const double area_per_length =
        spacing[(axis + 1) % 3] * spacing[(axis + 2) % 3] / spacing[axis];
    // In density mode only the sum of the classes counts: class_a 0 and 255 reach all entries.
    for (int a = 0; a <= kLastClass; a += m_stride == 1 ? kLastClass : 1) {
      for (int b = 0; b <= kLastClass; ++b) {
        const std::size_t entry = std::size_t(a) * m_stride + b;
        const std::int32_t upper =
            body.slacks.upper(axis, coordinate, std::uint8_t(a), std::uint8_t(b));
        const std::int32_t lower =
            body.slacks.lower(axis, coordinate, std::uint8_t(a), std::uint8_t(b));
        m_rigid[axis][entry] = upper == 0 && lower == 0;
        m_has_rigid = m_has_rigid || m_rigid[axis][entry];
        if (m_rigid[axis][entry] && rigid == RigidLinks::absent) continue;
        const LinkPhysics physics = classes.physics(a, b);
        m_rows[axis][entry] = {
            float(physics.stiffness_kpa * area_per_length), limit_of(upper), limit_of(lower),
            float(physics.yield_strain * spacing[axis] / spacing[coordinate] * kFixedOne)};
      }
    }
  }
}

std::size_t LinkTable::bytes() const {
  std::size_t total = 0;
  for (int axis = 0; axis < 3; ++axis) {
    total += m_rows[axis].capacity() * sizeof(LinkValues) + m_rigid[axis].capacity();
  }
  return total;
}

}  // namespace supple
