#include "tools/console/grab_text.h"

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

namespace {

/// Takes the prefix off the text; false if the text does not start with it.
bool take_prefix(const std::string& prefix, std::string& text) {
  if (text.compare(0, prefix.size(), prefix) != 0) return false;
  text.erase(0, prefix.size());
  return true;
}

[[noreturn]] void throw_form(const std::string& option, const std::string& text,
                             const std::string& expected) {
  throw UsageError(to_line({"", option, "'" + text + "'", expected}));
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
    if (colon == std::string::npos) throw_form(option, text, "ball:I,J,K:RADIUS, the radius in mm");
    GrabText ball = at_place("grab_ball", option, rest.substr(0, colon));
    ball.keys["radius"] = number_value(option, rest.substr(colon + 1));
    return ball;
  }
  if (take_prefix("density:", rest)) {
    const std::vector<std::string> ends = split(rest, ':');
    if (ends.size() != 2) throw_form(option, text, "density:LEAST:LARGEST");
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
