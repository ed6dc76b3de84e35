#include "raycast/microscope/shape_scene.h"

#include <cmath>
#include <cstring>

#include <embree3/rtcore.h>

#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

// Embree crashes where its own threads and arenas find no room.
constexpr std::int64_t kEmbreeBytes = std::int64_t(64) << 20;

/// Dimming is added up as a whole number, which the order of hits does not change.
constexpr double kDimSteps = 1 << 16;  // for each halving
constexpr double kLeastPart = 1e-6;    // of light, which counts as none

/// The shape's part of the light as steps of dimming.
int dim_steps(double part) {
  return int(std::lround(-std::log2(std::max(part, kLeastPart)) * kDimSteps));
}

struct SceneShape {
  ShapeShadow shadow;
  int dim_steps = 0;
  ShapeMotion motion;
  RTCScene scene = nullptr;
  RTCGeometry instance = nullptr;
  bool has_triangles = false;
  CasterBox box{{}, {}};
  std::vector<Vec3f> vertices;  // before its motion
  Triangles triangles;
  std::vector<Vec3f> corner_normals;
};

struct DimmingContext {
  RTCIntersectContext context;
  std::int32_t* steps;  // of each ray
};

/// Lets light pass a triangle that dims it.
void dim_light(const RTCFilterFunctionNArguments* hit) {
  const auto* shape = static_cast<const SceneShape*>(hit->geometryUserPtr);
  std::int32_t* steps = reinterpret_cast<DimmingContext*>(hit->context)->steps;
  for (unsigned n = 0; n < hit->N; ++n) {
    if (hit->valid[n] == 0) continue;
    hit->valid[n] = 0;
    steps[RTCRayN_id(hit->ray, hit->N, n)] += shape->dim_steps;
  }
}

/// The rays from `first` on, for Embree's packets of 8 or 16.
template <int count, class Packet>
void fill(const PacketRays& rays, int first, int* valid, Packet& packet) {
  const auto copy = [&](const LaneFloats& from, float* to) {
    std::memcpy(to, from.of + first, count * sizeof(float));
  };
  copy(rays.origin.x, packet.org_x);
  copy(rays.origin.y, packet.org_y);
  copy(rays.origin.z, packet.org_z);
  copy(rays.direction.x, packet.dir_x);
  copy(rays.direction.y, packet.dir_y);
  copy(rays.direction.z, packet.dir_z);
  copy(rays.near, packet.tnear);
  copy(rays.far, packet.tfar);
  for (int n = 0; n < count; ++n) {
    valid[n] = (rays.active >> (first + n) & 1) != 0 ? -1 : 0;
    packet.time[n] = 0;
    packet.mask[n] = 0xffffffffu;
    packet.id[n] = unsigned(first + n);
    packet.flags[n] = 0;
  }
}

template <int count, class Packet, class Trace>
void first_hits_of(const PacketRays& rays, int first, const Trace& trace, PacketHits& hits) {
  alignas(64) int valid[count];
  Packet packet;
  fill<count>(rays, first, valid, packet.ray);
  for (int n = 0; n < count; ++n) {
    packet.hit.geomID[n] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][n] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  trace(valid, &context, &packet);
  std::uint32_t met = 0;
  for (int n = 0; n < count; ++n) {
    const bool is_met = (valid[n] != 0) & (packet.hit.geomID[n] != RTC_INVALID_GEOMETRY_ID);
    met |= std::uint32_t(is_met) << n;
  }
  hits.met |= met << first;
  if (met == 0) return;
  std::memcpy(hits.distance.of + first, packet.ray.tfar, sizeof packet.ray.tfar);
  std::memcpy(hits.shape + first, packet.hit.instID[0], sizeof packet.hit.instID[0]);
  std::memcpy(hits.triangle + first, packet.hit.primID, sizeof packet.hit.primID);
  std::memcpy(hits.u.of + first, packet.hit.u, sizeof packet.hit.u);
  std::memcpy(hits.v.of + first, packet.hit.v, sizeof packet.hit.v);
}

// Without the flag for coherent rays: with it, occlusion among instances never returned (Embree
// 3.13.5).
template <int count, class Packet, class Trace>
void passing_of(const PacketRays& rays, int first, const Trace& trace, LaneFloats& part) {
  alignas(64) int valid[count];
  Packet packet;
  fill<count>(rays, first, valid, packet);
  std::int32_t steps[kPacketRays] = {};
  DimmingContext dimming;
  rtcInitIntersectContext(&dimming.context);
  dimming.context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  dimming.steps = steps;
  trace(valid, &dimming.context, &packet);
  std::int32_t dimmed_by = 0;
  float dimmed = 1;
  for (int n = 0; n < count; ++n) {
    const int lane = first + n;
    if (steps[lane] != dimmed_by) {
      dimmed_by = steps[lane];
      dimmed = std::exp2(-float(dimmed_by) / float(kDimSteps));
    }
    const bool is_blocked = valid[n] != 0 && packet.tfar[n] < 0;
    part[lane] = is_blocked ? 0.0f : dimmed;
  }
}

void require_good(const std::vector<Vec3d>& vertices_mm, const Triangles& triangles) {
  for (const Vec3d& vertex : vertices_mm) {
    if (!is_finite(vertex)) {
      throw InputError({"", "vertex of a mesh", to_text(vertex, " "), "three finite numbers"});
    }
  }
  for (const auto& triangle : triangles) {
    for (const int index : triangle) {
      if (index < 0 || std::size_t(index) >= vertices_mm.size()) {
        throw InputError(
            {"", "corner of a triangle", std::to_string(index),
             "the number of one of " + std::to_string(vertices_mm.size()) + " vertices"});
      }
    }
  }
}

}  // namespace

struct ShapeScene::Impl {
  RTCDevice device = nullptr;
  RTCScene seen = nullptr, casters = nullptr;
  std::vector<std::unique_ptr<SceneShape>> shapes;
  std::vector<CasterBox> caster_boxes;  // as of the last commit
  bool has_16 = false;                  // rays natively
  bool is_changed = false, has_casters = false;

  void require_no_error() const {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
      throw SystemError("Embree: cannot build the scene");
    }
  }
  bool casts(const SceneShape& shape) const { return shape.shadow.blocks || shape.dim_steps > 0; }
};

ShapeScene::ShapeScene() : m_impl(std::make_unique<Impl>()) {
  require_memory(kEmbreeBytes);
  m_impl->device = rtcNewDevice(nullptr);
  if (m_impl->device == nullptr) throw SystemError("Embree: no device");
  m_impl->has_16 =
      rtcGetDeviceProperty(m_impl->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  m_impl->seen = rtcNewScene(m_impl->device);
  m_impl->casters = rtcNewScene(m_impl->device);
  rtcCommitScene(m_impl->seen);
  rtcCommitScene(m_impl->casters);
}

ShapeScene::~ShapeScene() {
  rtcReleaseScene(m_impl->seen);
  rtcReleaseScene(m_impl->casters);
  for (const auto& shape : m_impl->shapes) {
    rtcReleaseGeometry(shape->instance);
    rtcReleaseScene(shape->scene);
  }
  rtcReleaseDevice(m_impl->device);
}

int ShapeScene::add(const ShapeShadow& shadow) {
  const auto number = unsigned(m_impl->shapes.size());
  auto shape = std::make_unique<SceneShape>();
  shape->shadow = shadow;
  shape->dim_steps = shadow.blocks ? 0 : dim_steps(shadow.dims);
  shape->scene = rtcNewScene(m_impl->device);
  shape->instance = rtcNewGeometry(m_impl->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(shape->instance, shape->scene);
  rtcAttachGeometryByID(m_impl->seen, shape->instance, number);
  if (m_impl->casts(*shape)) rtcAttachGeometryByID(m_impl->casters, shape->instance, number);
  m_impl->shapes.push_back(std::move(shape));
  place(int(number), {});
  return int(number);
}

void ShapeScene::shape(int number, const std::vector<Vec3d>& vertices_mm,
                       const Triangles& triangles, double crease_degrees, bool is_rigid) {
  require_good(vertices_mm, triangles);
  SceneShape& shape = *m_impl->shapes.at(std::size_t(number));
  if (shape.has_triangles) rtcDetachGeometry(shape.scene, 0);
  shape.has_triangles = !triangles.empty();
  shape.box = CasterBox(vertices_mm, shape.motion);
  shape.vertices.assign(vertices_mm.begin(), vertices_mm.end());
  shape.triangles = triangles;
  shape.corner_normals = corner_normals(vertices_mm, triangles, crease_degrees);
  m_impl->is_changed = true;
  if (shape.has_triangles) {
    const RTCGeometry mesh = rtcNewGeometry(m_impl->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* places = static_cast<float*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices_mm.size()));
    for (const Vec3d& vertex : vertices_mm) {
      for (int c = 0; c < 3; ++c) *places++ = float(vertex[c]);
    }
    void* corners = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(int), triangles.size());
    std::memcpy(corners, triangles.data(), triangles.size() * sizeof triangles[0]);
    if (shape.dim_steps > 0) rtcSetGeometryOccludedFilterFunction(mesh, dim_light);
    rtcSetGeometryUserData(mesh, &shape);
    // A rough tree is faster to build and to hit once than one that is kept and refitted.
    const RTCBuildQuality quality = is_rigid ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW;
    rtcSetGeometryBuildQuality(mesh, quality);
    rtcSetSceneBuildQuality(shape.scene, quality);
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(shape.scene, mesh, 0);
    rtcReleaseGeometry(mesh);
  }
  rtcCommitScene(shape.scene);
  if (shape.has_triangles)
    rtcEnableGeometry(shape.instance);
  else
    rtcDisableGeometry(shape.instance);
  rtcCommitGeometry(shape.instance);
  m_impl->require_no_error();
}

void ShapeScene::place(int number, const ShapeMotion& motion) {
  SceneShape& shape = *m_impl->shapes.at(std::size_t(number));
  shape.motion = motion;
  shape.box.move(motion);
  const float columns[12] = {motion.x.x, motion.x.y,      motion.x.z,      motion.y.x,
                             motion.y.y, motion.y.z,      motion.z.x,      motion.z.y,
                             motion.z.z, motion.origin.x, motion.origin.y, motion.origin.z};
  rtcSetGeometryTransform(shape.instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(shape.instance);
  m_impl->is_changed = true;
}

void ShapeScene::commit() {
  if (!m_impl->is_changed) return;
  m_impl->has_casters = false;
  m_impl->caster_boxes.clear();
  for (const auto& shape : m_impl->shapes) {
    if (!shape->has_triangles) rtcDisableGeometry(shape->instance);
    if (!shape->has_triangles || !m_impl->casts(*shape)) continue;
    m_impl->has_casters = true;
    m_impl->caster_boxes.push_back(shape->box);
  }
  rtcCommitScene(m_impl->seen);
  rtcCommitScene(m_impl->casters);
  m_impl->require_no_error();
  m_impl->is_changed = false;
}

void ShapeScene::mark_seen(SeenBlocks& seen) const {
  std::vector<Vec3f> moved;
  for (const auto& shape : m_impl->shapes) {
    moved.clear();
    const ShapeMotion& motion = shape->motion;
    for (const Vec3f& vertex : shape->vertices) {
      moved.push_back(motion.turned(vertex) + motion.origin);
    }
    seen.add(moved, shape->triangles);
  }
}

void ShapeScene::first_hits(const PacketRays& rays, PacketHits& hits) const {
  hits.met = 0;
  if (m_impl->shapes.empty() || rays.active == 0) return;
  if (m_impl->has_16) {
    const auto trace = [&](const int* valid, RTCIntersectContext* context, RTCRayHit16* packet) {
      rtcIntersect16(valid, m_impl->seen, context, packet);
    };
    return first_hits_of<16, RTCRayHit16>(rays, 0, trace, hits);
  }
  const auto trace = [&](const int* valid, RTCIntersectContext* context, RTCRayHit8* packet) {
    rtcIntersect8(valid, m_impl->seen, context, packet);
  };
  first_hits_of<8, RTCRayHit8>(rays, 0, trace, hits);
  first_hits_of<8, RTCRayHit8>(rays, 8, trace, hits);
}

Vec3f ShapeScene::normal(const PacketHits& hits, int lane) const {
  const SceneShape& shape = *m_impl->shapes[std::size_t(hits.shape[lane])];
  const Vec3f* corners = &shape.corner_normals[3 * std::size_t(hits.triangle[lane])];
  const float u = hits.u[lane], v = hits.v[lane];
  const Vec3f mixed = corners[0] * (1 - u - v) + corners[1] * u + corners[2] * v;
  const Vec3f turned = shape.motion.turned(mixed);
  return turned / std::max(turned.length(), 1e-20f);
}

bool ShapeScene::may_shade(const PacketPlaces& places, std::uint32_t wanted, const Vec3f& light,
                           float reach_mm) const {
  if (!m_impl->has_casters) return false;
  const WideSegment segment = segment_between(places, wanted, light, reach_mm);
  for (const CasterBox& box : m_impl->caster_boxes) {
    if (box.may_meet(segment)) return true;
  }
  return false;
}

void ShapeScene::passing(const PacketRays& rays, LaneFloats& part) const {
  if (!m_impl->has_casters || rays.active == 0) {
    for (float& p : part.of) p = 1;
    return;
  }
  if (m_impl->has_16) {
    const auto trace = [&](const int* valid, RTCIntersectContext* context, RTCRay16* packet) {
      rtcOccluded16(valid, m_impl->casters, context, packet);
    };
    return passing_of<16, RTCRay16>(rays, 0, trace, part);
  }
  const auto trace = [&](const int* valid, RTCIntersectContext* context, RTCRay8* packet) {
    rtcOccluded8(valid, m_impl->casters, context, packet);
  };
  passing_of<8, RTCRay8>(rays, 0, trace, part);
  passing_of<8, RTCRay8>(rays, 8, trace, part);
}

}  // namespace supple
