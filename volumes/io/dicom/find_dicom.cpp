// Tells DICOM files by their content: "DICM" behind a preamble of 128 bytes (PS3.10, 7.1).
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/dicom/dicom.h"

namespace supple {

bool is_dicom(const std::string& head) {
  return head.size() >= 132 && head.compare(128, 4, "DICM") == 0;
}

bool holds_dicom(const std::string& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    std::error_code unknown;
    // Pipes and devices are not even opened: that alone can block or have effects.
    if (!entry->is_regular_file(unknown) || entry->file_size(unknown) < 132) continue;
    try {
      if (is_dicom(InputFile(entry->path().string()).head(132))) return true;
    } catch (const Error&) {
      continue;
    }
  }
  return false;
}

}  // namespace supple
