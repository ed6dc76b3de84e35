// MetaImage headers (.mha, .mhd) and the place of their values. Volumes of 2 or 3 dimensions,
// scalar or of three channels, raw or zlib-compressed, in one data file. The frame is LPS mm; the
// first NDims numbers of TransformMatrix are the direction of i, as ITK reads and writes them.
// Source: https://itk.org/Wiki/ITK/MetaIO/Documentation. Keys that describe no geometry and no
// values are skipped, since the format lets everyone add some.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/formats.h"
#include "volumes/io/streamed_volume.h"
#include "volumes/io/text_header.h"

namespace supple {

namespace {

struct MetaHeader {
  std::string path;
  std::map<std::string, std::string> values;  // by lower-case key
  std::size_t end = 0;                        // offset behind the header

  bool has(const std::string& key) const { return values.count(lower_case(key)) > 0; }
  HeaderField field(const std::string& key) const {
    const auto found = values.find(lower_case(key));
    return {path, key, found == values.end() ? "" : found->second};
  }
  /// The first of several spellings that is present.
  HeaderField any_of(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      if (has(key)) return field(key);
    }
    return {path, *keys.begin(), ""};
  }
};

MetaHeader parse_header(const InputFile& file) {
  MetaHeader header;
  header.path = file.path();
  const std::string text = file.head(kMaxTextHeader);
  LineReader lines(text);
  std::string line;
  while (lines.next(line)) {
    if (trimmed(line).empty()) continue;
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) {
      HeaderField{header.path, "header line", line}.fail("\"Key = Value\"");
    }
    const std::string key = lower_case(trimmed(line.substr(0, equals)));
    if (!header.values.emplace(key, trimmed(line.substr(equals + 1))).second) {
      HeaderField{header.path, printable(key), "the key twice"}.fail("it once");
    }
    if (key == "elementdatafile") {
      header.end = lines.position();
      return header;
    }
  }
  throw InputError({header.path, "ElementDataFile", "nothing", "a file name or LOCAL"});
}

ValueType parse_type(const HeaderField& field) {
  static const std::map<std::string, ValueType> types = {
      {"MET_CHAR", ValueType::int8},       {"MET_UCHAR", ValueType::uint8},
      {"MET_SHORT", ValueType::int16},     {"MET_USHORT", ValueType::uint16},
      {"MET_INT", ValueType::int32},       {"MET_UINT", ValueType::uint32},
      {"MET_LONG", ValueType::int32},      {"MET_ULONG", ValueType::uint32},
      {"MET_LONG_LONG", ValueType::int64}, {"MET_ULONG_LONG", ValueType::uint64},
      {"MET_FLOAT", ValueType::float32},   {"MET_DOUBLE", ValueType::float64}};
  const auto found = types.find(field.text);
  if (found == types.end()) field.fail("a scalar type such as MET_SHORT or MET_FLOAT");
  return found->second;
}

Geometry parse_geometry(const MetaHeader& header) {
  const HeaderField ndims = header.field("NDims"), size_field = header.field("DimSize");
  const std::int64_t count = ndims.integer();
  if (count != 2 && count != 3) ndims.fail("2 or 3");
  const std::vector<std::int64_t> sizes = size_field.integers();
  if (sizes.size() != std::size_t(count)) size_field.fail("as many sizes as NDims");
  const Vec3i dims = dims_from(size_field, sizes);

  // Numbers per axis, or the format's defaults.
  const auto numbers = [&](const HeaderField& field, std::size_t expected,
                           std::vector<double> fallback) {
    if (field.text.empty()) return fallback;
    std::vector<double> values = field.numbers();
    if (values.size() != expected) field.fail(std::to_string(expected) + " numbers");
    return values;
  };
  const std::size_t n = std::size_t(count);
  const HeaderField spacing_field = header.any_of({"ElementSpacing", "ElementSize"});
  const auto spacing = numbers(spacing_field, n, {1, 1, 1});
  const auto offset = numbers(header.any_of({"Offset", "Origin", "Position"}), n, {0, 0, 0});
  const auto matrix = numbers(
      header.any_of({"TransformMatrix", "Rotation", "Orientation"}), n * n,
      n == 3 ? std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1} : std::vector<double>{1, 0, 0, 1});
  Vec3d origin(0, 0, 0);
  std::array<Vec3d, 3> axes = {Vec3d(0, 0, 0), {0, 0, 0}, {0, 0, 1}};
  for (std::size_t a = 0; a < n; ++a) {
    if (!(spacing[a] > 0)) spacing_field.fail("positive numbers");
    origin[int(a)] = offset[a];
    for (std::size_t c = 0; c < n; ++c) axes[a][int(c)] = matrix[a * n + c] * spacing[a];
  }
  return make_geometry(header.path, dims, origin, axes);
}

/// What supple's own writer says of a warp: "supple direction NAME, …"; empty in other comments.
std::string direction_in(const std::string& comment) {
  const std::string mark = "supple direction ";
  if (comment.compare(0, mark.size(), mark) != 0) return "";
  return comment.substr(mark.size(), comment.find(',') - mark.size());
}

StreamLayout layout_of(const MetaHeader& header) {
  StreamLayout layout;
  layout.header.path = header.path;
  layout.header.format = "metaimage";
  layout.header.geometry = parse_geometry(header);
  layout.header.type = parse_type(header.field("ElementType"));
  const HeaderField channels = header.field("ElementNumberOfChannels");
  if (!channels.text.empty() && channels.integer() != 1) {
    if (channels.integer() != 3) channels.fail("1 (a scalar volume) or 3 (a warp)");
    layout.header.components = 3;
    layout.header.warp_direction = direction_in(header.field("Comment").text);
    layout.header.certificate = header.field("SuppleCertificate").text;
  }
  const HeaderField binary = header.field("BinaryData");
  if (!binary.text.empty() && !binary.boolean()) binary.fail("True (values as text are not read)");

  const HeaderField order = header.any_of({"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
  layout.big_endian = !order.text.empty() && order.boolean();
  const HeaderField compressed = header.field("CompressedData");
  if (!compressed.text.empty() && compressed.boolean()) {
    layout.range.compression = Compression::deflate;
  }
  const HeaderField slope = header.field("ElementToIntensityFunctionSlope");
  const HeaderField intercept = header.field("ElementToIntensityFunctionOffset");
  if (!slope.text.empty()) layout.header.slope = slope.number();
  if (!intercept.text.empty()) layout.header.intercept = intercept.number();
  return layout;
}

/// HeaderSize: bytes before the values; -1 means that the values end with the file.
void apply_header_size(const MetaHeader& header, const InputFile& data, StreamLayout& layout) {
  const HeaderField field = header.field("HeaderSize");
  const std::int64_t skip = field.text.empty() ? 0 : field.integer();
  if (skip == 0) return;
  layout.range.surplus = Surplus::ignore;
  if (skip == -1 && layout.range.compression == Compression::none) {
    const std::int64_t size = stored_bytes(layout.header);
    layout.range.file_offset = std::max(layout.range.file_offset, data.size() - size);
    return;
  }
  if (skip < 0) field.fail("0 or more, or -1 with uncompressed data");
  if (skip >= data.size() - layout.range.file_offset) {
    field.fail("less than the file's " + std::to_string(data.size()) + " bytes");
  }
  layout.range.file_offset += skip;
}

}  // namespace

std::unique_ptr<VolumeFile> open_metaimage(const std::string& path, const ReadOptions& options) {
  chosen_frame(options, 1, path, "frames");
  auto file = std::make_shared<InputFile>(path);
  const MetaHeader header = parse_header(*file);
  StreamLayout layout = layout_of(header);
  const HeaderField name = header.field("ElementDataFile");
  if (lower_case(name.text) == "local") {
    layout.range.file_offset = std::int64_t(header.end);
  } else {
    if (name.text.empty() || lower_case(name.text).compare(0, 4, "list") == 0 ||
        name.text.find('%') != std::string::npos) {
      name.fail("LOCAL or the name of one data file");
    }
    file = std::make_shared<InputFile>(sibling_path(path, name.text));
  }
  apply_header_size(header, *file, layout);
  return open_stream(file, std::move(layout));
}

}  // namespace supple
