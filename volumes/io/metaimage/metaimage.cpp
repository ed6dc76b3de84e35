// MetaImage headers (.mha, .mhd) and the place of their values. Volumes of 2 or 3 dimensions, a
// fourth being a time series; 1 to 16 channels; plain, zlib or gzip, or decimal text; in one file
// or one per slice. The frame is LPS mm; the first NDims numbers of TransformMatrix are the
// direction of i, as ITK reads and writes them; AnatomicalOrientation is left alone, as in ITK.
// Source: https://itk.org/Wiki/ITK/MetaIO/Documentation. Keys that describe no geometry and no
// values are skipped, since the format lets everyone add some.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/data_files.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/streamed_volume.h"

namespace supple {

namespace {

struct MetaHeader {
  std::string path;
  std::map<std::string, std::string> values;  // by lower-case key
  std::vector<std::string> files;             // of "ElementDataFile = LIST"
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

bool is_list(const std::string& data_file) {
  const std::vector<std::string> words = words_of(data_file);
  return !words.empty() && lower_case(words[0]) == "list";
}

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
      if (is_list(header.values[key])) {
        while (lines.next(line)) {
          if (!trimmed(line).empty()) header.files.push_back(trimmed(line));
        }
      }
      return header;
    }
  }
  throw InputError({header.path, "ElementDataFile", "nothing", "a file name or LOCAL"});
}

/// MET_FLOAT, or MET_FLOAT_ARRAY, which is the same with the channels in its name.
ValueType parse_type(const HeaderField& field) {
  static const std::map<std::string, ValueType> types = {
      {"MET_CHAR", ValueType::int8},       {"MET_UCHAR", ValueType::uint8},
      {"MET_SHORT", ValueType::int16},     {"MET_USHORT", ValueType::uint16},
      {"MET_INT", ValueType::int32},       {"MET_UINT", ValueType::uint32},
      {"MET_LONG", ValueType::int32},      {"MET_ULONG", ValueType::uint32},
      {"MET_LONG_LONG", ValueType::int64}, {"MET_ULONG_LONG", ValueType::uint64},
      {"MET_FLOAT", ValueType::float32},   {"MET_DOUBLE", ValueType::float64}};
  const std::string suffix = "_ARRAY";
  std::string name = field.text;
  if (name.size() > suffix.size() &&
      name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0) {
    name.resize(name.size() - suffix.size());
  }
  const auto found = types.find(name);
  if (found == types.end()) field.fail("a scalar type such as MET_SHORT or MET_FLOAT");
  return found->second;
}

std::vector<std::int64_t> parse_sizes(const MetaHeader& header) {
  const HeaderField ndims = header.field("NDims"), field = header.field("DimSize");
  const std::int64_t count = ndims.integer();
  if (count < 2 || count > 4) ndims.fail("2 or 3, or 4 with time as the last");
  const std::vector<std::int64_t> sizes = field.integers();
  if (sizes.size() != std::size_t(count)) field.fail("as many sizes as NDims");
  for (const std::int64_t size : sizes) {
    if (size < 1 || size > 2147483647) field.fail("sizes from 1 to 2147483647");
  }
  return sizes;
}

/// Numbers of a field, or the format's defaults.
std::vector<double> numbers_of(const HeaderField& field, std::size_t count,
                               const std::vector<double>& fallback) {
  if (field.text.empty()) return fallback;
  std::vector<double> values = field.numbers();
  if (values.size() != count) field.fail(std::to_string(count) + " numbers");
  return values;
}

/// Geometry of the first three axes; time must not run through space.
Geometry parse_geometry(const MetaHeader& header, const std::vector<std::int64_t>& sizes,
                        const ReadOptions& options) {
  const std::size_t count = sizes.size(), spatial = std::min<std::size_t>(count, 3);
  const Vec3i dims = dims_from(header.field("DimSize"), {sizes.begin(), sizes.begin() + spatial});
  std::vector<double> unit_matrix(count * count, 0.0);
  for (std::size_t a = 0; a < count; ++a) unit_matrix[a * count + a] = 1;

  const HeaderField spacing_field = header.any_of({"ElementSpacing", "ElementSize"});
  const HeaderField matrix_field = header.any_of({"TransformMatrix", "Rotation", "Orientation"});
  auto spacing = numbers_of(spacing_field, count, std::vector<double>(count, 1.0));
  const auto offset = numbers_of(header.any_of({"Offset", "Origin", "Position"}), count,
                                 std::vector<double>(count, 0.0));
  const auto matrix = numbers_of(matrix_field, count * count, unit_matrix);
  Vec3d origin(0, 0, 0);
  std::array<Vec3d, 3> axes = {Vec3d(0, 0, 0), {0, 0, 0}, {0, 0, 1}};
  for (std::size_t a = 0; a < spatial; ++a) {
    spacing[a] = own_spacing(spacing[a], options);
    if (!(spacing[a] > 0)) spacing_field.fail("positive numbers");
    origin[int(a)] = offset[a];
    for (std::size_t c = 0; c < spatial; ++c) axes[a][int(c)] = matrix[a * count + c] * spacing[a];
  }
  for (std::size_t a = 0; count == 4 && a < 3; ++a) {
    if (matrix[a * 4 + 3] != 0 || matrix[12 + a] != 0) {
      matrix_field.fail("a matrix that does not mix time with space");
    }
  }
  return make_geometry(header.path, dims, origin, axes);
}

/// NAME of supple's own comment on a warp, "supple direction NAME, …"; empty in other comments.
std::string direction_in(const std::string& comment) {
  const std::string mark = "supple direction ";
  if (comment.compare(0, mark.size(), mark) != 0) return "";
  return comment.substr(mark.size(), comment.find(',') - mark.size());
}

void read_channels(const MetaHeader& header, VolumeHeader& volume) {
  const HeaderField channels = header.field("ElementNumberOfChannels");
  const std::int64_t count = channels.text.empty() ? 1 : channels.integer();
  if (count < 1 || count > 16) channels.fail("1 to 16 channels");
  volume.components = int(count);
  if (count != 3) return;
  volume.warp_direction = direction_in(header.field("Comment").text);
  volume.certificate = header.field("SuppleCertificate").text;
}

/// ITK passes over the unit that MetaIO may record.
void warn_of_unit(const MetaHeader& header, VolumeHeader& volume) {
  const std::string unit = header.field("DistanceUnits").text;
  if (unit.empty() || unit == "?" || lower_case(unit) == "mm") return;
  volume.warnings.push_back("DistanceUnits " + printable(unit) +
                            " is passed over, as in ITK: voxel sizes count as mm");
}

StreamLayout layout_of(const MetaHeader& header, const std::vector<std::int64_t>& sizes,
                       const ReadOptions& options) {
  StreamLayout layout;
  layout.header.path = header.path;
  layout.header.format = "metaimage";
  layout.header.geometry = parse_geometry(header, sizes, options);
  layout.header.type = parse_type(header.field("ElementType"));
  layout.frames = sizes.size() == 4 ? sizes[3] : 1;
  read_channels(header, layout.header);
  warn_of_unit(header, layout.header);

  const HeaderField binary = header.field("BinaryData");
  const HeaderField compressed = header.field("CompressedData");
  const bool is_text = !binary.text.empty() && !binary.boolean();
  if (!compressed.text.empty() && compressed.boolean()) {
    if (is_text) compressed.fail("False where BinaryData is False");
    layout.range.compression = Compression::deflate;
  } else if (is_text) {
    layout.range.compression = Compression::text;
  }
  const HeaderField order = header.any_of({"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
  layout.big_endian = !is_text && !order.text.empty() && order.boolean();
  const HeaderField slope = header.field("ElementToIntensityFunctionSlope");
  const HeaderField intercept = header.field("ElementToIntensityFunctionOffset");
  if (!slope.text.empty()) layout.header.slope = slope.number();
  if (!intercept.text.empty()) layout.header.intercept = intercept.number();
  return layout;
}

/// HeaderSize: bytes before the values of every file; -1 means that the values end with the file.
void apply_header_size(const MetaHeader& header, const InputFile& data, ByteRange& range) {
  const HeaderField field = header.field("HeaderSize");
  const std::int64_t skip = field.text.empty() ? 0 : field.integer();
  if (skip == 0) return;
  range.surplus = Surplus::ignore;
  if (skip == -1 && range.compression == Compression::none) {
    range.file_offset = std::max(range.file_offset, data.size() - range.size);
    return;
  }
  if (skip < 0) field.fail("0 or more, or -1 with uncompressed data");
  if (skip >= data.size() - range.file_offset) {
    field.fail("less than the file's " + std::to_string(data.size()) + " bytes");
  }
  range.file_offset += skip;
}

/// CompressedDataSize, where the header has it: the stream must be all there, and all there is.
void check_compressed_size(const MetaHeader& header, const InputFile& data,
                           const ByteRange& range) {
  const HeaderField field = header.field("CompressedDataSize");
  if (range.compression != Compression::deflate || field.text.empty()) return;
  const std::int64_t available = data.size() - range.file_offset;
  if (field.integer() == available) return;
  field.fail("the " + bytes_text(available) + " of compressed data in " + data.path());
}

/// "ElementDataFile = NAME", "= LIST [dimensions]" or "= FORMAT [min [max [step]]]".
DataFiles files_of(const MetaHeader& header, const std::vector<std::int64_t>& sizes) {
  const HeaderField field = header.field("ElementDataFile");
  DataFiles files;
  const std::vector<std::string> words = words_of(field.text);
  const auto integer = [&](std::size_t n, std::int64_t fallback) {
    if (n >= words.size()) return fallback;
    return HeaderField{field.file, field.name, words[n]}.integer();
  };
  const std::int64_t slabs = std::int64_t(sizes.size()) - 1;
  if (is_list(field.text)) {
    if (words.size() > 2) field.fail("LIST, or LIST and the dimensions of a file");
    files.count = std::int64_t(header.files.size());
    files.path_of = [field, names = header.files](std::int64_t n) {
      return data_path(field, names[std::size_t(n)]);
    };
    check_file_count(field, sizes, integer(1, slabs), files.count);
  } else if (field.text.find('%') != std::string::npos) {
    if (words.size() > 4) field.fail("FORMAT min max step");
    const std::int64_t first = integer(1, 1), last = integer(2, first + sizes.back() - 1);
    const NumberedFiles numbered(field, words[0], first, last, integer(3, 1));
    files.count = numbered.count();
    files.path_of = [field, numbered](std::int64_t n) {
      return data_path(field, numbered.name(n));
    };
    check_file_count(field, sizes, slabs, files.count);
  } else {
    files.path_of = [path = data_path(field, field.text)](std::int64_t) { return path; };
  }
  return files;
}

}  // namespace

std::unique_ptr<VolumeFile> open_metaimage(const std::string& path, const ReadOptions& options) {
  const auto file = std::make_shared<InputFile>(path);
  const MetaHeader header = parse_header(*file);
  const std::vector<std::int64_t> sizes = parse_sizes(header);
  StreamLayout layout = layout_of(header, sizes, options);
  layout.frame = chosen_frame(options, layout.frames, path, "DimSize");
  DataFiles files;
  if (lower_case(header.field("ElementDataFile").text) == "local") {
    files.path_of = [&path](std::int64_t) { return path; };
    layout.range.file_offset = std::int64_t(header.end);
  } else {
    files = files_of(header, sizes);
  }
  files.adapt = [&header, &files](const InputFile& data, ByteRange& range) {
    apply_header_size(header, data, range);
    if (files.count == 1) check_compressed_size(header, data, range);
  };
  return open_stream(files, std::move(layout));
}

}  // namespace supple
