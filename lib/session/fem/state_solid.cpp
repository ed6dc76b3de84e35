#include "lib/session/fem/state_solid.h"

#include <utility>

#include "lib/fem/voxel/hex_mesh.h"
#include "lib/material/material.h"
#include "volumes/field/inversion/linked_elements.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Corners 4 di + 2 dj + dk in VTK's order, of a right-handed and of a left-handed grid.
constexpr int kVtkCorners[2][8] = {{0, 4, 6, 2, 1, 5, 7, 3}, {1, 5, 7, 3, 0, 4, 6, 2}};

/// The way from an element's centre to a corner, in voxels.
Vec3d way_to(int corner) {
  return Vec3d(cell_corner(corner)) - Vec3d(0.5);
}

/// Each corner takes the mean of the elements around it.
SolidArray corner_displacements(const Displacement& u, const LinkedElements& linked,
                                const HexMesh& mesh) {
  std::vector<Vec3d> sums(std::size_t(mesh.node_count()), Vec3d(0));
  std::vector<int> counts(sums.size(), 0);
  for (std::int32_t element = 0; element < mesh.element_count(); ++element) {
    const Vec3i voxel = mesh.cell_of(element);
    const Vec3d own = linked.at(voxel);
    const Columns gradient = linked.gradient(voxel);
    const Corners corners = mesh.corners(element);
    for (int corner = 0; corner < 8; ++corner) {
      sums[std::size_t(corners[corner])] += own + product(gradient, way_to(corner));
      ++counts[std::size_t(corners[corner])];
    }
  }
  SolidArray array{"displacement", 3, false, {}};
  for (std::size_t n = 0; n < sums.size(); ++n) {
    const Vec3d moved_mm = u.geometry.world_vector_from_index(sums[n] / double(counts[n]));
    for (int c = 0; c < 3; ++c) array.values.push_back(float(moved_mm[c]));
  }
  return array;
}

/// A value per element of the bricks.
SolidArray of_elements(const char* name, bool are_whole, const BrickTopology& elements,
                       const std::function<double(std::size_t b, int offset)>& value) {
  SolidArray array{name, 1, are_whole, {}};
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b),
                    [&](int offset) { array.values.push_back(float(value(b, offset))); });
  }
  return array;
}

std::vector<SolidArray> cell_arrays(const State& state, const LinkedElements& linked) {
  const BrickTopology& elements = state.elements;
  std::vector<SolidArray> arrays;
  arrays.push_back(of_elements("density", false, elements, [&](std::size_t b, int offset) {
    const std::int32_t kept = state.density.bricks().find(elements.origin(b));
    return kept < 0 ? 0.0 : double(state.density.values(std::size_t(kept))[offset]);
  }));
  arrays.push_back(of_elements("jacobian", false, elements, [&](std::size_t b, int offset) {
    return linked.jacobian(elements.origin(b) + brick_local(offset));
  }));
  const auto add_labels = [&](const char* name, const BrickValues& labels) {
    if (labels.empty()) return;
    arrays.push_back(of_elements(name, true, elements, [&](std::size_t b, int offset) {
      return double(labels.brick_or_zero(b)[offset]);
    }));
  };
  add_labels("label", state.labels);
  add_labels("piece", state.pieces);
  return arrays;
}

}  // namespace

HexSolid solid_of(const State& state, const std::string& path, std::vector<SolidArray> more,
                  Progress* progress) {
  if (progress != nullptr) progress->stage("hexahedra");
  Body body = make_body(state, parse_material(state.material_toml, path));
  body.cuts = state.cuts;  // without the links that rigid pieces hide
  const HexMesh mesh = hex_mesh(body, {}, progress);
  const Displacement u = displacement_of(state);
  const LinkedElements linked(u, state.elements, state.cuts);

  HexSolid solid;
  solid.points_lps_mm = node_positions(mesh);
  const int* const order = kVtkCorners[state.geometry.determinant() < 0];
  solid.hexahedra.resize(std::size_t(mesh.element_count()));
  for (std::int32_t element = 0; element < mesh.element_count(); ++element) {
    const Corners corners = mesh.corners(element);
    for (std::size_t n = 0; n < 8; ++n) {
      solid.hexahedra[std::size_t(element)][n] = corners[std::size_t(order[n])];
    }
  }
  solid.of_points.push_back(corner_displacements(u, linked, mesh));
  solid.of_cells = cell_arrays(state, linked);
  for (SolidArray& array : more) solid.of_cells.push_back(std::move(array));
  return solid;
}

std::vector<Vec3i> voxels_of(const BrickTopology& elements) {
  std::vector<Vec3i> voxels;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      voxels.push_back(elements.origin(b) + brick_local(offset));
    });
  }
  return voxels;
}

}  // namespace supple
