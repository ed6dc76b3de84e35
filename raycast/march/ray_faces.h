// Faces that a ray passed shortly before its samples. Samples just behind a clip are shaded as its
// face: their own gradients belong to the inside of the tissue and would leave opened tissue dark
// and rough. So are those behind the volume's own border, beyond which nothing is known, and those
// of a piece that the ray entered out of a gap.
#pragma once

#include "raycast/march/light_lanes.h"
#include "raycast/march/render_context.h"

namespace supple {

/// Samples of a ray, one in each lane.
struct RaySamples {
  const IndexRay& ray;
  const SampleBatch& batch;
  Vec3i base;  // of the piece that the batch read
  double t_of_first, step_mm;

  double t_of(int lane) const { return t_of_first + lane * step_mm; }
  Vec3d seen_at(int lane) const { return ray.at(t_of(lane)); }
  /// The place at which the lane read the source, index space.
  Vec3d read_at(int lane) const {
    return Vec3d(base) + Vec3d(batch.px[lane], batch.py[lane], batch.pz[lane]);
  }
};

/// Sets the faces of the lanes `wanted`.
void find_faces(const RenderContext& context, const RaySamples& samples, const Vec3f& towards_eye,
                std::uint32_t wanted, LitLanes& lit);

}  // namespace supple
