// NRRD headers and the place of their values: attached or detached, in one file or several;
// encodings raw, gzip, bzip2, ascii and hex. The axes are those of nrrd_axes.h; `old min` and
// `old max` are left alone, as teem does.
// Source: http://teem.sourceforge.net/nrrd/format.html.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/format/data_files.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/nrrd/nrrd_axes.h"
#include "volumes/io/nrrd/nrrd_segments.h"

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

Compression parse_encoding(const HeaderField& field) {
  static const std::map<std::string, Compression> encodings = {
      {"raw", Compression::none},  {"gz", Compression::deflate},  {"gzip", Compression::deflate},
      {"bz2", Compression::bzip2}, {"bzip2", Compression::bzip2}, {"txt", Compression::text},
      {"text", Compression::text}, {"ascii", Compression::text},  {"hex", Compression::hex}};
  const auto found = encodings.find(lower_case(field.text));
  if (found == encodings.end()) field.fail("raw, gzip, bzip2, ascii or hex");
  return found->second;
}

bool is_big_endian(const NrrdHeader& header, ValueType type, Compression compression) {
  const HeaderField endian = header.field("endian");
  const std::string order = lower_case(endian.text);
  const bool needed = bytes_of(type) > 1 && compression != Compression::text;
  if (order != "little" && order != "big" && (needed || !order.empty())) {
    endian.fail("little or big");
  }
  return needed && order == "big";
}

/// The direction that supple's own writer records, or 3D Slicer: "modeling" moves points, and
/// "resampling" reads at the moved place.
std::string direction_of(const NrrdHeader& header) {
  const auto value_of = [&](const char* key) {
    const auto found = header.keys.find(key);
    return found == header.keys.end() ? std::string() : found->second;
  };
  const std::string own = value_of("supple direction");
  const HeaderField slicer{header.path, "displacement field type",
                           value_of("displacement field type")};
  if (slicer.text.empty()) return own;
  const std::string type = lower_case(slicer.text);
  if (type != "modeling" && type != "resampling") slicer.fail("modeling or resampling");
  const std::string direction = type == "modeling" ? "material" : "resample";
  if (!own.empty() && own != direction) slicer.fail("what fits \"supple direction\", " + own);
  return direction;
}

/// Geometry, axes, and the direction that is recorded.
void read_lattice(const NrrdHeader& header, const NrrdAxes& axes, const ReadOptions& options,
                  StreamLayout& layout) {
  VolumeHeader& volume = layout.header;
  volume.geometry = nrrd_geometry(header, axes, options);
  for (const std::string& warning : {warning_of_space(header), warning_of_units(header, axes)}) {
    if (!warning.empty()) volume.warnings.push_back(warning);
  }
  volume.components = axes.components;
  layout.order = axes.order;
  layout.frames = axes.frames;
  volume.are_vectors = axes.holds_vectors;
  if (!axes.holds_vectors) return;
  check_frame_of_vectors(header, axes);
  volume.warp_direction = direction_of(header);
  const auto certificate = header.keys.find("supple certificate");
  if (certificate != header.keys.end()) volume.certificate = certificate->second;
}

StreamLayout layout_of(const NrrdHeader& header, const NrrdAxes& axes, const ReadOptions& options) {
  StreamLayout layout;
  layout.header.path = header.path;
  layout.header.format = "nrrd";
  layout.header.type = parse_type(header.field("type"));
  read_lattice(header, axes, options, layout);
  layout.range.compression = parse_encoding(header.field("encoding"));
  layout.big_endian = is_big_endian(header, layout.header.type, layout.range.compression);
  return layout;
}

/// Line skips count in the file, byte skips behind them: in the file, or in what is decompressed.
void apply_skips(const NrrdHeader& header, const InputFile& data, ByteRange& range) {
  const HeaderField line_skip = header.field("line skip"), byte_skip = header.field("byte skip");
  const std::int64_t lines = header.has("line skip") ? line_skip.integer() : 0;
  const std::int64_t bytes = header.has("byte skip") ? byte_skip.integer() : 0;
  if (lines < 0) line_skip.fail("0 or more");
  if (lines != 0 || bytes != 0) range.surplus = Surplus::ignore;
  range.file_offset = skip_lines(data, range.file_offset, lines, line_skip);
  if (bytes == -1 && range.compression == Compression::none) {
    range.file_offset = std::max(range.file_offset, data.size() - range.size);
    return;
  }
  if (bytes < 0) byte_skip.fail("0 or more, or -1 with encoding raw");
  if (range.compression == Compression::deflate || range.compression == Compression::bzip2)
    range.stream_offset = bytes;
  else if (bytes > 0 && bytes >= data.size() - range.file_offset)
    byte_skip.fail("less than the file's " + std::to_string(data.size()) + " bytes");
  else
    range.file_offset += bytes;
}

/// "data file: NAME", "data file: LIST [subdim]" or "data file: FORMAT min max step [subdim]".
DataFiles files_of(const NrrdHeader& header, const NrrdAxes& axes) {
  const HeaderField field = header.field("data file");
  DataFiles files;
  const std::vector<std::string> words = words_of(field.text);
  const bool is_list = !words.empty() && words[0] == "LIST";
  const bool is_numbered = words.size() > 3 && words[0].find('%') != std::string::npos;
  const auto integer = [&](std::size_t n) {
    return HeaderField{field.file, field.name, words[n]}.integer();
  };
  if (!is_list && !is_numbered) {
    files.path_of = [path = data_path(field, field.text)](std::int64_t) { return path; };
    return files;
  }

  const std::size_t expected = is_list ? 1 : 4;
  if (words.size() != expected && words.size() != expected + 1) {
    field.fail("LIST [dimensions], or FORMAT min max step [dimensions]");
  }
  if (is_list) {
    files.count = std::int64_t(header.files.size());
    files.path_of = [field, names = header.files](std::int64_t n) {
      return data_path(field, names[std::size_t(n)]);
    };
  } else {
    const NumberedFiles numbered(field, words[0], integer(1), integer(2), integer(3));
    files.count = numbered.count();
    files.path_of = [field, numbered](std::int64_t n) {
      return data_path(field, numbered.name(n));
    };
  }
  const std::int64_t all = std::int64_t(axes.sizes.size());
  check_file_count(field, axes.sizes, words.size() > expected ? integer(expected) : all - 1,
                   files.count);
  return files;
}

}  // namespace

std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, const ReadOptions& options) {
  const auto file = std::make_shared<InputFile>(path);
  const NrrdHeader header = parse_nrrd_header(*file);
  if (lower_case(header.field("type").text) == "block") {
    header.field("type").fail("numbers, not blocks");
  }
  const NrrdAxes axes = nrrd_axes(header);
  StreamLayout layout = layout_of(header, axes, options);
  layout.frame = chosen_frame(options, axes.frames, path, "sizes");
  DataFiles files;
  if (header.has("data file")) {
    files = files_of(header, axes);
  } else {
    files.path_of = [&path](std::int64_t) { return path; };
    layout.range.file_offset = std::int64_t(header.end);
  }
  files.adapt = [&header](const InputFile& data, ByteRange& range) {
    apply_skips(header, data, range);
  };
  const bool merges = !options.channel;
  const auto segments =
      merges ? nrrd_segments(header, axes.components) : std::vector<NrrdSegment>{};
  for (const NrrdSegment& segment : segments) {
    layout.header.label_names.emplace_back(segment.label, segment.name);
  }
  return with_layers_merged(open_stream(files, std::move(layout)), segments);
}

}  // namespace supple
