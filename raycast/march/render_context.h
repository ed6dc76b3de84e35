// Data that all rays of a picture share (design.md section 5): the transfer function as a table,
// the bricks that it leaves visible and their bounds, lights and clips.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "raycast/march/embree_bounds.h"
#include "raycast/march/render_settings.h"
#include "raycast/march/shading.h"
#include "raycast/march/surface_scene.h"
#include "raycast/sample/classify.h"
#include "raycast/sample/sample_batch.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/clip.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class LightMedium;

/// Voxels behind a face that are shaded as the face; one more fades to the tissue's own gradients.
constexpr double kFaceVoxels = 2;

/// Data that all rays of a picture share. The bricks outlive it.
struct RenderContext {
  RenderContext(const Geometry& geometry, const SourceBricks& source, const OffsetBricks& output,
                const Camera& camera, const TransferFunction& function,
                const RenderSettings& settings, const SurfaceScene* surfaces = nullptr);
  ~RenderContext();

  /// Takes a gradient from encoded density per voxel to density per mm.
  Vec3f to_world(const Vec3f& index_gradient) const;
  /// (I + grad o)^T g of a lane that stands for a sample seen at x that reads the
  /// source at y, index space. Derivatives of offsets are continuous where densities are cubic.
  Vec3f pull_back(const SampleBatch& batch, int lane, const Vec3d& x, const Vec3d& y,
                  const Vec3f& gradient) const;

  const Geometry& geometry;
  const SourceBricks& source;
  const OffsetBricks& output;
  TransferFunction function;
  RenderSettings settings;
  double step_mm;
  Classifier classifier;
  std::vector<std::uint8_t> output_visible;  // per brick, under the function
  VisibleBounds bounds;
  Vec3d box_lo, box_hi;                   // index space; rays begin where they enter it
  std::array<Vec3f, 3> gradient_columns;  // encoded index gradient to density per mm, LPS
  Shading shading;
  std::vector<IndexClip> source_clips, deformed_clips;
  /// The volume's own box in the source space, whose sides are faces as those of clips are; null: a
  /// volume of one slice.
  std::unique_ptr<const IndexClip> border;
  Vec3d border_lo, border_hi;  // index space; samples between them lie farther inside than faces do
  const SurfaceScene* surfaces;               // null: none
  std::unique_ptr<const LightMedium> medium;  // null: all light reaches everything
  SamplingTables tables;

 private:
  void find_border();
  void fill_tables();

  std::vector<std::int32_t> m_output_entries, m_source_entries;  // as BrickIndex::lookup's tables
  std::vector<float> m_output_highest;                           // the same; for maxima only
};

}  // namespace supple
