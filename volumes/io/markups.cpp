#include "volumes/io/markups.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

using nlohmann::json;

/// Every number of the text as an array: its value, where it begins in the text and its length.
json parse_with_places(const std::string& path, const std::string& content) {
  std::istringstream text(content);
  const auto place_number = [&](int, json::parse_event_t event, json& parsed) {
    if (event != json::parse_event_t::value || !parsed.is_number()) return true;
    // The parser has taken the character behind the number, too.
    text.clear();
    const auto taken = std::size_t(text.tellg());
    const std::size_t last =
        content.find_last_of("0123456789", std::min(taken, content.size()) - 1);
    std::size_t begin = last;
    while (begin > 0 &&
           std::string_view("0123456789+-.eE").find(content[begin - 1]) != std::string_view::npos) {
      --begin;
    }
    parsed = json::array({parsed.get<double>(), begin, last + 1 - begin});
    return true;
  };
  try {
    return json::parse(text, place_number);
  } catch (const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 4: syntax error ..."
    const std::string what = error.what();
    const std::size_t begin = what.find("] ") + 2;
    const std::string fault = what.substr(begin, what.find(':', begin) - begin);
    throw InputError({path, "JSON", printable(fault), "intact markups"});
  }
}

class MarkupsReader {
 public:
  MarkupsReader(const std::string& path, std::string content) {
    m_file.path = path;
    m_file.content = std::move(content);
  }

  PointFile read() {
    const json all = parse_with_places(m_file.path, m_file.content);
    const auto markups = all.is_object() ? all.find("markups") : all.end();
    if (markups == all.end() || !markups->is_array()) {
      fail(m_file.path, "markups", "none", "an array, as 3D Slicer writes it");
    }
    for (const json& markup : *markups) take_markup(markup);
    if (m_file.rows.empty()) {
      fail(m_file.path, "controlPoints", "none that is defined", "one at least");
    }
    return std::move(m_file);
  }

 private:
  [[noreturn]] static void fail(const std::string& place, const std::string& field,
                                const std::string& found, const std::string& expected) {
    throw InputError({place, field, found, expected});
  }

  /// A text of an object, `missing` where it has none; what is no text is shown as it stands.
  static std::string text_of(const json& object, const char* key, const std::string& missing) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (found == object.end()) return missing;
    return found->is_string() ? found->get<std::string>() : "no text";
  }

  void take_markup(const json& markup) {
    const std::string type = text_of(markup, "type", "nothing");
    static const std::set<std::string> kTypes = {"Fiducial", "Line", "Angle", "Curve",
                                                 "ClosedCurve"};
    if (kTypes.count(type) == 0) {
      fail(m_file.path, "type", printable(type), "Fiducial, Line, Angle, Curve or ClosedCurve");
    }
    const std::string frame = lower_case(text_of(markup, "coordinateSystem", "LPS"));
    m_is_ras = frame == "ras" || frame == "0";
    if (!m_is_ras && frame != "lps" && frame != "1") {
      fail(m_file.path, "coordinateSystem", "'" + printable(frame) + "'", "LPS or RAS");
    }
    const auto units = markup.find("coordinateUnits");
    // A coded entry is an array: code, scheme, meaning.
    const bool is_coded = units != markup.end() && units->is_array() && !units->empty();
    const json unit = units == markup.end() ? json("mm") : is_coded ? units->front() : *units;
    if (unit != "mm") {
      fail(m_file.path, "coordinateUnits",
           unit.is_string() ? "'" + printable(unit.get<std::string>()) + "'" : "no text", "mm");
    }
    const auto points = markup.find("controlPoints");
    if (points == markup.end()) return;
    if (!points->is_array()) fail(m_file.path, "controlPoints", "no array", "an array of points");
    for (std::size_t n = 0; n < points->size(); ++n) take_point((*points)[n], n);
  }

  void take_point(const json& point, std::size_t number) {
    if (text_of(point, "positionStatus", "defined") != "defined") return;
    const std::string field = "position of control point " + std::to_string(number);
    const auto position = point.is_object() ? point.find("position") : point.end();
    const bool is_place =
        position != point.end() && position->is_array() && position->size() == 3 &&
        std::all_of(position->begin(), position->end(), [](const json& number_and_place) {
          return number_and_place.is_array() && number_and_place.size() == 3 &&
                 number_and_place[0].is_number_float();
        });
    if (!is_place) {
      fail(m_file.path, field, position == point.end() ? "nothing" : "something else",
           "three numbers");
    }
    PointFile::Row row{0, {}, {}, {}, m_is_ras};
    for (int a = 0; a < 3; ++a) {
      const json& coordinate = (*position)[std::size_t(a)];
      const double value = coordinate[0];
      row.at_lps_mm[a] = m_is_ras && a != 2 ? -value : value;
      row.at[std::size_t(a)] = {coordinate[1], coordinate[2]};
    }
    row.line = line_of(row.at[0].begin);
    m_file.rows.push_back(row);
  }

  /// Points come in the order of the text.
  int line_of(std::size_t offset) {
    const auto begin = m_file.content.begin();
    m_line += int(std::count(begin + std::ptrdiff_t(m_counted),
                             begin + std::ptrdiff_t(std::max(m_counted, offset)), '\n'));
    m_counted = std::max(m_counted, offset);
    return m_line;
  }

  PointFile m_file;
  bool m_is_ras = false;
  int m_line = 1;
  std::size_t m_counted = 0;
};

}  // namespace

PointFile read_markups(const std::string& path, std::string content) {
  return MarkupsReader(path, std::move(content)).read();
}

}  // namespace supple
