#include "lib/session/file/cut_keys.h"

#include <filesystem>

#include "lib/session/file/handle_keys.h"
#include "volumes/io/point_file.h"

namespace supple {

Fields plane_fields(CutSurface& surface) {
  return {
      Field("corner", surface.corner, "A point [x, y, z]").required(),
      Field("edge1", surface.edge1, "A vector [x, y, z]").required(),
      Field("edge2", surface.edge2, "A vector [x, y, z]").required(),
      Field("frame", surface.in_voxels, {"lps", "voxel"}, "LPS mm, or voxels of the volume"),
  };
}

Fields curve_fields(CutSurface& surface) {
  CutCurve& curve = *surface.curve;
  return {
      Field("direction", curve.direction, "Into the tissue, [x, y, z] of any length").required(),
      Field("depth", curve.depth_mm, "How deep along the direction")
          .unit("mm")
          .positive()
          .required(),
      Field("above", curve.above_mm, "How far against it, to cut what is above the points")
          .unit("mm")
          .at_least(0),
      Field("straight", curve.is_straight, "Straight lines from point to point, not a spline"),
      Field("frame", surface.in_voxels, {"lps", "voxel"},
            "LPS mm, or voxels of the volume: points and direction"),
  };
}

void require_area(const Table& table, const Vec3d& edge1, const Vec3d& edge2) {
  if (edge1.cross(edge2) != Vec3d(0)) return;
  table.fail("edge2", "edges that span no area", "two vectors that differ in direction");
}

namespace {

CutSurface read_plane(Table& table) {
  CutSurface surface;
  surface.place = table.place();
  table.read(plane_fields(surface));
  require_area(table, surface.edge1, surface.edge2);
  table.finish();
  return surface;
}

/// A list of points, or a file of them, which is in millimetres.
void read_curve_points(Table& table, CutSurface& surface) {
  CutCurve& curve = *surface.curve;
  const char* expected = "two points [x, y, z] or more, or a .mrk.json, .fcsv or .csv file";
  if (!is_text(table.find("points"))) {
    const auto rows = table.require(table.rows("points", {3}, expected), "points", expected);
    for (const std::vector<double>& row : rows) curve.points.push_back({row[0], row[1], row[2]});
  } else {
    const std::string path = *table.path("points");
    if (surface.in_voxels) table.fail("frame", "\"voxel\" beside a file", "\"lps\"");
    for (const PointFile::Row& row : read_point_file(path).rows) {
      curve.points.push_back(row.at_lps_mm);
    }
    curve.file = std::filesystem::path(path).filename().string();
  }
  if (curve.points.size() < 2) table.fail("points", "one point", expected);
}

CutSurface read_curve(Table& table) {
  CutSurface surface;
  surface.place = table.place();
  surface.curve.emplace();
  table.know({"points"});
  table.read(curve_fields(surface));
  read_curve_points(table, surface);
  if (surface.curve->direction == Vec3d(0)) table.fail("direction", "[0, 0, 0]", "a direction");
  table.finish();
  return surface;
}

}  // namespace

CutSurface read_cut(Table& table, const LabelNames& names) {
  table.know({"plane", "curve", "mesh", "label"});
  auto plane = table.table("plane");
  auto curve = table.table("curve");
  const auto mesh = table.path("mesh");
  const auto label = read_label(table, "label", names), from = read_label(table, "from", names);
  table.finish();
  const int given = int(plane.has_value()) + int(curve.has_value()) + int(mesh.has_value()) +
                    int(label.has_value());
  const char* expected = "either mesh, plane, curve or label";
  if (given == 0) table.fail_missing("mesh", expected);
  if (given > 1) table.fail("mesh", "several of them", expected);
  if (from && (!label || *from == *label)) {
    table.fail("from", label ? "the label itself" : "from without label", "another label");
  }
  if (label) {
    CutSurface cut = label_cut(*label, table.place());
    cut.from = from.value_or(0);
    return cut;
  }
  if (curve) return read_curve(*curve);
  return plane ? read_plane(*plane) : mesh_cut(*mesh);
}

}  // namespace supple
