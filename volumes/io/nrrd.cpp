// NRRD headers and the place of their values. Volumes of 2 or 3 axes (further axes only when they
// have one sample and no direction), scalar or with three components per voxel on the first axis;
// encodings raw and gzip; one data file.
// Source: http://teem.sourceforge.net/nrrd/format.html. Without `space`, spacings span LPS axes and
// axis mins give the origin, as ITK reads them; spaces that name no patient axes count as LPS.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/formats.h"
#include "volumes/io/nrrd_header.h"
#include "volumes/io/streamed_volume.h"

namespace supple {

namespace {

ValueType parse_type(const HeaderField& field) {
  static const std::map<std::string, ValueType> types = [] {
    std::map<std::string, ValueType> names;
    const auto add = [&](ValueType type, std::initializer_list<const char*> spellings) {
      for (const char* spelling : spellings) names[spelling] = type;
    };
    add(ValueType::int8, {"signed char", "int8", "int8_t"});
    add(ValueType::uint8, {"uchar", "unsigned char", "uint8", "uint8_t"});
    add(ValueType::int16,
        {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
    add(ValueType::uint16,
        {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
    add(ValueType::int32, {"int", "signed int", "int32", "int32_t"});
    add(ValueType::uint32, {"uint", "unsigned int", "uint32", "uint32_t"});
    add(ValueType::int64, {"longlong", "long long", "long long int", "signed long long",
                           "signed long long int", "int64", "int64_t"});
    add(ValueType::uint64,
        {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
    add(ValueType::float32, {"float"});
    add(ValueType::float64, {"double"});
    return names;
  }();
  const auto found = types.find(lower_case(field.text));
  if (found == types.end()) field.fail("a scalar type such as short, uint8 or float");
  return found->second;
}

/// One entry per axis: empty for "none", else as many components as the space has.
std::vector<std::vector<double>> parse_vectors(const HeaderField& field) {
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
    at = close + 1;
  }
  return vectors;
}

/// Per component of the space: factor to LPS.
Vec3d factors_to_lps(const HeaderField& space) {
  static const std::map<std::string, Vec3d> factors = {
      {"left-posterior-superior", Vec3d(1, 1, 1)},
      {"lps", Vec3d(1, 1, 1)},
      {"right-anterior-superior", Vec3d(-1, -1, 1)},
      {"ras", Vec3d(-1, -1, 1)},
      {"left-anterior-superior", Vec3d(1, -1, 1)},
      {"las", Vec3d(1, -1, 1)},
      {"scanner-xyz", Vec3d(1, 1, 1)},
      {"3d-right-handed", Vec3d(1, 1, 1)},
      {"3d-left-handed", Vec3d(1, 1, 1)},
      {"", Vec3d(1, 1, 1)}};
  const auto found = factors.find(lower_case(space.text));
  if (found == factors.end()) space.fail("LPS, RAS or LAS");
  return found->second;
}

/// Factor to mm of the space's (or the axes') unit; units other than lengths count as mm.
double mm_per_unit(const HeaderField& units) {
  static const std::map<std::string, double> factors = {
      {"\"cm\"", 10.0}, {"\"m\"", 1000.0}, {"\"um\"", 0.001}, {"\"\xc2\xb5m\"", 0.001}};
  const std::vector<std::string> words = words_of(units.text);
  if (words.empty()) return 1.0;
  for (const std::string& word : words) {
    if (word != words[0]) units.fail("the same unit for every axis");
  }
  const auto found = factors.find(words[0]);
  return found == factors.end() ? 1.0 : found->second;
}

/// Axes that span the lattice; further ones must be single and without direction.
struct SpatialAxes {
  std::vector<std::size_t> which;
  Vec3i dims;
  int components = 1;  // on the first axis, which is not among `which` then
};

/// The first axis holds three components: `kinds` says so, or it has no direction and no kind.
bool has_vectors(const NrrdHeader& header, const std::vector<std::int64_t>& sizes,
                 const std::vector<std::vector<double>>& directions) {
  const std::vector<std::string> kinds = words_of(header.field("kinds").text);
  if (!kinds.empty() && kinds.size() != sizes.size()) {
    header.field("kinds").fail("one kind per axis");
  }
  if (sizes.size() < 3 || sizes[0] != 3) return false;
  if (!directions.empty() && !directions[0].empty()) return false;
  const std::string kind = kinds.empty() ? "" : lower_case(kinds[0]);
  if (kind == "vector" || kind == "covariant-vector" || kind == "3-vector" || kind == "list") {
    return true;
  }
  const bool is_unsaid = kind.empty() || kind == "???" || kind == "none";
  return is_unsaid && !directions.empty();
}

SpatialAxes spatial_axes(const NrrdHeader& header,
                         const std::vector<std::vector<double>>& directions) {
  const HeaderField dimension = header.field("dimension"), sizes_field = header.field("sizes");
  const std::int64_t count = dimension.integer();
  if (count < 1 || count > 16) dimension.fail("1 to 16");
  const std::vector<std::int64_t> sizes = sizes_field.integers();
  if (sizes.size() != std::size_t(count)) {
    sizes_field.fail(std::to_string(count) + " sizes as \"dimension\" says");
  }
  SpatialAxes axes;
  std::vector<std::int64_t> kept;
  const std::size_t first = has_vectors(header, sizes, directions) ? 1 : 0;
  if (first > 0) axes.components = 3;
  for (std::size_t a = first; a < sizes.size(); ++a) {
    const bool undirected = directions.empty() ? a >= first + 3 : directions[a].empty();
    if (undirected && sizes[a] == 1) continue;
    axes.which.push_back(a);
    kept.push_back(sizes[a]);
  }
  if (kept.size() < 2 || kept.size() > 3) {
    sizes_field.fail("a volume of 2 or 3 axes, vectors of three components on the first axis");
  }
  axes.dims = dims_from(sizes_field, kept);
  return axes;
}

Vec3d padded(const HeaderField& field, const std::vector<double>& values) {
  if (values.size() < 2 || values.size() > 3) field.fail("vectors of 2 or 3 components");
  return {values[0], values[1], values.size() > 2 ? values[2] : 0.0};
}

Geometry geometry_in_space(const NrrdHeader& header, const SpatialAxes& axes,
                           const std::vector<std::vector<double>>& directions) {
  const HeaderField field = header.field("space directions");
  const HeaderField origin_field = header.field("space origin");
  const Vec3d factors =
      factors_to_lps(header.field("space")) * mm_per_unit(header.field("space units"));

  std::array<Vec3d, 3> vectors;
  for (std::size_t n = 0; n < axes.which.size(); ++n) {
    vectors[n] = padded(field, directions[axes.which[n]]) * factors + Vec3d(0);  // no -0
  }
  if (axes.which.size() == 2) vectors[2] = vectors[0].cross(vectors[1]).normalized();
  Vec3d origin(0, 0, 0);
  if (!origin_field.text.empty()) {
    const auto values = parse_vectors(origin_field);
    if (values.size() != 1) origin_field.fail("one vector");
    origin = padded(origin_field, values[0]) * factors + Vec3d(0);
  }
  return make_geometry(header.path, axes.dims, origin, vectors);
}

/// One number per axis, or NaN where a two-dimensional header says nothing.
std::vector<double> per_axis(const HeaderField& field, std::size_t axis_count) {
  std::vector<double> values = field.numbers();
  if (!field.text.empty() && values.size() != axis_count) field.fail("one number per axis");
  return values;
}

/// The units of the lattice's axes, without that of the vectors.
HeaderField units_of_axes(const NrrdHeader& header, const SpatialAxes& axes) {
  HeaderField units = header.field("units");
  if (axes.components == 1) return units;
  const std::size_t end = units.text.find_first_of(" \t");
  units.text = end == std::string::npos ? "" : units.text.substr(end);
  return units;
}

Geometry geometry_from_spacings(const NrrdHeader& header, const SpatialAxes& axes) {
  const HeaderField field = header.field("spacings");
  const std::size_t axis_count = header.field("sizes").integers().size();
  const std::vector<double> spacings = per_axis(field, axis_count);
  const std::vector<double> mins = per_axis(header.field("axis mins"), axis_count);
  const std::vector<std::string> centers = words_of(header.field("centers").text);
  const double scale = mm_per_unit(units_of_axes(header, axes));

  Vec3d origin(0, 0, 0);
  std::array<Vec3d, 3> vectors = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  for (std::size_t n = 0; n < axes.which.size(); ++n) {
    const std::size_t axis = axes.which[n];
    if (!spacings.empty()) {
      if (!(spacings[axis] > 0)) field.fail("positive numbers");
      vectors[n] *= spacings[axis] * scale;
    }
    if (mins.empty()) continue;
    const bool node = axis < centers.size() && centers[axis] == "node";
    origin[int(n)] = mins[axis] * scale + (node ? 0.0 : 0.5 * vectors[n][int(n)]);
  }
  return make_geometry(header.path, axes.dims, origin, vectors);
}

/// Vectors are mm along the axes of LPS whatever `space` says, as ITK reads and writes them; what
/// asks for something else is refused.
void check_frame_of_vectors(const NrrdHeader& header, const SpatialAxes& axes) {
  for (const HeaderField& units : {header.field("space units"), units_of_axes(header, axes)}) {
    if (mm_per_unit(units) != 1) units.fail("mm in a file of vectors");
  }
  const HeaderField frame = header.field("measurement frame");
  const std::vector<std::vector<double>> identity = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (!frame.text.empty() && parse_vectors(frame) != identity) {
    frame.fail("(1,0,0) (0,1,0) (0,0,1) in a file of vectors");
  }
}

/// Geometry, components, and the direction that supple's own writer records.
void read_lattice(const NrrdHeader& header, VolumeHeader& volume) {
  const bool in_space = header.has("space directions");
  std::vector<std::vector<double>> directions;
  if (in_space) {
    const HeaderField field = header.field("space directions");
    directions = parse_vectors(field);
    if (double(directions.size()) != header.field("dimension").number()) {
      field.fail("one vector or \"none\" per axis");
    }
  }
  const SpatialAxes axes = spatial_axes(header, directions);
  volume.geometry =
      in_space ? geometry_in_space(header, axes, directions) : geometry_from_spacings(header, axes);
  volume.components = axes.components;
  if (axes.components == 1) return;
  check_frame_of_vectors(header, axes);
  const auto direction = header.keys.find("supple direction");
  if (direction != header.keys.end()) volume.warp_direction = direction->second;
  const auto certificate = header.keys.find("supple certificate");
  if (certificate != header.keys.end()) volume.certificate = certificate->second;
}

StreamLayout layout_of(const NrrdHeader& header) {
  StreamLayout layout;
  layout.header.path = header.path;
  layout.header.format = "nrrd";
  layout.header.type = parse_type(header.field("type"));
  read_lattice(header, layout.header);
  const HeaderField endian = header.field("endian");
  const std::string order = lower_case(endian.text);
  const bool needed = bytes_of(layout.header.type) > 1;
  if (order != "little" && order != "big" && (needed || !order.empty())) {
    endian.fail("little or big");
  }
  layout.big_endian = order == "big";

  const HeaderField encoding = header.field("encoding");
  const std::string name = lower_case(encoding.text);
  if (name == "gzip" || name == "gz")
    layout.range.compression = Compression::deflate;
  else if (name != "raw")
    encoding.fail("raw or gzip");
  return layout;
}

/// Line and byte skips, counted from the first byte of the data.
void apply_skips(const NrrdHeader& header, const InputFile& data, StreamLayout& layout) {
  const HeaderField line_skip = header.field("line skip"), byte_skip = header.field("byte skip");
  if (header.has("line skip") && line_skip.integer() != 0) line_skip.fail("0");
  const std::int64_t skip = header.has("byte skip") ? byte_skip.integer() : 0;
  if (skip == 0) return;
  layout.range.surplus = Surplus::ignore;
  const bool plain = layout.range.compression == Compression::none;
  if (skip == -1 && plain) {
    const std::int64_t size = stored_bytes(layout.header);
    layout.range.file_offset = std::max(layout.range.file_offset, data.size() - size);
    return;
  }
  if (skip < 0) byte_skip.fail("0 or more, or -1 with encoding raw");
  if (!plain)
    layout.range.stream_offset = skip;
  else if (skip >= data.size())
    byte_skip.fail("less than the file's " + std::to_string(data.size()) + " bytes");
  else
    layout.range.file_offset += skip;
}

}  // namespace

std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, const ReadOptions& options) {
  chosen_frame(options, 1, path, "frames");
  auto file = std::make_shared<InputFile>(path);
  const NrrdHeader header = parse_nrrd_header(*file);
  StreamLayout layout = layout_of(header);
  if (header.has("data file")) {
    const HeaderField name = header.field("data file");
    if (name.text.compare(0, 4, "LIST") == 0 || name.text.find('%') != std::string::npos) {
      name.fail("the name of one data file");
    }
    if (name.text.empty()) name.fail("a file name");
    file = std::make_shared<InputFile>(sibling_path(path, name.text));
  } else {
    layout.range.file_offset = std::int64_t(header.end);
  }
  apply_skips(header, *file, layout);
  return open_stream(file, std::move(layout));
}

}  // namespace supple
