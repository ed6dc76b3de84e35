// The free-sampling ray marcher (thesis section 3.3.5, figure 3.4; design.md section 5): each
// sample at x reads the source at x + o(x). Straight rendering is the same code without offsets.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "raycast/march/render_settings.h"
#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/surface.h"
#include "raycast/scene/transfer_function.h"
#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/density_grid.h"

namespace supple {

class PointwiseOffsets;
struct RenderContext;

/// Offsets that the renderer keeps: all, or every second along each axis in a sixth of the memory.
enum class OffsetResolution { full, half };

struct RenderReport {
  std::int64_t samples = 0;  // read from the source
  std::int64_t rays = 0;
  double prepare_ms = 0;  // classification and bounds
  double march_ms = 0;
  std::size_t bytes = 0;  // sampling bricks and bounds
};

/// Owns the sampling bricks of one source volume (int16 with apron) and, once offsets are set, the
/// offset bricks and Embree bounds of the deformed volume.
class Renderer {
 public:
  /// `density` is sampled where it is active and empty elsewhere; the renderer shares it and copies
  /// the bricks that rays read. A volume as loaded leaves out the voxels at the file's minimum,
  /// which are air, not void: `background_rings` > 0 (at most 8) samples the background in that
  /// many rings around the active voxels, inside the box. Two rings give surfaces beside such air
  /// the densities and gradients that a state keeps in its shell; none are wanted for a state.
  /// `interpolation`: how densities between voxels are read; cubic ones, and their gradients,
  /// are smoother than voxels and the terraces of thick slices, and march about twice as long.
  Renderer(const Geometry& geometry, const DensityGrid& density, int background_rings = 0,
           Interpolation interpolation = Interpolation::linear);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Replaces the offsets (copied); nullptr renders straight. Throws InputError when they belong
  /// to another geometry.
  void set_offsets(const OffsetField* offsets,
                   OffsetResolution resolution = OffsetResolution::full);

  /// Follows a local change of the offsets set last: those in the bricks at these origins (unique)
  /// are now those that `offsets` finds, and may be gone; `split`: where they jump, the bricks of
  /// which that have changed, come or gone are among them. As IncrementalCutInversion::update,
  /// finder and split say.
  void update_offsets(const std::vector<Vec3i>& changed, const VectorBrickFinder& offsets,
                      std::shared_ptr<const PointwiseOffsets> split = nullptr);

  /// Until offsets are set or updated: samples in the bricks of `offsets` find their own offsets,
  /// and all others are at rest. To be called again when they have changed. For example
  /// ForwardOffsets, which need no inverse.
  void set_pointwise_offsets(std::shared_ptr<const PointwiseOffsets> offsets);

  /// Replaces the surfaces (copied) shown with the volume, wherever they lie; in the deformed
  /// space. Throws InputError as Surface::validate does.
  void set_surfaces(const std::vector<Surface>& surfaces);

  /// Throws Cancelled. The picture does not depend on the number of threads.
  FloatImage render_float(const Camera& camera, const TransferFunction& transfer_function,
                          const RenderSettings& settings, RenderReport* report = nullptr,
                          Progress* progress = nullptr) const;
  /// The same in 8 bits.
  Image render(const Camera& camera, const TransferFunction& transfer_function,
               const RenderSettings& settings, RenderReport* report = nullptr,
               Progress* progress = nullptr) const;

 private:
  friend class ProgressiveRender;
  /// Data that all rays of the picture share; throws InputError for a bad argument.
  std::unique_ptr<RenderContext> prepare(const Camera& camera, const TransferFunction& function,
                                         const RenderSettings& settings) const;
  /// Counts changes of the offsets and surfaces that are shown; null: of pointwise offsets.
  std::optional<std::uint64_t> version() const;
  /// Bricks of the offsets that may have changed since that version; null: everything may have.
  std::optional<std::vector<std::size_t>> changed_since(std::uint64_t version) const;

  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
