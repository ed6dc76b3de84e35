#include "raycast/march/ray_faces.h"

#include <algorithm>

namespace supple {

namespace {

/// Voxels behind the face of a clip that are shaded as the face; one more fades to the tissue's own
/// gradients.
constexpr double kFaceVoxels = 2;

struct RayFace {
  Vec3f normal{0, 0, 0};  // unit, LPS, towards the viewer
  float share = 0;        // 1: the sample lies at it
};

/// The nearest face behind one lane.
class FaceSearch {
 public:
  FaceSearch(const RenderContext& context, const RaySamples& samples, const Vec3f& towards_eye,
             int lane)
      : m_context(context), m_samples(samples), m_towards_eye(towards_eye), m_lane(lane) {
    const Vec3d seen_at = samples.seen_at(lane);
    for (const IndexClip& clip : context.deformed_clips) add_clip(clip, seen_at);
    for (const IndexClip& clip : context.source_clips) add_clip(clip, samples.read_at(lane));
    if (samples.batch.pointwise >> lane & 1) add_piece(seen_at);
  }
  const RayFace& face() const { return m_face; }

 private:
  void add_clip(const IndexClip& clip, const Vec3d& pos) {
    const auto as_seen = [&](const Vec3d& normal) {
      if (clip.space() == ClipSpace::deformed) return Vec3f(normal);
      return m_context.pull_back(m_samples.batch, m_lane, m_samples.seen_at(m_lane), pos,
                                 Vec3f(normal));
    };
    double mm_ago = 0;
    const IndexClip::Plane* plane = clip.face_behind(
        pos, [&](const Vec3d& normal) { return Vec3d(as_seen(normal)).dot(direction()); }, mm_ago);
    if (plane != nullptr) add(as_seen(plane->normal), mm_ago);
  }

  void add_piece(const Vec3d& pos) {
    Vec3d normal;
    double depth_mm;
    const std::int32_t piece = m_samples.batch.piece[m_lane];
    if (!m_context.output.pointwise()->face(piece, pos, normal, depth_mm)) return;
    const double gain = normal.dot(direction());  // mm deeper per mm
    if (gain > 0) add(Vec3f(normal), depth_mm / gain);
  }

  /// `normal`: index space, of a face that the ray crossed some mm ago.
  void add(const Vec3f& normal, double mm_ago) {
    const double voxels = mm_ago / m_context.step_mm * m_context.settings.step_voxels;
    const float share = float(std::clamp(kFaceVoxels + 1 - voxels, 0.0, 1.0));
    if (share <= m_face.share) return;
    m_face.normal = m_context.to_world(normal).normalized();
    if (m_face.normal.dot(m_towards_eye) < 0) m_face.normal = -m_face.normal;
    m_face.share = share;
  }

  const Vec3d& direction() const { return m_samples.ray.direction; }

  const RenderContext& m_context;
  const RaySamples& m_samples;
  const Vec3f& m_towards_eye;
  int m_lane;
  RayFace m_face;
};

}  // namespace

void find_faces(const RenderContext& context, const RaySamples& samples, const Vec3f& towards_eye,
                std::uint32_t wanted, LitLanes& lit) {
  lit.faces = 0;
  if (context.settings.clips.empty()) wanted &= samples.batch.pointwise;
  for (std::uint32_t rest = wanted; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const RayFace face = FaceSearch(context, samples, towards_eye, lane).face();
    if (face.share == 0) continue;
    lit.faces |= 1u << lane;
    lit.face.set(lane, face.normal);
    lit.face_share[lane] = face.share;
  }
}

}  // namespace supple
