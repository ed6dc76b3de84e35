// Cells of legacy VTK files, and which triangles they are.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "volumes/io/mesh/mesh_formats.h"

namespace supple::vtk {

/// Cells one after the other.
struct Cells {
  std::vector<int> ids;
  std::vector<std::size_t> ends;

  std::size_t size() const { return ends.size(); }
  std::vector<int> corners(std::size_t n) const {
    const auto first = ids.begin() + std::ptrdiff_t(n == 0 ? 0 : ends[n - 1]);
    return {first, ids.begin() + std::ptrdiff_t(ends[n])};
  }
};

/// Triangles in turn; every second one turned over.
inline void add_strip(const std::vector<int>& strip, TriangleMesh& mesh) {
  for (std::size_t n = 2; n < strip.size(); ++n) {
    const int a = strip[n - 2], b = strip[n - 1];
    mesh.triangles.push_back({n % 2 == 0 ? a : b, n % 2 == 0 ? b : a, strip[n]});
  }
}

/// A cell of an unstructured grid, by its VTK number; only flat ones are surfaces.
inline void add_cell(std::int64_t type, std::vector<int> corners, TriangleMesh& mesh) {
  constexpr std::int64_t kTriangle = 5, kStrip = 6, kPolygon = 7, kPixel = 8, kQuad = 9;
  if (type == kPixel && corners.size() == 4) std::swap(corners[2], corners[3]);
  if (type == kStrip) {
    add_strip(corners, mesh);
  } else if (type == kTriangle || type == kPolygon || type == kPixel || type == kQuad) {
    add_polygon(corners, mesh);
  }
}

}  // namespace supple::vtk
