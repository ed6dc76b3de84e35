// Selections of handles and anchors as text on the command line. All functions throw UsageError.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/value.h"

namespace supple::tools {

struct GrabText {
  Value keys;                 // of the table of a scene
  bool is_plain_box = false;  // a voxel or a box of voxels
  bool moves_itself = false;  // a table with a motion, or points with displacements
};

/// A place: "I,J,K" in voxels, "lps:X,Y,Z" or "ras:X,Y,Z" in mm.
struct PlaceText {
  std::string frame;  // as in a scene
  Value numbers;
};
PlaceText parse_place(const std::string& option, const std::string& text);

/// A voxel or box "I,J,K[:I,J,K]", "lps:X,Y,Z", "ras:X,Y,Z", "ball:PLACE:RADIUS", "density:LO:HI",
/// "piece:PLACE", "rigid:PLACE", "label:N", a file of points, or a table as in a scene.
GrabText parse_grab(const std::string& option, const std::string& text);

}  // namespace supple::tools
