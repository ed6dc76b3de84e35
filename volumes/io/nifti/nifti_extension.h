// Records of our own NIfTI files beside the format's fields: one header extension of the code 6
// (comment), a text of lines "supple direction: resample" and "supple certificate: {json}".
#pragma once

#include <string>

#include "volumes/io/format/volume_file.h"
#include "volumes/io/nifti/nifti_header.h"

namespace supple {

/// Reads direction and certificate from the extensions into `volume`. Extensions are looked at in
/// the header's first MiB; others than comments are passed over. One that is damaged ends the list
/// with a warning, since the values do not depend on it (nibabel refuses the file, libnifti goes on
/// in silence).
void read_nifti_extensions(const InputFile& file, const NiftiHeader& header, VolumeHeader& volume);

/// The extender and the extension, a multiple of 16 bytes behind the extender; only the extender
/// where there is nothing to say.
std::string nifti_extension(const std::string& direction, const std::string& certificate);

}  // namespace supple
