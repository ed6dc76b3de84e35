#include "tools/console/grab_text.h"

#include "lib/material/toml_string.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

namespace {

/// Whether the text starts with the prefix, which is then taken off.
bool take_prefix(const std::string& prefix, std::string& text) {
  if (text.compare(0, prefix.size(), prefix) != 0) return false;
  text.erase(0, prefix.size());
  return true;
}

std::string frame_key(const PlaceText& place) {
  return "frame = " + toml_string(place.frame);
}

[[noreturn]] void throw_form(const std::string& option, const std::string& text,
                             const std::string& expected) {
  throw UsageError(to_line({"", option, "'" + text + "'", expected}));
}

GrabText of_table(const std::string& option, const std::string& text) {
  const std::string table = toml_table(option, text);
  const std::size_t first = table.find('{') + 1, last = table.rfind('}');
  GrabText grab{table.substr(first, last - first)};
  Table parsed = *Table::parse("x = " + text, option).table("x");
  for (const char* key : {"by", "by_mm_lps", "rotate", "scale", "scale_axes", "path"}) {
    grab.moves_itself = grab.moves_itself || parsed.has(key);
  }
  return grab;
}

}  // namespace

PlaceText parse_place(const std::string& option, const std::string& text) {
  std::string numbers = text;
  PlaceText place{"voxel", ""};
  for (const char* frame : {"lps", "ras"}) {
    if (take_prefix(std::string(frame) + ":", numbers)) place.frame = frame;
  }
  place.toml = toml_numbers(option, numbers);
  return place;
}

GrabText parse_grab(const std::string& option, const std::string& text) {
  if (is_table(text)) return of_table(option, text);
  if (const auto label = parse_label(option, text)) {
    return {"grab_label = " + toml_string(*label)};
  }
  std::string rest = text;
  if (take_prefix("ball:", rest)) {
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string::npos) throw_form(option, text, "ball:I,J,K:RADIUS, the radius in mm");
    const PlaceText place = parse_place(option, rest.substr(0, colon));
    return {frame_key(place) + ", grab_ball = " + place.toml +
            ", radius = " + toml_number(option, rest.substr(colon + 1))};
  }
  if (take_prefix("density:", rest)) {
    const std::vector<std::string> ends = split(rest, ':');
    if (ends.size() != 2) throw_form(option, text, "density:LEAST:LARGEST");
    return {"grab_density = [" + toml_number(option, ends[0]) + ", " +
            toml_number(option, ends[1]) + "]"};
  }
  if (take_prefix("piece:", rest)) {
    const PlaceText place = parse_place(option, rest);
    return {frame_key(place) + ", piece_at = " + place.toml};
  }
  if (take_prefix("rigid:", rest)) {
    const PlaceText place = parse_place(option, rest);
    return {frame_key(place) + ", rigid_at = " + place.toml};
  }
  if (rest.compare(0, 4, "lps:") == 0 || rest.compare(0, 4, "ras:") == 0) {
    const PlaceText place = parse_place(option, rest);
    return {frame_key(place) + ", grab = " + place.toml};
  }
  if (is_point_file_name(text)) {
    return {"points = " + toml_string(text), false, read_point_file(text).has_displacements};
  }
  const IndexBox box = parse_box(option, text);
  return {"grab_box = [" + to_text(box.lo) + "," + to_text(box.hi) + "]", true};
}

}  // namespace supple::tools
