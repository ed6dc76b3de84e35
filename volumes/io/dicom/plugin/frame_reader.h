// The pixels of single frames: straight from the file where they are stored as they are, inflated,
// or decoded by DCMTK (RLE, JPEG, JPEG-LS) or OpenJPEG (JPEG 2000).
// Cost: one file open at a time; one frame and its compressed bytes in memory.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
// DCMTK wants osconfig.h first.
#include <dcmtk/dcmdata/dcfcache.h>

#include "volumes/io/dicom/plugin/dicom_image.h"

namespace supple {

/// Finds the place of the values of `frames` frames. Throws InputError when there are no pixels or
/// the file is too short to hold them.
PixelPlace check_pixels(const DicomFile& file, const PixelFormat& format, int frames);

class FrameReader {
 public:
  /// Reads one frame as it is stored, in native byte order, unpacked (unpack_stored_bits). Throws
  /// InputError when the data end early or cannot be decoded.
  void read(const DicomImage& image, int frame, void* out);

 private:
  void read_native(const DicomImage& image, int frame, char* out) const;
  void read_encapsulated(const DicomImage& image, int frame, void* out);
  void open_encapsulated(const DicomImage& image);

  std::string m_path;  // of the open file
  std::unique_ptr<DcmFileFormat> m_file;
  DcmPixelData* m_pixels = nullptr;
  DcmFileCache m_cache;
  Uint32 m_next_fragment = 0;
  int m_next_frame = 0;
  std::vector<char> m_buffer;
};

}  // namespace supple
