// An Embree device with one scene of one geometry. Embree is known to the embree_* files alone.
#pragma once

#include <cstddef>

#include <embree3/rtcore.h>

namespace supple {

class EmbreeScene {
 public:
  /// Throws SystemError when Embree gives no device.
  explicit EmbreeScene(RTCGeometryType type);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// The geometry, to be filled before build().
  RTCGeometry geometry() const { return m_geometry; }
  /// Throws SystemError.
  void build(RTCBuildQuality quality);
  /// Traverses the whole scene; the geometry's functions collect the hits.
  void traverse(RTCIntersectContext* context, const float origin[3], const float direction[3],
                float length) const;

 private:
  RTCDevice m_device = nullptr;
  RTCScene m_scene = nullptr;
  RTCGeometry m_geometry = nullptr;
};

}  // namespace supple
