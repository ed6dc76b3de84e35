#include "volumes/io/format/dense_writer.h"

#include <algorithm>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

using Create = std::unique_ptr<DenseWriter> (*)(const std::string& path,
                                                const std::string& raw_path,
                                                const DenseImage& image,
                                                const WriteOptions& options);

struct OutputFormat {
  const char* extension;
  Create create;
  bool is_detached;    // values in a .raw file beside the header
  bool keeps_scaling;  // records slope and intercept
  bool compresses;     // on request
};

constexpr OutputFormat kFormats[] = {
    {".nrrd", create_nrrd, false, false, true},      //
    {".nhdr", create_nrrd, true, false, false},      //
    {".mha", create_metaimage, false, false, true},  //
    {".mhd", create_metaimage, true, false, false},  //
    {".nii", create_nifti, false, true, false},      //
    {".nii.gz", create_nifti, false, true, false},   //
    {".tif", create_tiff, false, false, true},       //
    {".tiff", create_tiff, false, false, true},      //
    {".vdb", create_vdb, false, false, false},       //
    {".vti", create_vti, false, false, false},       //
    {".h5", create_hdf5, false, false, true},        //
    {".hdf5", create_hdf5, false, false, true},      //
};

std::string all_extensions() {
  std::string text;
  const std::size_t count = std::size(kFormats);
  for (std::size_t n = 0; n < count; ++n) {
    text += n == 0 ? "" : n + 1 == count ? " or " : ", ";
    text += kFormats[n].extension;
  }
  return text;
}

const OutputFormat& format_of(const std::string& path) {
  const std::string name = lower_case(std::filesystem::path(path).filename().string());
  for (const OutputFormat& format : kFormats) {
    const std::string extension = format.extension;
    if (name.size() > extension.size() &&
        name.compare(name.size() - extension.size(), extension.size(), extension) == 0) {
      return format;
    }
  }
  const std::string found = std::filesystem::path(name).extension().string();
  throw InputError({path, "extension", found.empty() ? "none" : found, all_extensions()});
}

/// Options that OpenVDB alone has.
void require_vdb_options(const std::string& path, const OutputFormat& format,
                         const DenseImage& image, const WriteOptions& options) {
  const bool is_vdb = format.create == create_vdb;
  const auto require = [&](const char* name, bool is_given, bool is_allowed, const char* expected) {
    if (is_given && !is_allowed) throw InputError({path, name, format.extension, expected});
  };
  require("scale", options.scale != 1, is_vdb, "OpenVDB (.vdb)");
  require("half", options.half, is_vdb, "OpenVDB (.vdb)");
  require("velocity", bool(options.velocity), is_vdb, "OpenVDB (.vdb)");
  if (!options.range) return;
  require("range", true, is_vdb && image.components == 1, "densities in OpenVDB (.vdb)");
  if (options.range->first < options.range->second) return;
  throw InputError({path, "range",
                    number_text(options.range->first) + "," + number_text(options.range->second),
                    "the smaller one first"});
}

std::string raw_path_of(const std::string& path, const OutputFormat& format) {
  if (!format.is_detached) return "";
  return std::filesystem::path(path).replace_extension(".raw").string();
}

}  // namespace

std::unique_ptr<DenseWriter> create_dense(const std::string& path, const DenseImage& image,
                                          const WriteOptions& options) {
  const OutputFormat& format = format_of(path);
  if (options.compress && !format.compresses) {
    throw InputError({path, "compress", format.extension, "a format that compresses on request"});
  }
  if (options.ras_vectors && std::string(format.extension).compare(0, 4, ".nii") != 0) {
    throw InputError({path, "intent", format.extension, "a NIfTI warp"});
  }
  require_vdb_options(path, format, image, options);
  return format.create(path, raw_path_of(path, format), image, options);
}

std::vector<std::string> output_files(const std::string& path) {
  const std::string raw_path = raw_path_of(path, format_of(path));
  if (raw_path.empty()) return {path};
  return {path, raw_path};
}

bool keeps_bricks(const std::string& path) {
  return format_of(path).create == create_vdb;
}

bool keeps_scaling(const std::string& path) {
  return format_of(path).keeps_scaling;
}

void require_perpendicular(const DenseImage& image, const std::string& path,
                           const std::string& format) {
  if (image.geometry.is_orthogonal()) return;
  throw InputError({path, "geometry", "sheared axes",
                    "perpendicular axes in " + format + " (NRRD keeps shear)"});
}

std::string file_name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

Fields fields(WriteOptions& options) {
  return {
      Field("compress", options.compress, "Deflate the values (NRRD, MetaImage, TIFF, HDF5)"),
  };
}

Fields vector_fields(WriteOptions& options) {
  return {
      Field("intent", options.ras_vectors, {"1007", "1006"},
            "NIfTI: 1007, vectors in LPS, or 1006, in RAS"),
  };
}

}  // namespace supple
