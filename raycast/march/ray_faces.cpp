#include "raycast/march/ray_faces.h"

#include <algorithm>
#include <cmath>

#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Faces of cuts are fitted planes: a sample of the piece may lie kAhead voxels before one, and
// kBefore voxels before one nothing of the piece is left.
constexpr double kAhead = 0.5, kBefore = 0.25;

bool is_near_border(const RenderContext& context, const Vec3d& pos) {
  if (context.border == nullptr) return false;
  for (int a = 0; a < 3; ++a) {
    if (pos[a] < context.border_lo[a] || pos[a] > context.border_hi[a]) return true;
  }
  return false;
}

bool is_beside_cut(const SampleBatch& batch, int lane) {
  return (batch.pointwise | batch.split) >> lane & 1;
}

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
    const Vec3d read_at = samples.read_at(lane);
    for (const IndexClip& clip : context.source_clips) add_clip(clip, read_at);
    if (is_near_border(context, read_at)) add_border(read_at);
    if (is_beside_cut(samples.batch, lane)) add_piece(seen_at, read_at);
  }
  const RayFace& face() const { return m_face; }

 private:
  void add_clip(const IndexClip& clip, const Vec3d& pos) {
    double mm_ago = 0;
    const IndexClip::Plane* plane = face_of(clip, pos, mm_ago);
    if (plane != nullptr) add(as_seen(clip.space(), plane->normal, pos), mm_ago);
  }

  /// A side of the volume's box counts where it cuts something that is seen, not where a ray came
  /// through it into air.
  void add_border(const Vec3d& pos) {
    double mm_ago = 0;
    const IndexClip::Plane* plane = face_of(*m_context.border, pos, mm_ago);
    if (plane == nullptr) return;
    Vec3d came_from = pos;
    for (int a = 0; a < 3; ++a) {
      Vec3d axis(0);
      axis[a] = 1;
      came_from[a] -= mm_ago * rate(ClipSpace::source, axis, pos);
    }
    if (opacity_at(came_from) > 0) add(as_seen(ClipSpace::source, plane->normal, pos), mm_ago);
  }

  /// Opacity of a place of the source, between its voxels.
  float opacity_at(const Vec3d& place) const {
    Vec3d pos;
    for (int a = 0; a < 3; ++a) {
      pos[a] = std::clamp(place[a], 0.0, m_context.geometry.dims()[a] - 1.0);
    }
    const Vec3i cell = floor_voxel(pos);
    const BrickTopology& where = m_context.source.topology();
    const std::int32_t b = where.find(cell);
    if (b < 0) return 0;
    const Vec3i local = cell - where.origin(std::size_t(b));
    const Vec3d part = pos - Vec3d(cell);
    double sum = 0, weights = 0;
    for (int n = 0; n < 8; ++n) {
      const Vec3i corner = cell_corner(n);
      const std::int16_t code = *m_context.source.node(std::size_t(b), local + corner);
      if (code == SourceBricks::kVoid) continue;
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= corner[a] ? part[a] : 1 - part[a];
      sum += weight * code;
      weights += weight;
    }
    return weights > 0 ? m_context.classifier.classify(float(sum / weights))[3] : 0;
  }

  const IndexClip::Plane* face_of(const IndexClip& clip, const Vec3d& pos, double& mm_ago) const {
    return clip.face_behind(
        pos, [&](const Vec3d& normal) { return rate(clip.space(), normal, pos); }, mm_ago);
  }

  /// Takes a covector of `space` at `pos` to the space of the picture.
  Vec3f as_seen(ClipSpace space, const Vec3d& normal, const Vec3d& pos) const {
    if (space == ClipSpace::deformed) return Vec3f(normal);
    return m_context.pull_back(m_samples.batch, m_lane, m_samples.seen_at(m_lane), pos,
                               Vec3f(normal));
  }
  /// Change per mm of the ray of the coordinate that the covector measures.
  double rate(ClipSpace space, const Vec3d& normal, const Vec3d& pos) const {
    return Vec3d(as_seen(space, normal, pos)).dot(direction());
  }

  /// A face counts where it cuts something that is seen, not where a ray came through its plane in
  /// the air beside a lip, nor where other tissue lies against it. The tissue is taken as moved
  /// without turning since the ray crossed it.
  void add_piece(const Vec3d& seen_at, const Vec3d& read_at) {
    Vec3d normal;
    double depth_mm;
    if (!face_of_piece(seen_at, read_at, normal, depth_mm)) return;
    const double gain = normal.dot(direction());  // mm deeper per mm
    if (!(gain > 0)) return;
    const double voxels = depth_mm / normal.length();
    if (voxels < -kAhead) return;
    const double mm_ago = std::max(depth_mm, 0.0) / gain;
    if (share_of(mm_ago) <= m_face.share) return;
    const float cut = opacity_at(read_at - direction() * mm_ago);
    if (!(cut > 0)) return;
    const Vec3d before = seen_at - normal * ((voxels + kBefore) / normal.length());
    const float covered = std::min(opacity_of_others(before, normal) / cut, 1.0f);
    add(Vec3f(normal), mm_ago, 1 - covered);
  }

  bool face_of_piece(const Vec3d& seen_at, const Vec3d& read_at, Vec3d& normal,
                     double& depth_mm) const {
    const PointwiseOffsets& pieces = *m_context.output.pointwise();
    const bool is_interpolated = m_samples.batch.split >> m_lane & 1;
    const std::int32_t piece = is_interpolated ? -1 : m_samples.batch.piece[m_lane];
    if (pieces.face_in_source(piece, read_at, normal, depth_mm)) {
      normal = Vec3d(as_seen(ClipSpace::source, normal, read_at));
      return true;
    }
    return !is_interpolated && pieces.face(piece, seen_at, read_at, normal, depth_mm);
  }

  /// Opacity of a place before a face, unless it lies behind the same face.
  float opacity_of_others(const Vec3d& place, const Vec3d& normal) const {
    const PointwiseOffsets& pieces = *m_context.output.pointwise();
    const std::int32_t brick = pieces.bricks().find(floor_voxel(place));
    PointwiseOffsets::Sample found;
    if (brick < 0 || !pieces.sample(std::size_t(brick), place, found)) return 0;
    const Vec3d read_at = place + found.offset;
    Vec3d own;
    double depth_mm;
    const bool has_face = pieces.face(found.piece, place, read_at, own, depth_mm);
    const bool is_same = has_face && own.dot(normal) > 0.5 * own.length() * normal.length();
    return is_same ? 0 : opacity_at(read_at);
  }

  double voxels_of(double mm) const {
    return mm / m_context.step_mm * m_context.settings.step_voxels;
  }
  float share_of(double mm_ago) const {
    return float(std::clamp(kFaceVoxels + 1 - voxels_of(mm_ago), 0.0, 1.0));
  }

  /// `normal`: index space, of a face that the ray crossed some mm ago; `part` of it is bare.
  void add(const Vec3f& normal, double mm_ago, float part = 1) {
    const float share = part * share_of(mm_ago);
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
  const bool has_clips = !context.settings.clips.empty();
  for (std::uint32_t rest = wanted; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const bool may_have_face = has_clips || is_beside_cut(samples.batch, lane) ||
                               is_near_border(context, samples.read_at(lane));
    if (!may_have_face) continue;
    const RayFace face = FaceSearch(context, samples, towards_eye, lane).face();
    if (face.share == 0) continue;
    lit.faces |= 1u << lane;
    lit.face.set(lane, face.normal);
    lit.face_share[lane] = face.share;
  }
}

}  // namespace supple
