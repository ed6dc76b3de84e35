// Place and orientation of a NRRD's lattice, see nrrd_axes.h.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/length_units.h"
#include "volumes/io/nrrd/nrrd_axes.h"

namespace supple {

namespace {

struct Space {
  Vec3d factors_to_lps{1, 1, 1};
  int dimension = 3;  // 4: time is the last
};

Space space_of(const HeaderField& field) {
  static const std::map<std::string, Space> spaces = [] {
    std::map<std::string, Space> named;
    const auto add = [&](const char* name, const char* letters, const Vec3d& factors) {
      named[name] = {factors, 3};
      named[std::string(name) + "-time"] = {factors, 4};
      if (*letters == '\0') return;
      named[letters] = {factors, 3};
      named[std::string(letters) + "t"] = {factors, 4};
    };
    add("left-posterior-superior", "lps", {1, 1, 1});
    add("right-anterior-superior", "ras", {-1, -1, 1});
    add("left-anterior-superior", "las", {1, -1, 1});
    add("scanner-xyz", "", {1, 1, 1});
    add("3d-right-handed", "", {1, 1, 1});
    add("3d-left-handed", "", {1, 1, 1});
    return named;
  }();
  const auto found = spaces.find(lower_case(field.text));
  if (found == spaces.end()) field.fail("LPS, RAS or LAS");
  return found->second;
}

/// Units of a field, which are texts in quotes; also without them.
std::vector<std::string> units_of(const HeaderField& field) {
  std::vector<std::string> units;
  const std::string& text = field.text;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string::npos;) {
    const bool is_quoted = text[at] == '"';
    const std::size_t begin = at + is_quoted;
    const std::size_t end =
        std::min(text.find_first_of(is_quoted ? "\"" : " \t", begin), text.size());
    units.push_back(text.substr(begin, end - begin));
    at = std::min(end + is_quoted, text.size());
  }
  return units;
}

bool is_unsaid(const std::string& unit) {
  return unit.empty() || unit == "???" || unit == "none";
}

/// Factor to mm of the space's (or the axes') unit; units other than lengths count as mm.
double mm_of_units(const HeaderField& field, const std::vector<std::string>& units) {
  if (units.empty()) return 1.0;
  const double first = mm_per_unit(units[0]).value_or(1);
  for (const std::string& unit : units) {
    if (mm_per_unit(unit).value_or(1) != first) field.fail("the same unit for every axis");
  }
  return first;
}

std::vector<std::string> space_units(const NrrdHeader& header) {
  std::vector<std::string> units = units_of(header.field("space units"));
  if (nrrd_space_dimension(header) == 4 && units.size() == 4) units.resize(3);
  return units;
}

/// Units of the lattice's axes, without those of components and frames.
std::vector<std::string> axis_units(const NrrdHeader& header, const NrrdAxes& axes) {
  const std::vector<std::string> units = units_of(header.field("units"));
  if (units.size() != axes.sizes.size()) return units;
  std::vector<std::string> spatial;
  for (const std::size_t a : axes.spatial) spatial.push_back(units[a]);
  return spatial;
}

double mm_per_space_unit(const NrrdHeader& header) {
  return mm_of_units(header.field("space units"), space_units(header));
}

double mm_per_axis_unit(const NrrdHeader& header, const NrrdAxes& axes) {
  return mm_of_units(header.field("units"), axis_units(header, axes));
}

Vec3d padded(const std::vector<double>& values) {
  return {values[0], values[1], values.size() > 2 ? values[2] : 0.0};
}

Geometry geometry_in_space(const NrrdHeader& header, const NrrdAxes& axes) {
  const HeaderField origin_field = header.field("space origin");
  const Vec3d factors =
      (header.has("space") ? space_of(header.field("space")) : Space{}).factors_to_lps *
      mm_per_space_unit(header);

  std::array<Vec3d, 3> vectors;
  for (std::size_t n = 0; n < axes.spatial.size(); ++n) {
    vectors[n] = padded(axes.directions[axes.spatial[n]]) * factors + Vec3d(0);  // no -0
  }
  if (axes.spatial.size() == 2) vectors[2] = vectors[0].cross(vectors[1]).normalized();
  Vec3d origin(0, 0, 0);
  if (!origin_field.text.empty()) {
    const auto values = nrrd_vectors(origin_field);
    if (values.size() != 1 || values[0].empty()) origin_field.fail("one vector");
    origin = padded(values[0]) * factors + Vec3d(0);
  }
  return make_geometry(header.path, axes.dims, origin, vectors);
}

/// One number per axis, or none where the header says nothing.
std::vector<double> per_axis(const HeaderField& field, std::size_t axis_count) {
  std::vector<double> values = field.numbers();
  if (!field.text.empty() && values.size() != axis_count) field.fail("one number per axis");
  return values;
}

Geometry geometry_from_spacings(const NrrdHeader& header, const NrrdAxes& axes,
                                const ReadOptions& options) {
  const HeaderField field = header.field("spacings");
  const std::vector<double> spacings = per_axis(field, axes.sizes.size());
  const std::vector<double> mins = per_axis(header.field("axis mins"), axes.sizes.size());
  const std::vector<std::string> centers = words_of(header.field("centers").text);
  const double scale = mm_per_axis_unit(header, axes);

  Vec3d origin(0, 0, 0);
  std::array<Vec3d, 3> vectors = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  for (std::size_t n = 0; n < axes.spatial.size(); ++n) {
    const std::size_t axis = axes.spatial[n];
    if (!spacings.empty()) {
      const double spacing = own_spacing(spacings[axis], options);
      if (!(spacing > 0)) field.fail("positive numbers");
      vectors[n] *= spacing * scale;
    }
    if (mins.empty()) continue;
    const bool node = axis < centers.size() && centers[axis] == "node";
    origin[int(n)] = mins[axis] * scale + (node ? 0.0 : 0.5 * vectors[n][int(n)]);
  }
  return make_geometry(header.path, axes.dims, origin, vectors);
}

}  // namespace

std::string warning_of_units(const NrrdHeader& header, const NrrdAxes& axes) {
  const bool in_space = !axes.directions.empty();
  for (const std::string& unit : in_space ? space_units(header) : axis_units(header, axes)) {
    if (is_unsaid(unit) || mm_per_unit(unit)) continue;
    return (in_space ? "space units \"" : "units \"") + printable(unit) +
           "\" is no length that is known; voxel sizes count as mm";
  }
  return "";
}

std::string warning_of_space(const NrrdHeader& header) {
  if (!header.has("space")) return "";
  const std::string name = lower_case(header.field("space").text);
  for (const char* unnamed : {"scanner-xyz", "3d-right-handed", "3d-left-handed"}) {
    if (name.compare(0, std::string(unnamed).size(), unnamed) == 0) {
      return "space " + header.field("space").text +
             " does not name the patient's axes; it counts as left-posterior-superior";
    }
  }
  return "";
}

int nrrd_space_dimension(const NrrdHeader& header) {
  const HeaderField space = header.field("space"), dimension = header.field("space dimension");
  if (header.has("space")) {
    if (header.has("space dimension")) dimension.fail("either \"space\" or \"space dimension\"");
    return space_of(space).dimension;
  }
  if (!header.has("space dimension")) return 0;
  const std::int64_t count = dimension.integer();
  if (count != 2 && count != 3) dimension.fail("2 or 3, or a named space");
  return int(count);
}

Geometry nrrd_geometry(const NrrdHeader& header, const NrrdAxes& axes, const ReadOptions& options) {
  return axes.directions.empty() ? geometry_from_spacings(header, axes, options)
                                 : geometry_in_space(header, axes);
}

void check_frame_of_vectors(const NrrdHeader& header, const NrrdAxes& axes) {
  if (mm_per_space_unit(header) != 1) header.field("space units").fail("mm in a file of vectors");
  if (mm_per_axis_unit(header, axes) != 1) header.field("units").fail("mm in a file of vectors");
  const HeaderField frame = header.field("measurement frame");
  const std::vector<std::vector<double>> identity = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (!frame.text.empty() && nrrd_vectors(frame) != identity) {
    frame.fail("(1,0,0) (0,1,0) (0,0,1) in a file of vectors");
  }
}

}  // namespace supple
