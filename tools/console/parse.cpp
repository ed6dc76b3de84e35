#include "tools/console/parse.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include "lib/material/presets.h"
#include "raycast/scene/transfer_function.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "volumes/base/fields.h"
#include "volumes/grid/labels.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

namespace {

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

void refuse_option(const std::string& option, const std::string& text,
                   const std::string& expected) {
  throw UsageError(to_line({"", option, "'" + text + "'", expected}));
}

NamedFile named_file(const std::string& option, const std::string& text) {
  static const char* const kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
  const std::size_t sign = text.find('=');
  if (sign == 0 || sign == std::string::npos || sign + 1 == text.size() ||
      text.substr(0, sign).find_first_not_of(kAllowed) != std::string::npos) {
    refuse_option(option, text, "QUANTITY=FILE, such as von_mises=stress.nrrd");
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
    refuse_option(option, text,
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
    refuse_option(
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

void require_preset(const std::string& option, const std::string& name) {
  const std::vector<std::string> names = preset_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  const std::string nearest = nearest_name(name, names);
  throw UsageError(to_line({"", option, "'" + name + "'",
                            nearest.empty() ? "one that supple presets lists, or a .toml file"
                                            : "a known one: did you mean '" + nearest + "'?"}));
}

namespace {

/// Takes the prefix off the text; false if the text does not start with it.
bool take_prefix(const std::string& prefix, std::string& text) {
  if (text.compare(0, prefix.size(), prefix) != 0) return false;
  text.erase(0, prefix.size());
  return true;
}

GrabText of_table(const std::string& option, const std::string& text) {
  GrabText grab{table_value(option, text)};
  for (const char* key : {"by", "by_mm_lps", "rotate", "scale", "scale_axes", "path"}) {
    grab.moves_itself = grab.moves_itself || grab.keys.contains(key);
  }
  return grab;
}

/// A place under a key, with its frame.
GrabText at_place(const char* key, const std::string& option, const std::string& text) {
  const PlaceText place = parse_place(option, text);
  return {{{"frame", place.frame}, {key, place.numbers}}};
}

}  // namespace

PlaceText parse_place(const std::string& option, const std::string& text) {
  std::string numbers = text;
  PlaceText place{"voxel", ""};
  for (const char* frame : {"lps", "ras"}) {
    if (take_prefix(std::string(frame) + ":", numbers)) place.frame = frame;
  }
  place.numbers = numbers_value(option, numbers);
  return place;
}

GrabText parse_grab(const std::string& option, const std::string& text) {
  if (is_table(text)) return of_table(option, text);
  if (const auto label = parse_label(option, text)) return {{{"grab_label", *label}}};
  std::string rest = text;
  if (take_prefix("ball:", rest)) {
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string::npos)
      refuse_option(option, text, "ball:I,J,K:RADIUS, the radius in mm");
    GrabText ball = at_place("grab_ball", option, rest.substr(0, colon));
    ball.keys["radius"] = number_value(option, rest.substr(colon + 1));
    return ball;
  }
  if (take_prefix("density:", rest)) {
    const std::vector<std::string> ends = split(rest, ':');
    if (ends.size() != 2) refuse_option(option, text, "density:LEAST:LARGEST");
    return {{{"grab_density", {number_value(option, ends[0]), number_value(option, ends[1])}}}};
  }
  if (take_prefix("piece:", rest)) return at_place("piece_at", option, rest);
  if (take_prefix("rigid:", rest)) return at_place("rigid_at", option, rest);
  if (rest.compare(0, 4, "lps:") == 0 || rest.compare(0, 4, "ras:") == 0) {
    return at_place("grab", option, rest);
  }
  if (is_point_file_name(text)) {
    return {{{"points", text}}, false, read_point_file(text).has_displacements};
  }
  return {{{"grab_box", parse_box(option, text)}}, true};
}

}  // namespace supple::tools
