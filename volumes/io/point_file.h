// Points with or without displacements as CSV: a header line that names the columns x, y, z and,
// where each point has a displacement of its own, dx, dy, dz (any case, any order, others are
// ignored), then one point a line, in millimetres. Lines that begin with # are comments, among them
// those of 3D Slicer's .fcsv: "# columns = …" stands for the header line and "# CoordinateSystem =
// LPS|RAS|0|1" for the frame. Where nothing is said the frame of such lists is RAS and their
// columns are label, x, y, z, as Slicer 3 wrote them; that of other files is LPS. Files that begin
// with { are Slicer's markups (markups.h). Cost: the file's bytes and 140 bytes per point.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

struct PointFile {
  /// The bytes of the file in which a number stands.
  struct Span {
    std::size_t begin = 0, size = 0;
  };
  struct Row {
    int line;  // in the file, from 1
    Vec3d at_lps_mm;
    Vec3d by_lps_mm{0, 0, 0};
    std::array<Span, 3> at = {};
    bool is_ras = false;  // in the file the numbers point right and anterior
  };
  std::string path;
  std::string content;  // the whole file
  bool has_displacements = false;
  std::vector<Row> rows;  // at least one

  /// "file:line" of a row, for errors.
  std::string place(const Row& row) const { return path + ":" + std::to_string(row.line); }
};

/// Throws InputError, with file:line, for a missing file or column, a value that is no finite
/// number, a short line, an unknown frame, or no points at all; for markups as read_markups.
PointFile read_point_file(const std::string& path);

/// Points with the displacements that lead to those of another file, pair by pair. Throws
/// InputError where these are not as many.
PointFile led_to(PointFile from, const PointFile& to);

/// The same file with these points in place of its own, one per row: all other columns, comments
/// and line ends are kept, and the digits of unchanged coordinates. Numbers are written with as
/// many digits as it takes to read the same number back. Throws as OutputFile.
void write_points_like(const std::string& path, const PointFile& file,
                       const std::vector<Vec3d>& points_lps_mm);

/// True for names that end in .csv, .fcsv or .json.
bool is_point_file_name(const std::string& path);

}  // namespace supple
