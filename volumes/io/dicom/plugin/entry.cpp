// The plugin's only exported symbol (dicom_plugin.h).
#include "volumes/io/dicom/dicom_plugin.h"
#include "volumes/io/dicom/plugin/dicom_volume.h"

extern "C" __attribute__((visibility("default"))) const supple::DicomPlugin supple_dicom_plugin;

const supple::DicomPlugin supple_dicom_plugin = {supple::DicomPlugin::kSizes, supple::open_series};
