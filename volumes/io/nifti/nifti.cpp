// NIfTI-1 and NIfTI-2: one file (.nii) or .hdr with .img, each gzipped or not, either byte order.
// Source: nifti1.h and nifti2.h. Bytes behind the values are legal in NIfTI and are skipped.
// One frame of a time series (dim[4]) is read; what precedes it is skipped, or decoded where the
// file is gzipped. Several values per voxel are dim[5], components slowest, or the colours RGB24
// and RGBA32. Of n components in a gzipped file the whole stream is decoded (n + 1) / 2 times.
// Vectors are LPS, as ANTs, ITK and elastix write them with intent 1007, except for intent 1006
// (displacements in the file's own frame), which are RAS. Where magic and extension differ, the
// content decides: "n+1" in a .hdr without values behind the header reads the .img beside it, "ni1"
// with an offset behind the header reads the file itself.
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/streamed_volume.h"
#include "volumes/io/nifti/nifti_extension.h"
#include "volumes/io/nifti/nifti_header.h"

namespace supple {

namespace {

/// Type and number of the values at one place of the file.
struct NiftiSamples {
  ValueType type;
  int components;  // together: colours
};

NiftiSamples parse_samples(const std::string& path, const nifti_2_header& header) {
  static constexpr struct {
    int datatype;
    NiftiSamples samples;
  } kTypes[] = {
      {DT_INT8, {ValueType::int8, 1}},       {DT_UINT8, {ValueType::uint8, 1}},
      {DT_INT16, {ValueType::int16, 1}},     {DT_UINT16, {ValueType::uint16, 1}},
      {DT_INT32, {ValueType::int32, 1}},     {DT_UINT32, {ValueType::uint32, 1}},
      {DT_INT64, {ValueType::int64, 1}},     {DT_UINT64, {ValueType::uint64, 1}},
      {DT_FLOAT32, {ValueType::float32, 1}}, {DT_FLOAT64, {ValueType::float64, 1}},
      {DT_RGB24, {ValueType::uint8, 3}},     {DT_RGBA32, {ValueType::uint8, 4}},
  };
  for (const auto& [datatype, samples] : kTypes) {
    if (datatype != header.datatype) continue;
    const int bits = 8 * bytes_of(samples.type) * samples.components;
    if (header.bitpix != bits) {
      fail_nifti(path, "bitpix", header.bitpix,
                 std::to_string(bits) + " for datatype " + std::to_string(datatype));
    }
    return samples;
  }
  fail_nifti(path, "datatype", header.datatype,
             "an integer or floating-point type, RGB24 or RGBA32 (2, 4, 8, 16, 64, 128, 256 ... "
             "1280, 2304)");
}

/// The axes dim[1] to dim[5].
struct NiftiAxes {
  Vec3i dims{1, 1, 1};
  std::int64_t frames = 1;
  int planes = 1;  // components, slowest
};

NiftiAxes parse_axes(const std::string& path, const nifti_2_header& header) {
  constexpr std::int64_t kMaxDim = 2147483647, kMaxPlanes = 16;
  const std::int64_t count = header.dim[0];
  if (count < 1 || count > 7) fail_nifti(path, "dim[0]", double(count), "1 to 7");
  NiftiAxes axes;
  for (int a = 1; a <= int(count); ++a) {
    const std::string field = "dim[" + std::to_string(a) + "]";
    const std::int64_t size = header.dim[a];
    const std::int64_t most = a <= 4 ? kMaxDim : a == 5 ? kMaxPlanes : 1;
    if (size < 1 || size > most) {
      fail_nifti(path, field, double(size), most == 1 ? "1" : "1 to " + std::to_string(most));
    }
    if (a <= 3) axes.dims[a - 1] = int(size);
    if (a == 4) axes.frames = size;
    if (a == 5) axes.planes = int(size);
  }
  return axes;
}

/// A slope of 0 or none means values as they are; colours have no scaling.
void parse_scaling(const std::string& path, const nifti_2_header& header, VolumeHeader& volume) {
  const double slope = header.scl_slope, intercept = header.scl_inter;
  if (!std::isfinite(slope) || slope == 0) return;
  if (!std::isfinite(intercept)) fail_nifti(path, "scl_inter", intercept, "a finite number");
  volume.slope = slope;
  volume.intercept = intercept;
}

/// True if three values may be a displacement in mm: SPM's y_*.nii and fields of NiftyReg hold
/// places, and FSL's coefficients and warps have axes of their own.
bool may_be_displacement(const nifti_2_header& header) {
  const std::string name(header.intent_name,
                         strnlen(header.intent_name, sizeof header.intent_name));
  if (name == "Mapping" || name.compare(0, 4, "NREG") == 0) return false;
  return header.intent_code == NIFTI_INTENT_NONE || header.intent_code == NIFTI_INTENT_VECTOR ||
         header.intent_code == NIFTI_INTENT_DISPVECT;
}

void parse_intent(const std::string& path, const nifti_2_header& header, VolumeHeader& volume) {
  volume.are_vectors = may_be_displacement(header);
  const bool is_displacement = header.intent_code == NIFTI_INTENT_DISPVECT;
  if (!is_displacement && header.intent_code != NIFTI_INTENT_VECTOR) return;
  const int unit = XYZT_TO_SPACE(header.xyzt_units);
  if (unit == NIFTI_UNITS_METER || unit == NIFTI_UNITS_MICRON) {
    fail_nifti(path, "xyzt_units", header.xyzt_units, "mm (2) in a file of vectors");
  }
  volume.vectors_in_ras = is_displacement && volume.components == 3;
}

/// "scan.img.gz" with `from` ".img" and `to` ".hdr" becomes "scan.hdr.gz" or, where that does not
/// exist, "scan.hdr". The path itself where its extension is another one.
std::string partner(const std::string& path, const std::string& from, const std::string& to) {
  std::string stem = path, suffix;
  if (lower_case(std::filesystem::path(path).extension().string()) == ".gz") {
    suffix = path.substr(path.size() - 3);
    stem.resize(path.size() - 3);
  }
  const std::filesystem::path file(stem);
  if (lower_case(file.extension().string()) != from) return path;
  const std::string plain = stem.substr(0, stem.size() - from.size()) + to;
  for (const std::string& candidate : {plain + suffix, plain, plain + ".gz"}) {
    if (std::filesystem::exists(candidate)) return candidate;
  }
  return plain;
}

/// The file of the values and where they start in it.
struct NiftiValues {
  std::shared_ptr<const InputFile> file;
  std::int64_t offset = 0;
};

NiftiValues place_of_values(const std::shared_ptr<const InputFile>& header_file,
                            const NiftiHeader& header) {
  const std::string& path = header_file->path();
  const std::int64_t behind = header.size() + 4;
  const std::string beside = partner(path, ".hdr", ".img");
  bool in_one_file = header.in_one_file;
  if (in_one_file && beside != path && std::filesystem::exists(beside)) {
    const std::size_t some = std::size_t(behind) + 1;
    in_one_file = nifti_head(*header_file, some).size() == some;
  }
  if (!in_one_file && beside == path) {
    if (header.values.vox_offset < behind) {
      throw InputError({path, "magic", "that of a header whose values are in an .img file",
                        "n+1 or n+2, or the name of a .hdr file"});
    }
    in_one_file = true;
  }

  std::int64_t offset = header.values.vox_offset;
  const std::int64_t least = in_one_file ? behind : 0;
  if (offset == 0 || (header.in_one_file && !in_one_file)) offset = least;
  if (offset < least || offset > std::int64_t(1) << 50) {
    fail_nifti(path, "vox_offset", double(offset), std::to_string(least) + " or more");
  }
  return {in_one_file ? header_file : std::make_shared<InputFile>(beside), offset};
}

std::unique_ptr<VolumeFile> open_values(const NiftiAxes& axes, const NiftiValues& values,
                                        StreamLayout layout) {
  using Axis = StoredAxis;
  if (axes.planes > 1) layout.order = {Axis::i, Axis::j, Axis::k, Axis::frame, Axis::component};
  const bool deflated = is_gzip(values.file->head(2));
  layout.range.compression = deflated ? Compression::deflate : Compression::none;
  layout.range.surplus = Surplus::ignore;
  (deflated ? layout.range.stream_offset : layout.range.file_offset) = values.offset;
  return open_stream(values.file, std::move(layout));
}

}  // namespace

std::unique_ptr<VolumeFile> open_nifti(const std::string& path, const ReadOptions& options) {
  const std::string header_path = partner(path, ".img", ".hdr");
  const auto header_file = std::make_shared<InputFile>(header_path);
  NiftiHeader header;
  constexpr std::size_t kLongestHeader = 540;
  if (!decode_nifti(nifti_head(*header_file, kLongestHeader), header)) {
    throw InputError({header_path, "header", "no NIfTI-1 or NIfTI-2 header",
                      "sizeof_hdr 348 or 540 and magic n+1, ni1, n+2 or ni2"});
  }
  StreamLayout layout;
  layout.big_endian = header.big_endian;
  VolumeHeader& volume = layout.header;
  volume.path = path;
  volume.data_files = {header_path};
  volume.format = "nifti";
  const NiftiSamples samples = parse_samples(header_path, header.values);
  const NiftiAxes axes = parse_axes(header_path, header.values);
  if (samples.components > 1 && axes.planes > 1) {
    fail_nifti(header_path, "dim[5]", axes.planes, "1 where a voxel is a colour");
  }
  volume.type = samples.type;
  volume.components = samples.components * axes.planes;
  volume.geometry = nifti_geometry(header_path, header.values, axes.dims, options, volume.warnings);
  if (samples.components == 1) parse_scaling(header_path, header.values, volume);
  parse_intent(header_path, header.values, volume);
  volume.are_vectors = volume.are_vectors && samples.components == 1;
  read_nifti_extensions(*header_file, header, volume);

  layout.frames = axes.frames;
  layout.frame = chosen_frame(options, axes.frames, path, "dim[4]");
  return open_values(axes, place_of_values(header_file, header), std::move(layout));
}

}  // namespace supple
