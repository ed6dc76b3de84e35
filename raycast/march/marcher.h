// One ray through the bricks (thesis section 3.3.5, figure 3.4; design.md section 5).
//
// Sample n lies at t0 + (n + shift) * step, t0 the ray's entry into the box, whatever bricks hold.
// With stride S, block k is the samples (k-1)S+1 … kS; it contributes exactly when the sample
// before it, (k-1)S, or its last one, kS, is not transparent. That is a statement about samples
// alone: skipping empty space leaves out blocks that are known to be transparent and cannot change
// a picture. Samples are read sixteen at a time: the last ones of blocks first, then those between.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "raycast/march/light_lanes.h"
#include "raycast/march/ray_crossings.h"
#include "raycast/march/ray_faces.h"
#include "raycast/march/render_context.h"

namespace supple {

class LightPaths;

/// Surface that a ray met, see FloatImage.
struct SeenSurface {
  double distance_mm = 0;  // along the ray
  Vec3f normal_lps;
  float offset_mm = 0;
  int surface = -1;  // its index among the surfaces; -1: the volume
};

/// Marches rays one after another; one per thread.
class Marcher {
 public:
  explicit Marcher(const RenderContext& context);
  ~Marcher();

  /// Colour (premultiplied) and opacity. `shift`, 0 … 1: where the samples begin within a step.
  Float4 march(const Ray& ray, float shift = 0);
  /// Surface that the last ray met; false when its opacity stayed below one half. Reads its sample
  /// again.
  bool surface(SeenSurface& seen);
  /// Distance along the last ray, in mm, at which it had become opaque: nothing behind could have
  /// changed its colour. Endless where it did not.
  double opaque_from() const { return m_opaque_from; }
  /// Samples read from the source so far.
  std::int64_t samples() const { return m_samples; }

 private:
  void march_volume(float shift);
  int count_in_piece(std::int64_t first, int stride, std::int64_t last) const;
  void read(std::int64_t first, int stride, int count, SampleBatch& batch);
  void leave_out_clipped(std::int64_t first, int stride, SampleBatch& batch) const;
  void march_blocks(std::int64_t first, std::int64_t last);
  void composite_samples(std::int64_t first, std::int64_t last);
  std::uint32_t seen_between(const SampleBatch& batch, float before) const;
  void composite(int lane, std::int64_t n, float before);
  void composite_between_crossings(double t, const Float4& colour, float alpha);
  void composite_crossing();
  void add(const Float4& colour, float alpha) { m_sum += ((1 - m_sum[3]) * alpha) * colour; }
  static double part_to_surface(float before, float alpha);
  const LightReached& reach_at(double t, const Facing& facing);
  void find_maximum(std::int64_t first, std::int64_t last);
  void find_gradients(std::uint32_t lanes, bool has_before);
  std::uint32_t light(std::uint32_t lanes, std::int64_t first);
  void average_gradients(std::uint32_t lanes);
  double time_of(std::int64_t n) const { return m_entry + double(n) * m_context.step_mm; }
  /// Sample `first` is in lane 0, first + stride in lane 1.
  RaySamples samples_of(const SampleBatch& batch, std::int64_t first, int stride = 1) const {
    return {m_ray, batch, m_piece.base, time_of(first), stride * m_context.step_mm};
  }
  bool has_met_surface() const { return m_surface >= 0 || m_surface_crossing >= 0; }
  bool opaque() const { return m_sum[3] >= m_opaque; }

  const RenderContext& m_context;
  std::vector<Interval> m_intervals;
  std::int64_t m_samples = 0;
  float m_opaque;
  bool m_is_maximum, m_is_shaded, m_is_integrated, m_needs_gradient;
  std::unique_ptr<LightPaths> m_paths;

  // State of the ray that is being marched.
  Ray m_world_ray;
  IndexRay m_ray;
  double m_entry = 0;
  double m_opaque_from = kEndless;
  std::int64_t m_last_sample = -1;
  RayClips m_clips;
  RayCrossings m_crossings;
  float m_maximum = 0;                   // encoded, of the samples so far
  std::int64_t m_surface = -1;           // the sample that surface() tells of
  double m_surface_t = 0;                // where in its step
  std::int64_t m_surface_crossing = -1;  // or the crossing
  Shading::View m_view;
  Float4 m_sum{0, 0, 0, 0};
  std::int64_t m_piece_number = -1;
  RayPiece m_piece;
  SampleBatch m_ends, m_samples_between, m_before;
  LitLanes m_lit;  // of the samples between
};

}  // namespace supple
