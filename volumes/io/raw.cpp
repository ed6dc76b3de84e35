// Headerless raw files. Everything is said on the command line:
//   raw dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=little|big][,offset=BYTES]
// Two dims make one slice. The axes are those of LPS and the first voxel lies at the origin.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/streamed_volume.h"

namespace supple {

namespace {

constexpr const char* kKnownKeys[] = {"dims", "type", "spacing", "endian", "offset"};

/// "a=1,2,b=3" as {a: "1 2", b: "3"}: a part without '=' continues the list before it.
std::map<std::string, std::string> split_spec(const std::string& path, const std::string& spec) {
  std::map<std::string, std::string> values;
  std::string key;
  std::size_t first = 0;
  while (first <= spec.size()) {
    const std::size_t comma = std::min(spec.find(',', first), spec.size());
    const std::string part = spec.substr(first, comma - first);
    first = comma + 1;
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) {
      if (key.empty()) HeaderField{path, "raw", part}.fail("key=value");
      values[key] += " " + part;
      continue;
    }
    key = trimmed(part.substr(0, equals));
    if (std::find(std::begin(kKnownKeys), std::end(kKnownKeys), key) == std::end(kKnownKeys)) {
      HeaderField{path, "raw", key}.fail("one of dims, type, spacing, endian, offset");
    }
    if (!values.emplace(key, part.substr(equals + 1)).second) {
      HeaderField{path, "raw " + key, "the key twice"}.fail("it once");
    }
  }
  return values;
}

Geometry geometry_of(const HeaderField& dims_field, const HeaderField& spacing_field) {
  const std::vector<std::int64_t> sizes = dims_field.integers();
  const Vec3i dims = dims_from(dims_field, sizes);
  std::vector<double> spacing = spacing_field.numbers();
  if (spacing.size() != sizes.size()) spacing_field.fail("one number per size, in mm");
  spacing.resize(3, 1.0);
  for (const double length : spacing) {
    if (!(length > 0)) spacing_field.fail("positive numbers in mm");
  }
  return make_geometry(dims_field.file, dims, {0, 0, 0},
                       {Vec3d(spacing[0], 0, 0), {0, spacing[1], 0}, {0, 0, spacing[2]}});
}

}  // namespace

std::unique_ptr<VolumeFile> open_raw(const std::string& path, const std::string& spec) {
  const auto values = split_spec(path, spec);
  const auto field = [&](const std::string& key, const std::string& fallback) {
    const auto found = values.find(key);
    return HeaderField{path, "raw " + key, found == values.end() ? fallback : found->second};
  };

  const HeaderField type = field("type", "");
  const HeaderField endian = field("endian", "little");
  const HeaderField offset = field("offset", "0");
  StreamLayout layout;
  layout.header.path = path;
  layout.header.format = "raw";
  layout.header.geometry = geometry_of(field("dims", ""), field("spacing", ""));
  if (!find_numpy_type(type.text, layout.header.type)) {
    type.fail("int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32 or float64");
  }
  if (endian.text != "little" && endian.text != "big") endian.fail("little or big");
  layout.big_endian = endian.text == "big";
  layout.range.file_offset = offset.integer();
  // Who skips bytes picks the values out of a larger file.
  layout.range.surplus = layout.range.file_offset > 0 ? Surplus::ignore : Surplus::error;
  return open_stream(std::make_shared<InputFile>(path), std::move(layout));
}

}  // namespace supple
