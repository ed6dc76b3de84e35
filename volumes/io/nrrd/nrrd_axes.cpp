#include "volumes/io/nrrd/nrrd_axes.h"

#include <algorithm>
#include <map>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::int64_t kMaxComponents = 16;
constexpr std::int64_t kMaxLayers = 256;  // of a segmentation

std::int64_t most_components(const NrrdHeader& header) {
  return header.keys.count("Segment0_Name") != 0 ? kMaxLayers : kMaxComponents;
}

enum class Role { lattice, component, frame, list, single, unsaid };

struct AxisKind {
  Role role;
  std::int64_t size = 0;            // that the format prescribes; 0: any
  bool may_be_displacement = true;  // its numbers are lengths along axes
};

AxisKind kind_of(const HeaderField& field, const std::string& name) {
  static const std::map<std::string, AxisKind> kinds = {
      {"", {Role::unsaid}},
      {"???", {Role::unsaid}},
      {"none", {Role::unsaid}},
      {"domain", {Role::lattice}},
      {"space", {Role::lattice}},
      {"time", {Role::frame}},
      {"list", {Role::list}},
      {"stub", {Role::single, 1}},
      {"scalar", {Role::single, 1}},
      {"point", {Role::component, 0, false}},
      {"vector", {Role::component}},
      {"covariant-vector", {Role::component, 0, false}},
      {"normal", {Role::component, 0, false}},
      {"complex", {Role::component, 2, false}},
      {"2-vector", {Role::component, 2}},
      {"3-vector", {Role::component, 3}},
      {"3-gradient", {Role::component, 3, false}},
      {"3-normal", {Role::component, 3, false}},
      {"4-vector", {Role::component, 4}},
      {"quaternion", {Role::component, 4, false}},
      {"3-color", {Role::component, 3, false}},
      {"rgb-color", {Role::component, 3, false}},
      {"hsv-color", {Role::component, 3, false}},
      {"xyz-color", {Role::component, 3, false}},
      {"4-color", {Role::component, 4, false}},
      {"rgba-color", {Role::component, 4, false}},
      {"2d-symmetric-matrix", {Role::component, 3, false}},
      {"2d-masked-symmetric-matrix", {Role::component, 4, false}},
      {"2d-matrix", {Role::component, 4, false}},
      {"2d-masked-matrix", {Role::component, 5, false}},
      {"3d-symmetric-matrix", {Role::component, 6, false}},
      {"3d-masked-symmetric-matrix", {Role::component, 7, false}},
      {"3d-matrix", {Role::component, 9, false}},
      {"3d-masked-matrix", {Role::component, 10, false}}};
  const auto found = kinds.find(lower_case(name));
  if (found == kinds.end()) HeaderField{field.file, field.name, name}.fail("kinds of NRRD");
  return found->second;
}

std::vector<AxisKind> kinds_of(const NrrdHeader& header, const std::vector<std::int64_t>& sizes) {
  const HeaderField field = header.field("kinds");
  std::vector<std::string> words = words_of(field.text);
  if (!words.empty() && words.size() != sizes.size()) field.fail("one kind per axis");
  words.resize(sizes.size());
  std::vector<AxisKind> kinds;
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    kinds.push_back(kind_of(field, words[a]));
    if (kinds[a].size != 0 && kinds[a].size != sizes[a]) {
      HeaderField{field.file, field.name, words[a] + " of size " + std::to_string(sizes[a])}.fail(
          "size " + std::to_string(kinds[a].size) + " for that kind");
    }
  }
  return kinds;
}

std::vector<std::int64_t> sizes_of(const NrrdHeader& header) {
  const HeaderField dimension = header.field("dimension"), field = header.field("sizes");
  const std::int64_t count = dimension.integer();
  if (count < 1 || count > 16) dimension.fail("1 to 16");
  const std::vector<std::int64_t> sizes = field.integers();
  if (sizes.size() != std::size_t(count)) {
    field.fail(std::to_string(count) + " sizes as \"dimension\" says");
  }
  for (const std::int64_t size : sizes) {
    if (size < 1 || size > 2147483647) field.fail("sizes from 1 to 2147483647");
  }
  return sizes;
}

/// Directions of all axes in space. An axis of time in a space with time has none there.
std::vector<std::vector<double>> directions_of(const NrrdHeader& header, std::size_t axis_count) {
  const HeaderField field = header.field("space directions");
  if (!header.has("space directions")) return {};
  auto vectors = nrrd_vectors(field);
  if (vectors.size() != axis_count) field.fail("one vector or \"none\" per axis");
  const int dimension = nrrd_space_dimension(header);
  for (std::vector<double>& vector : vectors) {
    if (vector.empty()) continue;
    if (dimension != 0 && vector.size() != std::size_t(dimension)) {
      field.fail("vectors of " + std::to_string(dimension) + " components as the space says");
    }
    if (vector.size() < 4) continue;
    const bool moves = vector[0] != 0 || vector[1] != 0 || vector[2] != 0;
    if (moves && vector[3] != 0) field.fail("axes that run in space or in time, not in both");
    vector.resize(moves ? 3 : 0);
  }
  return vectors;
}

/// True if 3D Slicer wrote a sequence of volumes along this axis.
bool is_sequence(const NrrdHeader& header, std::size_t a) {
  return header.keys.count("axis " + std::to_string(a) + " index type") > 0 ||
         header.keys.count("axis " + std::to_string(a) + " index values") > 0;
}

/// Roles that follow from an axis' place and direction.
Role role_of(const NrrdHeader& header, const NrrdAxes& axes, const std::vector<AxisKind>& kinds,
             std::size_t a) {
  const bool in_space = !axes.directions.empty();
  if (in_space && !axes.directions[a].empty()) return Role::lattice;
  const Role said = kinds[a].role;
  if (said == Role::single || said == Role::frame || said == Role::component) return said;
  if (said == Role::list) {
    if (is_sequence(header, a)) return Role::frame;
    return a == 0 && axes.sizes[a] <= most_components(header) ? Role::component : Role::frame;
  }
  const bool is_further = in_space || axes.spatial.size() >= 3;
  if (!is_further) return Role::lattice;
  if (axes.sizes[a] == 1) return Role::single;
  if (said == Role::unsaid && a == 0) return Role::component;
  return Role::frame;
}

void add_axis(const NrrdHeader& header, NrrdAxes& axes, Role role, const AxisKind& kind,
              std::size_t a) {
  static const StoredAxis lattice[] = {StoredAxis::i, StoredAxis::j, StoredAxis::k};
  const HeaderField field = header.field("sizes");
  const std::int64_t size = axes.sizes[a];
  if (role == Role::lattice) {
    if (axes.spatial.size() == 3) field.fail("a lattice of 2 or 3 axes");
    axes.order.push_back(lattice[axes.spatial.size()]);
    axes.dims[int(axes.spatial.size())] = int(size);
    axes.spatial.push_back(a);
    return;
  }
  if (size == 1) return;
  if (role == Role::component) {
    if (axes.components > 1) field.fail("one axis of components");
    if (size > most_components(header)) {
      field.fail("at most " + std::to_string(most_components(header)) + " components");
    }
    axes.components = int(size);
    axes.holds_vectors = size == 3 && kind.may_be_displacement;
    axes.order.push_back(StoredAxis::component);
  } else {
    if (axes.frames > 1) field.fail("one axis of frames beside a volume of 2 or 3 axes");
    axes.frames = size;
    axes.order.push_back(StoredAxis::frame);
  }
}

/// Axes that the file lacks are of size 1, so that their place means nothing.
void complete_order(std::vector<StoredAxis>& order) {
  const auto lacks = [&](StoredAxis axis) {
    return std::find(order.begin(), order.end(), axis) == order.end();
  };
  if (lacks(StoredAxis::k)) {
    order.insert(std::find(order.begin(), order.end(), StoredAxis::j) + 1, StoredAxis::k);
  }
  for (const StoredAxis axis : {StoredAxis::component, StoredAxis::frame}) {
    if (lacks(axis)) order.push_back(axis);
  }
}

}  // namespace

std::vector<std::vector<double>> nrrd_vectors(const HeaderField& field) {
  std::vector<std::vector<double>> vectors;
  std::size_t at = 0;
  while ((at = field.text.find_first_not_of(" \t", at)) != std::string::npos) {
    if (field.text.compare(at, 4, "none") == 0) {
      vectors.emplace_back();
      at += 4;
      continue;
    }
    const std::size_t close = field.text.find(')', at);
    if (field.text[at] != '(' || close == std::string::npos) field.fail("vectors such as (1,0,0)");
    std::string inside = field.text.substr(at + 1, close - at - 1);
    std::replace(inside.begin(), inside.end(), ',', ' ');
    vectors.push_back(HeaderField{field.file, field.name, inside}.numbers());
    if (vectors.back().size() < 2 || vectors.back().size() > 4) {
      field.fail("vectors of 2 or 3 components, or of 4 where time is the last");
    }
    at = close + 1;
  }
  return vectors;
}

NrrdAxes nrrd_axes(const NrrdHeader& header) {
  NrrdAxes axes;
  axes.sizes = sizes_of(header);
  axes.directions = directions_of(header, axes.sizes.size());
  const std::vector<AxisKind> kinds = kinds_of(header, axes.sizes);
  for (std::size_t a = 0; a < axes.sizes.size(); ++a) {
    add_axis(header, axes, role_of(header, axes, kinds, a), kinds[a], a);
  }
  if (axes.spatial.size() < 2) header.field("sizes").fail("a lattice of 2 or 3 axes");
  complete_order(axes.order);
  return axes;
}

}  // namespace supple
