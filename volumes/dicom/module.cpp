// The module's only exported symbol (dicom_module.h).
#include "volumes/dicom/dicom_module.h"
#include "volumes/dicom/dicom_volume.h"

extern "C" __attribute__((visibility("default"))) const supple::DicomModule supple_dicom_module;

const supple::DicomModule supple_dicom_module = {supple::DicomModule::kSizes, supple::open_series};
