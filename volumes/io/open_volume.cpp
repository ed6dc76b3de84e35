// Chooses the reader by content first, extension second.
#include <algorithm>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/dicom/dicom.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/images/image_series.h"
#include "volumes/io/tiff/tiff_directories.h"
#include "volumes/io/transform/transform_volume.h"
#include "volumes/io/vtu/vtu.h"

namespace supple {

namespace {

// Enough for the longest binary header that is recognised (NIfTI-2).
constexpr std::size_t kHeadBytes = 1024;

bool starts_with(const std::string& head, const std::string& mark) {
  return head.compare(0, mark.size(), mark) == 0;
}

/// The first key of every MetaImage header that is written in practice.
bool is_metaimage(const std::string& head) {
  for (const char* key : {"ObjectType", "NDims", "Comment", "ObjectSubType"}) {
    if (!starts_with(head, key)) continue;
    const std::size_t next = head.find_first_not_of(" \t", std::string(key).size());
    if (next != std::string::npos && head[next] == '=') return true;
  }
  return false;
}

bool is_openvdb(const std::string& head) {
  return starts_with(head, std::string(" BDV\0\0\0\0", 8));
}

bool is_hdf5(const std::string& head) {
  return starts_with(head, "\x89HDF\r\n\x1a\n");
}

/// ITK's transforms in MATLAB's format 4, as ANTs writes them: the name of a matrix at byte 20.
bool is_binary_transform(const std::string& head) {
  constexpr std::size_t kNameAt = 20, kLongestName = 64;
  if (head.size() < kNameAt || head.find('\0') >= kNameAt) return false;
  const std::string name = head.substr(kNameAt, kLongestName);
  return name.find("Transform") != std::string::npos && name.find("_3_3") != std::string::npos;
}

std::string extension_of(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string last = lower_case(file.extension().string());
  if (last != ".gz") return last;
  return lower_case(file.stem().extension().string()) + last;
}

/// Throws InputError for a gzipped file that neither holds NIfTI nor is named so.
void require_nifti(const std::string& path, const std::string& head) {
  const std::string extension = extension_of(path);
  if (is_nifti_head(head) || extension == ".nii.gz" || extension == ".nii" ||
      extension == ".hdr.gz" || extension == ".hdr" || extension == ".img.gz") {
    return;
  }
  throw InputError(
      {path, "format", "a gzipped file that is not NIfTI", "the file unpacked (gunzip)"});
}

/// The reader of a file, by content first and extension second.
std::unique_ptr<VolumeFile> open_known(const std::string& path, const ReadOptions& options) {
  if (!options.raw.empty()) return open_raw(path, options.raw);
  if (file_part(path) != path) return open_hdf5(path, options);
  if (holds_dicom(path)) return open_dicom(path, options);
  if (std::filesystem::is_directory(path) || is_series_pattern(path)) {
    return open_image_series(path, options);
  }
  std::string head;
  {
    const InputFile file(path);
    head = file.head(kHeadBytes);
    if (is_gzip(head)) {
      head = gzip_head(file, kHeadBytes);
      require_nifti(path, head);
    }
  }

  if (is_dicom(head)) return open_dicom(path, options);
  if (starts_with(head, "NRRD")) return open_nrrd(path, options);
  if (starts_with(head, "\x89PNG\r\n\x1a\n")) return open_png(path);
  if (is_tiff(head)) return open_tiff(path, options);
  if (is_nifti_head(head)) return open_nifti(path, options);
  if (is_metaimage(head)) return open_metaimage(path, options);
  if (is_gipl_head(head)) return open_gipl(path, options);
  if (is_hdf5(head)) return open_hdf5(path, options);
  if (is_openvdb(head)) return open_vdb(path);
  const TransformKind transform = transform_kind(head);
  if (transform != TransformKind::none) return open_transform(path, transform, options.grid);
  if (is_vtu(head)) return open_vtu(path, options.grid);
  if (is_vti(head)) return open_vti(path);
  if (is_binary_transform(head)) {
    throw InputError({path, "format", "a transform in ITK's binary .mat",
                      "its text: ConvertTransformFile 3 NAME.mat NAME.tfm (of ANTs) makes it"});
  }

  const std::string extension = extension_of(path);
  if (extension == ".nrrd" || extension == ".nhdr") return open_nrrd(path, options);
  if (extension == ".mha" || extension == ".mhd") return open_metaimage(path, options);
  if (extension == ".nii" || extension == ".nii.gz" || extension == ".hdr" ||
      extension == ".hdr.gz" || extension == ".img" || extension == ".img.gz") {
    return open_nifti(path, options);
  }
  if (extension == ".h5" || extension == ".hdf5" || extension == ".hdf" || extension == ".nxs" ||
      extension == ".he5") {
    return open_hdf5(path, options);
  }
  if (extension == ".gipl") return open_gipl(path, options);
  if (extension == ".png") return open_png(path);
  if (extension == ".tif" || extension == ".tiff") return open_tiff(path, options);
  if (extension == ".raw" || extension == ".bin") {
    throw InputError({path, "format", "headerless raw values",
                      "its .nhdr or .mhd header, or raw dims=X,Y,Z,type=T,spacing=A,B,C"});
  }
  throw InputError(
      {path, "format", "unknown content",
       "NRRD, MetaImage, NIfTI, GIPL, DICOM, HDF5, OpenVDB, VTI, TIFF, PNG, or raw values "
       "described by raw"});
}

/// Readers and loaders hold slices; no scanner makes larger ones.
void check_slice(const VolumeHeader& header) {
  constexpr double kMaxSliceBytes = 2147483648.0;
  const Vec3i& dims = header.geometry.dims();
  const int width = std::max(bytes_of(header.type), int(sizeof(float)));
  if (double(dims.x) * dims.y * header.components * width <= kMaxSliceBytes) return;
  throw InputError({header.path, "slice",
                    std::to_string(dims.x) + " x " + std::to_string(dims.y) + " voxels",
                    "at most 2 GiB in memory"});
}

/// Readers of several frames choose among them by themselves.
bool has_frames(const std::string& format) {
  return format != "png" && format != "raw" && format != "vdb" && format != "transform" &&
         format != "vtu" && format != "vti";
}

}  // namespace

std::unique_ptr<VolumeFile> open_scalars_or_vectors(const std::string& path,
                                                    const ReadOptions& options) {
  std::unique_ptr<VolumeFile> file = open_known(path, options);
  check_slice(file->header());
  if (!has_frames(file->header().format)) chosen_frame(options, 1, path, "frames");
  if (options.spacing_mm) file->set_spacing(*options.spacing_mm);
  if (options.channel) file = open_channel(std::move(file), *options.channel);
  return file;
}

std::unique_ptr<VolumeFile> open_volume(const std::string& path, const ReadOptions& options,
                                        Progress* progress) {
  std::unique_ptr<VolumeFile> file = open_scalars_or_vectors(path, options);
  require_scalars(file->header());
  for (const std::string& line : file->header().warnings) warn(progress, path + ": " + line);
  return file;
}

std::vector<std::string> files_of(const VolumeHeader& header) {
  std::vector<std::string> files = header.data_files;
  files.push_back(file_part(header.path));
  return files;
}

Fields fields(ReadOptions& options) {
  return {
      Field("raw", options.raw,
            "Headerless raw: dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=N]"),
      Field("frame", options.frame, "One volume of a time series, from 0").at_least(0),
      Field("channel", options.channel, "One of several values per voxel, from 0").at_least(0),
      Field("spacing", options.spacing_mm, "Voxel size in mm in place of the file's")
          .shown_as("A,B,C"),
  };
}

}  // namespace supple
