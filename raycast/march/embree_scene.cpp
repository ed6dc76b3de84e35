#include "raycast/march/embree_scene.h"

#include <new>

#include "volumes/base/error.h"
#include "volumes/base/memory.h"

namespace supple {

namespace {

// Embree crashes where its own threads and arenas find no room.
constexpr std::int64_t kWorkingBytes = std::int64_t(64) << 20;

RTCDevice new_device() {
  require_memory(kWorkingBytes);
  return rtcNewDevice(nullptr);
}

}  // namespace

EmbreeScene::EmbreeScene(RTCGeometryType type) : m_device(new_device()) {
  if (m_device == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) {
    throw std::bad_alloc();
  }
  if (m_device == nullptr) throw SystemError("Embree: no device");
  m_scene = rtcNewScene(m_device);
  m_geometry = rtcNewGeometry(m_device, type);
}

EmbreeScene::~EmbreeScene() {
  if (m_geometry != nullptr) rtcReleaseGeometry(m_geometry);
  if (m_scene != nullptr) rtcReleaseScene(m_scene);
  if (m_device != nullptr) rtcReleaseDevice(m_device);
}

void EmbreeScene::build(RTCBuildQuality quality) {
  rtcSetSceneBuildQuality(m_scene, quality);
  rtcSetSceneFlags(m_scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitGeometry(m_geometry);
  rtcAttachGeometry(m_scene, m_geometry);
  rtcCommitScene(m_scene);
  if (rtcGetDeviceError(m_device) != RTC_ERROR_NONE) {
    throw SystemError("Embree: cannot build the scene");
  }
}

void EmbreeScene::traverse(RTCIntersectContext* context, const float origin[3],
                           const float direction[3], float length) const {
  RTCRayHit query{};
  query.ray.org_x = origin[0], query.ray.org_y = origin[1], query.ray.org_z = origin[2];
  query.ray.dir_x = direction[0], query.ray.dir_y = direction[1], query.ray.dir_z = direction[2];
  query.ray.tnear = 0;
  query.ray.tfar = length;
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(m_scene, context, &query);
}

}  // namespace supple
