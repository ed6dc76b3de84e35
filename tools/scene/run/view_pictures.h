// Pictures of effective views: cameras and settings, renderers, and their records.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lib/state/pose.h"
#include "raycast/render.h"
#include "raycast/scene/view_volume.h"
#include "tools/scene/file/scene.h"

namespace supple::tools {

/// The camera that a choice stands for, over the source box of `geometry`.
Camera resolve_camera(const CameraChoice& choice, const Geometry& geometry, double aspect);

/// Marches (or draws the lattice of a one-slice body) and returns the picture.
struct PosedVolume {
  const Geometry& geometry;
  const DensityGrid& density;
  const BrickTopology& elements;
  const OffsetField* offsets;               // null: samples solve for themselves where u is known
  const Displacement* displacement;         // u; null: at rest, or not known
  double grey_lo, grey_hi;                  // of the lattice
  int air_rings = 0;                        // see Renderer; 0 for a state, which keeps its shell
  const BrickTopology* outlined = nullptr;  // at rest; null: a plain volume
  const LinkCuts* cuts = nullptr;           // of the elements; null: none
  const BrickValues* labels = nullptr;      // of the elements; null: none
};
/// The camera of an effective view, marched or drawn as a lattice.
Camera camera_of(const PosedVolume& subject, const SceneView& view);
RenderSettings view_settings(const SceneView& view);
/// The transfer function of an effective view.
TransferFunction look_of(const SceneView& view);
/// The error with a view's place, unless it has one of its own.
[[noreturn]] void rethrow_at(const std::string& place, const InputError& error);
/// Throws InputError when a view without inverse is to be seen along functions.
void check_inverse(const SceneView& view, const std::vector<OffsetFunction>& functions);
/// Checks the settings that do not depend on the volume, with the view's place in errors.
void check_view(const SceneView& view);
/// Throws InputError where numbers of labels and meshes are asked for and there are none.
void check_ids(const SceneView& view, bool has_labels);
/// The view as it will be drawn: one-slice bodies as lattices, and where no preset is named Bone
/// if densities reach below -200, as Hounsfield units of air do, else MR-Default.
SceneView effective_view(const SceneView& view, const Geometry& geometry, double min_density);
/// True if pictures of the view read the displacement beside the offsets, or the offsets alone.
bool reads_displacement(const SceneView& view);
/// Parts that the cameras or the slices of a view show, where its picture reads offsets there
/// alone; nothing where it reads them all, as shadows do from beside the picture.
std::optional<std::vector<ViewVolume>> seen_of(const SceneView& view, const Geometry& geometry);
/// A renderer of the subject in its pose.
std::unique_ptr<Renderer> make_renderer(const PosedVolume& subject, const SceneView& view);
/// Moves a renderer of the same volume, and the view's meshes, to where the subject is. Without
/// offsets the displacement is read by every picture and must outlive it.
void pose(Renderer& renderer, const PosedVolume& subject, const SceneView& view);
/// One picture, marched by `renderer` unless the view is a lattice or slices. The view is an
/// effective one.
FloatImage draw(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                RenderReport* report, Progress& progress);

}  // namespace supple::tools
