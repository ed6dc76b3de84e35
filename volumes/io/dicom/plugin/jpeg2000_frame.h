// Frames in JPEG 2000 (PS3.5, A.4.4), which DCMTK leaves to other libraries: decoded by OpenJPEG.
#pragma once

#include <string>

#include "volumes/io/dicom/plugin/dicom_image.h"

namespace supple {

/// True for both syntaxes of single components, lossless and not.
bool is_jpeg2000(E_TransferSyntax syntax);

/// Decodes the codestream of a frame into values of the allocated width. The stream's main
/// header is compared with the attributes, and its tiles and blocks are counted, before the decoder
/// allocates anything. Throws InputError where they differ or are too many, and for a stream that
/// ends early or cannot be decoded.
/// Cost: 4 bytes per pixel beside `out`.
void decode_jpeg2000(const DicomImage& image, int frame, const std::string& codestream, void* out);

}  // namespace supple
