#include "lib/relax/link_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

std::array<double, kLinkKinds> spring_shares(const Vec3d& spacing_mm, int links) {
  const double across_face = links == 18 ? 1.0 / 6 : 1.0 / 9, across_cell = 1.0 / 36;
  const double volume = spacing_mm.x * spacing_mm.y * spacing_mm.z;
  std::array<double, kLinkKinds> shares{};
  for (int axis = 0; axis < kAxisKinds; ++axis) {
    shares[std::size_t(axis)] =
        spacing_mm[(axis + 1) % 3] * spacing_mm[(axis + 2) % 3] / spacing_mm[axis];
  }
  for (int kind = kAxisKinds; kind < kinds_of(links); ++kind) {
    const int direction = kDirectionOfKind[std::size_t(kind)];
    const LinkStep step = step_of_direction(direction);
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (step[std::size_t(axis)] != 0) longest = std::max(longest, spacing_mm[axis]);
    }
    const double weight = axes_of_direction(direction) == 2 ? across_face : across_cell;
    const double share = weight * volume / (longest * longest);
    shares[std::size_t(kind)] = share;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (step[axis] != 0) shares[axis] -= share;
    }
  }
  return shares;
}

namespace {

constexpr float kUnlimited = std::numeric_limits<float>::infinity();

float limit_of(std::int32_t slack) {
  if (slack >= kUnlimitedSlack) return kUnlimited;
  const float rounded = float(slack);
  return double(rounded) > slack ? std::nextafter(rounded, 0.0f) : rounded;
}

}  // namespace

LinkTable::LinkTable(const Body& body, int coordinate, RigidLinks rigid, int links)
    : m_stride(body.slacks.stride()),
      m_coordinate(coordinate),
      m_links(links),
      m_has_yield(body.material.has_yield_strain()),
      m_rows(std::size_t(kinds_of(links))),
      m_rigid(std::size_t(kinds_of(links))) {
  const MaterialClasses classes(body.material);
  const Vec3d spacing = body.geometry.spacing_mm();
  const auto shares = spring_shares(spacing, links);
  const std::size_t entries = std::size_t(kLastClass) * m_stride + kLastClass + 1;
  for (std::size_t kind = 0; kind < m_rows.size(); ++kind) {
    m_rows[kind].assign(entries + 1, {0, kUnlimited, kUnlimited, kUnlimited});
    m_rigid[kind].assign(entries, 0);
  }
  // In density mode only the sum of the classes counts: class_a 0 and 255 reach all entries.
  for (int a = 0; a <= kLastClass; a += m_stride == 1 ? kLastClass : 1) {
    for (int b = 0; b <= kLastClass; ++b) {
      const std::size_t entry = std::size_t(a) * m_stride + b;
      const LinkPhysics physics = classes.physics(a, b);
      for (std::size_t kind = 0; kind < m_rows.size(); ++kind) {
        const int direction = kDirectionOfKind[kind];
        const std::int32_t upper =
            body.slacks.fall_row(opposite_direction(direction), coordinate)[entry];
        const std::int32_t lower = body.slacks.fall_row(direction, coordinate)[entry];
        m_rigid[kind][entry] = upper == 0 && lower == 0;
        m_has_rigid = m_has_rigid || m_rigid[kind][entry];
        if (m_rigid[kind][entry] && rigid == RigidLinks::absent) continue;
        // Bodies with diagonals have no springs that yield (relaxation.cpp).
        const double yield = kind < kAxisKinds ? physics.yield_strain * spacing[int(kind)] /
                                                     spacing[coordinate] * kFixedOne
                                               : kUnlimited;
        m_rows[kind][entry] = {float(physics.stiffness_kpa * shares[kind]), limit_of(upper),
                               limit_of(lower), float(yield)};
      }
    }
  }
}

std::size_t LinkTable::bytes() const {
  std::size_t total = 0;
  for (std::size_t kind = 0; kind < m_rows.size(); ++kind) {
    total += m_rows[kind].capacity() * sizeof(LinkValues) + m_rigid[kind].capacity();
  }
  return total;
}

}  // namespace supple
