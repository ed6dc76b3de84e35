// The readers behind open_volume, one per format. Each takes the path as the user gave it, throws
// InputError for every fault of the file, and returns the volume before its first slice.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/format/volume_file.h"

namespace supple {

/// NRRD 1 to 5, attached or detached, raw or gzip (teem.sourceforge.net/nrrd/format.html).
std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, const ReadOptions& options);
/// MetaImage, .mha or .mhd (itk.org/Wiki/ITK/MetaIO/Documentation).
std::unique_ptr<VolumeFile> open_metaimage(const std::string& path, const ReadOptions& options);
/// NIfTI-1 and NIfTI-2: single file or .hdr with .img, each of them gzipped or not.
std::unique_ptr<VolumeFile> open_nifti(const std::string& path, const ReadOptions& options);
/// GIPL (itkGiplImageIO.cxx).
std::unique_ptr<VolumeFile> open_gipl(const std::string& path, const ReadOptions& options);
/// One grey image as a one-slice volume.
std::unique_ptr<VolumeFile> open_png(const std::string& path);
/// TIFF and BigTIFF of one page or many; ImageJ stacks and OME-TIFF.
std::unique_ptr<VolumeFile> open_tiff(const std::string& path, const ReadOptions& options);
/// VTK's XML image data with one array, or one that the file calls its scalars or vectors.
std::unique_ptr<VolumeFile> open_vti(const std::string& path);
/// A grid of floats or of vectors of an OpenVDB file that is no state.
std::unique_ptr<VolumeFile> open_vdb(const std::string& path);
/// HDF5: ITK images and transforms, NeXus, or a dataset named as `file.h5:/path`.
std::unique_ptr<VolumeFile> open_hdf5(const std::string& path, const ReadOptions& options);
/// "file.h5" of "file.h5:/path" where that is a file; else `path`.
std::string file_part(const std::string& path);
/// Headerless values, described by `raw`.
std::unique_ptr<VolumeFile> open_raw(const std::string& path, const std::string& spec);

/// Throws InputError for a file of vectors.
void require_scalars(const VolumeHeader& header);

/// The frame that `options` choose among `count`; 0 where there is but one. Throws InputError for a
/// choice beyond them and for several without a choice, naming `field` of the file.
int chosen_frame(const ReadOptions& options, std::int64_t count, const std::string& path,
                 const std::string& field);

/// A file's own voxel size along one axis; 1 where that is no length and `options` replace it.
double own_spacing(double spacing, const ReadOptions& options);

/// Opens one component of a file of several, as scalars.
std::unique_ptr<VolumeFile> open_channel(std::unique_ptr<VolumeFile> file, int channel);

/// True when the bytes (348 or more of them) are a NIfTI header.
bool is_nifti_head(const std::string& head);
/// True when the bytes (256 or more of them) are a GIPL header.
bool is_gipl_head(const std::string& head);

/// Geometry of a plain image, which says nothing about millimetres or the patient: 1 mm pixels,
/// columns towards L (+x), rows downward towards P (+y), as an axial slice is drawn in radiology.
Geometry image_geometry(const std::string& path, std::int64_t width, std::int64_t height);

}  // namespace supple
