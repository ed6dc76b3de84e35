#include "tools/console/parse.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "lib/material/presets.h"
#include "tools/console/command.h"
#include "volumes/base/fields.h"
#include "volumes/grid/labels.h"

namespace supple::tools {

namespace {

[[noreturn]] void throw_unparsed(const std::string& option, const std::string& text,
                                 const std::string& expected) {
  throw UsageError(to_line({"", option, "'" + text + "'", expected}));
}

bool read_int(const std::string& text, int& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

bool read_voxel(const std::string& text, Vec3i& voxel) {
  const std::vector<std::string> parts = split(text, ',');
  bool good = parts.size() == 3;
  for (int a = 0; good && a < 3; ++a) good = read_int(parts[a], voxel[a]);
  return good;
}

/// Three numbers, as a place in millimetres has them.
bool is_place(const std::vector<std::string>& corners) {
  const std::vector<std::string> parts =
      corners.size() == 1 ? split(corners.front(), ',') : std::vector<std::string>();
  return parts.size() == 3 && std::all_of(parts.begin(), parts.end(), [](const std::string& part) {
           char* end = nullptr;
           std::strtod(part.c_str(), &end);
           return !part.empty() && end == part.c_str() + part.size();
         });
}

}  // namespace

NamedFile named_file(const std::string& option, const std::string& text) {
  static const char* const kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
  const std::size_t sign = text.find('=');
  if (sign == 0 || sign == std::string::npos || sign + 1 == text.size() ||
      text.substr(0, sign).find_first_not_of(kAllowed) != std::string::npos) {
    throw_unparsed(option, text, "QUANTITY=FILE, such as von_mises=stress.nrrd");
  }
  return {text.substr(0, sign), text.substr(sign + 1)};
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  if (!text.empty() && text.back() == separator) parts.emplace_back();
  return parts;
}

IndexBox parse_box(const std::string& option, const std::string& text) {
  const std::vector<std::string> corners = split(text, ':');
  Vec3i a, b;
  if (corners.empty() || corners.size() > 2 || !read_voxel(corners.front(), a) ||
      !read_voxel(corners.back(), b)) {
    throw_unparsed(option, text,
                   std::string("I,J,K, a box I,J,K:I,J,K, label:N or a FILE.csv") +
                       (is_place(corners) ? " (voxels are whole numbers; places in LPS mm stand in "
                                            "a file with columns x,y,z)"
                                          : ""));
  }
  IndexBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(a[axis], b[axis]);
    box.hi[axis] = std::max(a[axis], b[axis]);
  }
  return box;
}

std::optional<std::string> parse_label(const std::string& option, const std::string& text) {
  const std::string prefix = "label:";
  if (text.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  const std::string label = text.substr(prefix.size());
  const bool is_name = label.find_first_not_of("0123456789") != std::string::npos;
  if (!is_name && !find_label({}, label)) {
    throw_unparsed(
        option, text,
        "label:N with N from 1 to " + std::to_string(kMaxLabel) + ", or the name of a segment");
  }
  return label;
}

bool is_tissue_preset(const std::string& option, const std::string& text) {
  if (find_tissue_preset(text) != nullptr) return true;
  if (std::filesystem::exists(text)) return false;
  std::vector<std::string> names;
  for (const TissuePreset& preset : tissue_presets()) names.emplace_back(preset.name);
  const std::string nearest = nearest_name(text, names);
  throw InputError({"", option, "'" + text + "', and no such file",
                    "a table, or " + listed(names, "or") +
                        (nearest.empty() ? "" : ": did you mean '" + nearest + "'?")});
}

}  // namespace supple::tools
