// Cuts as scenes and the command line write them.
#pragma once

#include "lib/session/cut_surface.h"
#include "volumes/base/fields.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"

namespace supple {

/// Keys of a table `plane` of a cut.
Fields plane_fields(CutSurface& surface);
/// Keys of a table `curve` of a cut, but for its points; `surface.curve` must be there.
Fields curve_fields(CutSurface& surface);

/// Throws InputError at `edge2` where the edges of a patch are parallel or 0.
void require_area(const Table& table, const Vec3d& edge1, const Vec3d& edge2);

/// An entry of `cut`. Throws InputError: unknown key, wrong type or value, missing key, and as
/// read_mesh and read_point_file.
CutSurface read_cut(Table& table, const LabelNames& names);

}  // namespace supple
