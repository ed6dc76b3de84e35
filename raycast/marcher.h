// One ray through the bricks (thesis section 3.3.5, figure 3.4; design.md section 5).
//
// Sample n lies at t0 + n * step from the ray's entry into the box, whatever the bricks hold. With
// stride S, block k is the samples (k-1)S+1 … kS; it contributes exactly when the sample before it,
// (k-1)S, or its last one, kS, is not transparent. That is a statement about samples alone:
// skipping empty space leaves out blocks that are known to be transparent and cannot change a
// picture. Cost per sample: one brick look-up when the brick changes, one trilinear read (two when
// deformed); six more planes per axis for the gradient, only where something is visible.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "raycast/camera.h"
#include "raycast/classify.h"
#include "raycast/clip.h"
#include "raycast/embree_bounds.h"
#include "raycast/render.h"
#include "raycast/shading.h"
#include "raycast/surface_scene.h"

namespace supple {

class LightMedium;
class LightPaths;

/// What all rays of a picture share; the bricks outlive it.
struct Frame {
  Frame(const Geometry& geometry, const SourceBricks& source, const OffsetBricks& output,
        const Camera& camera, const TransferFunction& function, const RenderSettings& settings,
        const SurfaceScene* surfaces = nullptr);
  ~Frame();

  /// Encoded density per voxel to density per mm.
  Vec3f to_world(const Vec3f& index_gradient) const;

  const Geometry& geometry;
  const SourceBricks& source;
  const OffsetBricks& output;
  TransferFunction function;
  RenderSettings settings;
  double step_mm;
  Classifier classifier;
  std::vector<std::uint8_t> source_visible, output_visible;  // per brick, under the function
  VisibleBounds bounds;
  Vec3d box_lo, box_hi;                   // index space; rays begin where they enter it
  std::array<Vec3f, 3> gradient_columns;  // encoded index gradient to density per mm, LPS
  Shading shading;
  std::vector<IndexClip> source_clips, deformed_clips;
  const SurfaceScene* surfaces;               // null: none
  std::unique_ptr<const LightMedium> medium;  // null: all light reaches everything
};

/// Finds the brick of a voxel, remembering the last one.
class BrickCursor {
 public:
  explicit BrickCursor(const BrickTopology& topology) : m_topology(topology) {}
  std::int32_t find(const Vec3i& voxel) {
    const Vec3i brick(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3);
    if (brick != m_brick) {
      m_brick = brick;
      m_index = m_topology.find(voxel);
    }
    return m_index;
  }

 private:
  const BrickTopology& m_topology;
  Vec3i m_brick{1 << 30, 1 << 30, 1 << 30};
  std::int32_t m_index = -1;
};

/// What a ray met, see FloatImage.
struct SeenSurface {
  double distance_mm = 0;  // along the ray
  Vec3f normal_lps;
  float offset_mm = 0;
};

/// Marches rays one after another; one per thread.
class Marcher {
 public:
  explicit Marcher(const Frame& frame);
  ~Marcher();

  /// Colour (premultiplied) and opacity.
  Float4 march(const Ray& ray);
  /// What the last ray met; false when its opacity stayed below one half. Reads its sample again.
  bool surface(SeenSurface& seen);
  /// Samples read from the source so far.
  std::int64_t samples() const { return m_samples; }

 private:
  /// One sample: what it read, and where, for its gradient.
  struct Probe {
    Float4 colour{0, 0, 0, 0};
    float encoded = 0;
    bool is_inside = false;  // of a cell whose corners all have a density
    SourceCell source;
    OffsetCell offset;
    std::int32_t piece = -1;  // of a split brick, whose offsets have no cell
    double t;                 // along the ray
    Vec3f face{0, 0, 0};      // of a clip or piece, towards the viewer, where one is near
    float face_share = 0;     // 1: the sample lies at it
    bool visible() const { return colour[3] > 0; }
  };

  void march_volume();
  void find_crossings(const Ray& ray);
  void clip_ray();
  bool is_clipped(double t) const;
  void find_face(const IndexClip& clip, const Vec3d& pos, Probe& probe) const;
  void find_piece_face(Probe& probe) const;
  void set_face(const Vec3f& normal, double mm_ago, Probe& probe) const;
  Vec3f pull_back(const Probe& probe, const Vec3f& gradient) const;
  Probe probe(std::int64_t n);
  bool follow_offset(std::size_t brick, const Vec3i& base, Vec3d& pos, OffsetCell& cell) const;
  bool follow_split(std::size_t brick, Vec3d& pos, std::int32_t& piece) const;
  void march_blocks(std::int64_t first, std::int64_t last);
  void find_maximum(std::int64_t first, std::int64_t last);
  void composite(std::int64_t n, const Probe& probe);
  void composite_between_crossings(double t, const Float4& colour, float alpha);
  void composite_crossing();
  void add(const Float4& colour, float alpha) { m_sum += ((1 - m_sum[3]) * alpha) * colour; }
  const Reach& reach_at(double t, const Facing& facing);
  Vec3f world_gradient(const Probe& probe) const;
  bool has_met_surface() const { return m_surface >= 0 || m_surface_crossing >= 0; }
  bool opaque() const { return m_sum[3] >= m_opaque; }
  double time_of(std::int64_t n) const { return m_entry + double(n) * m_frame.step_mm; }

  const Frame& m_frame;
  BrickCursor m_output_cursor, m_source_cursor;
  std::vector<Interval> m_intervals;
  std::int64_t m_samples = 0;
  float m_opaque;
  bool m_is_maximum;

  std::unique_ptr<LightPaths> m_paths;

  // Of the ray under way.
  Ray m_world_ray;
  IndexRay m_ray;
  double m_entry = 0;
  std::int64_t m_last_sample = -1;
  Interval m_kept{};                     // t of what the deformed space's clips keep,
  std::vector<Interval> m_removed;       // but for these parts
  float m_maximum = 0;                   // encoded, of the samples so far
  std::vector<TriangleHit> m_crossings;  // of meshes, ascending
  std::size_t m_next_crossing = 0;
  double m_next_crossing_t = 0;          // infinite: no more
  double m_end = 0;                      // t of the first opaque crossing
  std::int64_t m_surface = -1;           // the sample that surface() tells of
  std::int64_t m_surface_crossing = -1;  // or the crossing
  Shading::View m_view;
  Float4 m_sum{0, 0, 0, 0};
};

}  // namespace supple
