// Loads the plugin that reads DICOM. Cost: about 15 ms and 8 MB, once, when the first DICOM file is
// met.
#include "volumes/io/dicom/dicom.h"

#include "volumes/io/dicom/dicom_plugin.h"

namespace supple {

std::unique_ptr<VolumeFile> open_dicom(const std::string& path, const ReadOptions& options) {
#ifdef SUPPLE_WITHOUT_DICOM
  throw InputError({path, "format", "DICOM, which this program was built without",
                    "another format, or a program built with SUPPLE_DICOM=ON"});
#else
  static const DicomPlugin& plugin = plugin_entry<DicomPlugin>();
  return plugin.open(path, options);
#endif
}

}  // namespace supple
