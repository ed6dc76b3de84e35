// Surface along which a step cuts the body: a triangle mesh from a file, a plane patch or a drawn
// curve from a scene, or around a label.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/body/cut.h"
#include "lib/body/swept_surface.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple {

/// A curve as drawn, swept along a direction; places in the frame of its surface.
struct CutCurve {
  std::vector<Vec3d> points;
  std::string file;  // that the points came from, without folder; empty: from the scene
  Vec3d direction{0, 0, 0};
  double depth_mm = 0, above_mm = 5;
  bool is_straight = false;
};

struct CutSurface {
  std::string place;                         // for errors: "scene:line", or the mesh file
  std::string mesh_file;                     // without folder
  std::shared_ptr<const TriangleMesh> mesh;  // null: a plane
  Vec3d corner{0, 0, 0}, edge1{0, 0, 0}, edge2{0, 0, 0};  // of the plane patch
  bool in_voxels = false;  // of the volume, instead of LPS mm: plane and curve
  std::optional<CutCurve> curve;
  std::int32_t label = 0;  // links between it and anything else; 0: one of the others
};

/// Reads the mesh; throws InputError as read_mesh.
CutSurface mesh_cut(const std::string& path);

CutSurface label_cut(std::int32_t label, const std::string& place);

/// Cuts the body along all surfaces and returns how many links that removed. Warns of a surface
/// that crosses no link. Throws InputError for a label that no element has.
std::int64_t apply_cuts(Body& body, const BrickValues& labels,
                        const std::vector<CutSurface>& surfaces, Progress* progress);

/// Returns the surface as a journal records it.
Value settings_value(const CutSurface& surface);

}  // namespace supple
