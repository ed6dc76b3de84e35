// Whether what is held of a piece of a body prevents its six rigid motions.
#pragma once

#include <array>
#include <cstdint>

#include "volumes/base/vec.h"

namespace supple {

/// Products of a piece's six rigid motions over its held components.
class RigidSight {
 public:
  /// Adds a node at which the components of `bits` are held.
  void see(const Vec3d& position, std::uint8_t bits);
  bool prevents_all() const;

 private:
  std::array<std::array<double, 6>, 6> m_gram{};
  Vec3d m_about{0, 0, 0};
  bool m_has_any = false;
};

}  // namespace supple
