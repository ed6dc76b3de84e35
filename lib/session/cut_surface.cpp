#include "lib/session/cut_surface.h"

#include <filesystem>

#include "lib/body/cut.h"
#include "lib/body/swept_surface.h"
#include "volumes/base/value.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

PlanePatch plane_of(const CutSurface& surface, const Geometry& geometry) {
  if (!surface.in_voxels) return {surface.corner, surface.edge1, surface.edge2};
  return {geometry.world_from_index(surface.corner),
          geometry.world_vector_from_index(surface.edge1),
          geometry.world_vector_from_index(surface.edge2)};
}

TriangleMesh mesh_of(const CutCurve& curve, bool in_voxels, const Geometry& geometry) {
  SweptCurve swept{curve.points, curve.direction, curve.depth_mm, curve.above_mm,
                   !curve.is_straight};
  if (in_voxels) {
    for (Vec3d& point : swept.points_lps_mm) point = geometry.world_from_index(point);
    swept.direction = geometry.world_vector_from_index(curve.direction);
  }
  return swept_surface(swept);
}

/// Cuts a label from another one, or from all.
CutReport cut_around(std::int32_t label, std::int32_t from, Body& body, const BrickValues& labels) {
  require_label(labels, label, "cut");
  if (from != 0) require_label(labels, from, "cut");
  return cut_links(body, [&](Slot low, Slot high) {
    const std::int32_t a = labels.at(low), b = labels.at(high);
    if ((a == label) == (b == label)) return false;
    return from == 0 || a == from || b == from;
  });
}

/// Names the surface in the errors of the cut.
CutReport cut_along(const CutSurface& surface, Body& body, const BrickValues& labels) {
  try {
    if (surface.label != 0) return cut_around(surface.label, surface.from, body, labels);
    if (surface.mesh) return cut(body, *surface.mesh);
    if (surface.curve) {
      return cut(body, mesh_of(*surface.curve, surface.in_voxels, body.geometry));
    }
    return cut(body, plane_of(surface, body.geometry));
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    throw InputError({surface.place, problem.field, problem.found, problem.expected});
  }
}

}  // namespace

CutSurface mesh_cut(const std::string& path) {
  CutSurface surface;
  surface.place = path;
  surface.mesh_file = std::filesystem::path(path).filename().string();
  surface.mesh = std::make_shared<TriangleMesh>(read_mesh(path));
  return surface;
}

CutSurface label_cut(std::int32_t label, const std::string& place) {
  CutSurface surface;
  surface.place = place;
  surface.label = label;
  return surface;
}

std::int64_t apply_cuts(Body& body, const BrickValues& labels,
                        const std::vector<CutSurface>& surfaces, Progress* progress) {
  if (!surfaces.empty()) stage(progress, "cutting");
  std::int64_t cut_links = 0;
  for (const CutSurface& surface : surfaces) {
    const CutReport report = cut_along(surface, body, labels);
    cut_links += report.newly_cut;
    if (report.crossed == 0)
      warn(progress, surface.place + ": the cut crosses no link of the body");
    if (report.degenerate > 0) {
      warn(progress, surface.place + ": " + std::to_string(report.degenerate) +
                         " triangles without area cut nothing");
    }
    debug(progress, surface.place + ": the cut crosses " + std::to_string(report.crossed) +
                        " links, " + std::to_string(report.newly_cut) + " of them new");
  }
  return cut_links;
}

Value settings_value(const CutSurface& surface) {
  Value value;
  const char* frame = surface.in_voxels ? "voxel" : "lps";
  if (surface.mesh) {
    value["mesh"] = surface.mesh_file;
  } else if (surface.label != 0) {
    value["label"] = surface.label;
    if (surface.from != 0) value["from"] = surface.from;
  } else if (surface.curve) {
    const CutCurve& curve = *surface.curve;
    value["curve"] = {{"points", curve.points},        {"direction", curve.direction},
                      {"depth_mm", curve.depth_mm},    {"above_mm", curve.above_mm},
                      {"straight", curve.is_straight}, {"frame", frame}};
    if (!curve.file.empty()) value["curve"]["file"] = curve.file;
  } else {
    value["plane"] = {{"corner", surface.corner},
                      {"edge1", surface.edge1},
                      {"edge2", surface.edge2},
                      {"frame", frame}};
  }
  return value;
}

}  // namespace supple
