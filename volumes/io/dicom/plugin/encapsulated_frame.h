// Compressed frames before they are decoded: their bytes, and checks that DCMTK's decoders leave
// out.
#pragma once

#include <cstdint>
#include <string>

#include <dcmtk/config/osconfig.h>
// DCMTK wants osconfig.h first.
#include <dcmtk/dcmdata/dcpixel.h>

#include "volumes/io/dicom/plugin/dicom_image.h"

namespace supple {

/// An integer of `width` bytes.
std::uint32_t number_at(const std::string& bytes, std::size_t at, std::size_t width, bool big);

/// Compares the frame header of a JPEG stream (T.81, B.2.2) with the attributes: the decoder goes
/// by the stream and would leave parts of a frame unset. Throws InputError where they differ.
void check_first_frame(const DicomImage& image, DcmPixelData& pixels);

/// Throws InputError for a frame of RLE whose segments lie outside its fragment, or out of order
/// (PS3.5, G.5): DCMTK 3.6.7 reads them wherever they are said to be.
void check_frame(const DicomImage& image, DcmPixelData& pixels, int frame);

/// The codestream of a frame of JPEG 2000, whose fragments may be several: each frame begins with a
/// fragment that begins a codestream. Throws InputError where there is no such frame.
std::string frame_bytes(const DicomImage& image, DcmPixelData& pixels, int frame);

}  // namespace supple
