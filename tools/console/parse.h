// Values of command-line options: lists of numbers, voxels and boxes. All throw UsageError when the
// text does not parse.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/text.h"

namespace supple::tools {

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

}  // namespace supple::tools
