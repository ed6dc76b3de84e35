// Normals of triangle meshes: a smooth one at each corner of each triangle.
#pragma once

#include <array>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

using Triangles = std::vector<std::array<int, 3>>;

/// Unit normals, three for each triangle: means by area of the triangles around a vertex whose
/// planes differ by less than the angle, so that tubes are round and their ends are sharp.
std::vector<Vec3f> corner_normals(const std::vector<Vec3d>& vertices_mm, const Triangles& triangles,
                                  double crease_degrees);

}  // namespace supple
