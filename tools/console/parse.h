// Values of command-line options: lists of numbers, voxels and boxes, and the selections of handles
// and anchors. All throw UsageError when the text does not parse.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Throws UsageError for the text of an option.
[[noreturn]] void refuse_option(const std::string& option, const std::string& text,
                                const std::string& expected);
/// The parts between separators.
std::vector<std::string> split(const std::string& text, char separator);
/// "NAME=FILE", the name of letters, digits, '_', '-' and '.'.
struct NamedFile {
  std::string name, file;
};
NamedFile named_file(const std::string& option, const std::string& text);
/// "I,J,K" or "I,J,K:I,J,K", the corners in any order; text that is no label and no file must be
/// one.
IndexBox parse_box(const std::string& option, const std::string& text);
/// N of "label:N", 1 to 65535 or a name; nothing when the text does not start with "label:".
std::optional<std::string> parse_label(const std::string& option, const std::string& text);
/// True if a material is a preset, not a file. Throws InputError with the nearest name where it is
/// neither.
bool is_tissue_preset(const std::string& option, const std::string& text);
/// Throws UsageError, naming the option, where no preset of pictures has the name.
void require_preset(const std::string& option, const std::string& name);

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
