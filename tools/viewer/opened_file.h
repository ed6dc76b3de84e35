// A file that is opened in the viewer, as the root of a scene; and what is assumed of a scan: its
// material where none is given, by its modality, and that CT is seen from outside.
#pragma once

#include <string>

#include "tools/viewer/folders.h"
#include "volumes/base/progress.h"
#include "volumes/base/table.h"

namespace supple::tools {

/// Name of a material in which all voxels above the least density are tissue of one kind.
constexpr const char* kUniform = "uniform";

struct OpenedFile {
  Table root;
  std::string assumed;   // what was assumed for want of a material, one line; empty: nothing
  bool is_scan = false;  // a volume or a state, which does not say how it is looked at
  std::string modality;  // by the header of a volume, such as "CT"; empty: not said
};

/// A scene or journal is its own root. Of a volume the material is one that is given (a preset, the
/// path of a table, or kUniform), else the preset that fits its modality, by DICOM's (0008,0060) or
/// else by its densities. Throws InputError.
OpenedFile opened_file(const std::string& path, const std::string& material,
                       const std::string& preset, Progress* progress);

/// Whatever file the root names from now on, itself or by a file that it names, must lie within the
/// folders.
void require_within(Table& root, const Folders& folders);

}  // namespace supple::tools
