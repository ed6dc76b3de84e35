#include "volumes/io/point_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/markups.h"

namespace supple {

namespace {

constexpr std::array<const char*, 6> kColumns = {"x", "y", "z", "dx", "dy", "dz"};
/// Columns of Slicer's fiducials where no comment names them.
constexpr const char* kFiducialColumns = "label,x,y,z,sel,vis";
constexpr std::string_view kAround = " \t\r\n\f\v\"";  // what may stand around a field

/// A field without the blanks and the quotes around it, and where it begins in the line.
struct PointField {
  std::string text;
  std::size_t begin = 0;
};

/// Fields between commas; a field in double quotes may hold commas.
std::vector<PointField> fields_of(const std::string& line) {
  std::vector<PointField> fields;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t n = 0; n <= line.size(); ++n) {
    const bool is_end = n == line.size() || (line[n] == ',' && !quoted);
    if (n < line.size() && line[n] == '"') quoted = !quoted;
    if (!is_end) continue;
    std::size_t end = n;
    while (begin < end && kAround.find(line[begin]) != std::string::npos) ++begin;
    while (begin < end && kAround.find(line[end - 1]) != std::string::npos) --end;
    fields.push_back({line.substr(begin, end - begin), begin});
    begin = n + 1;
  }
  return fields;
}

/// Size of the mark that some programs put before UTF-8.
std::size_t mark_bytes(const std::string& content) {
  return content.rfind("\xef\xbb\xbf", 0) == 0 ? 3 : 0;
}

class PointReader {
 public:
  PointReader(const std::string& path, std::string content) {
    m_file.path = path;
    m_file.content = std::move(content);
    m_is_list = lower_case(std::filesystem::path(path).extension().string()) == ".fcsv";
    m_is_ras = m_is_list;
  }

  PointFile read() {
    const std::string& content = m_file.content;
    m_begin = mark_bytes(content);
    while (m_begin < content.size()) {
      const std::size_t end = std::min(content.find('\n', m_begin), content.size());
      ++m_line;
      take(content.substr(m_begin, end - m_begin));
      m_begin = end + 1;
    }
    if (m_file.rows.empty()) {
      throw InputError({m_file.path, "points", "none",
                        m_columns_known ? "one point a line below the header"
                                        : "a header line with x,y,z and one point a line"});
    }
    return std::move(m_file);
  }

 private:
  std::string place() const { return m_file.path + ":" + std::to_string(m_line); }

  void take(const std::string& line) {
    const std::string text = trimmed(line);
    if (text.empty()) return;
    if (text[0] == '#') {
      take_comment(text.substr(1));
      return;
    }
    if (!m_columns_known && m_is_list && !names_columns(text)) take_columns(kFiducialColumns);
    if (m_columns_known) {
      take_point(fields_of(line));
    } else {
      take_columns(text);
    }
  }

  /// True if a line of a list names columns, as those of this program and of spreadsheets do.
  static bool names_columns(const std::string& text) {
    const std::vector<PointField> names = fields_of(lower_case(text));
    return std::any_of(names.begin(), names.end(),
                       [](const PointField& name) { return name.text == kColumns[0]; });
  }

  /// Lists of Slicer are RAS where they say nothing else. Slicer 3 and 4.0 knew no other frame.
  void take_kind(const std::string& text) {
    const std::string kind = lower_case(trimmed(text));
    if (kind.rfind("fiducial list file", 0) != 0 && kind.rfind("markups fiducial file", 0) != 0) {
      return;
    }
    m_is_list = true;
    m_is_ras = m_is_ras || !m_is_frame_said;
  }

  /// "key = value" as Slicer writes it; any other comment is ignored.
  void take_comment(const std::string& text) {
    take_kind(text);
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) return;
    const std::string key = lower_case(trimmed(text.substr(0, equals)));
    const std::string value = trimmed(text.substr(equals + 1));
    if (key == "columns" && !m_columns_known) take_columns(value);
    if (key == "coordinatesystem") take_frame(value);
  }

  void take_frame(const std::string& value) {
    const std::string frame = lower_case(value);
    m_is_frame_said = true;
    m_is_ras = frame == "ras" || frame == "0";
    if (m_is_ras || frame == "lps" || frame == "1") return;
    throw InputError({place(), "CoordinateSystem", "'" + printable(value) + "'", "LPS or RAS"});
  }

  void take_columns(const std::string& text) {
    const std::vector<PointField> names = fields_of(lower_case(text));
    int found = 0;
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto at = std::find_if(names.begin(), names.end(), [&](const PointField& name) {
        return name.text == kColumns[c];
      });
      m_columns[c] = at == names.end() ? -1 : int(at - names.begin());
      found |= int(at != names.end()) << c;
    }
    if (found != 0b111 && found != 0b111111) {
      throw InputError({place(), "header", "'" + printable(text) + "'",
                        "columns x,y,z, with or without dx,dy,dz, separated by commas"});
    }
    m_file.has_displacements = found == 0b111111;
    m_columns_known = true;
  }

  void take_point(const std::vector<PointField>& fields) {
    PointFile::Row row{m_line, {}, {}, {}, m_is_ras};
    for (int a = 0; a < 3; ++a) {
      row.at_lps_mm[a] = number(fields, a);
      const PointField& field = fields[std::size_t(m_columns[std::size_t(a)])];
      row.at[std::size_t(a)] = {m_begin + field.begin, field.text.size()};
    }
    for (int a = 0; a < 3 && m_file.has_displacements; ++a) {
      row.by_lps_mm[a] = number(fields, a + 3);
    }
    m_file.rows.push_back(row);
  }

  /// The number in a column, in LPS.
  double number(const std::vector<PointField>& fields, int column) const {
    const std::size_t at = std::size_t(m_columns[std::size_t(column)]);
    const char* name = kColumns[std::size_t(column)];
    if (at >= fields.size()) {
      throw InputError({place(), name, std::to_string(fields.size()) + " columns",
                        "it in column " + std::to_string(at + 1)});
    }
    const HeaderField field{place(), name, fields[at].text};
    const double value = field.number();
    if (!std::isfinite(value)) field.fail("a finite number of millimetres");
    return m_is_ras && column % 3 != 2 ? -value : value;
  }

  PointFile m_file;
  int m_line = 0;
  std::size_t m_begin = 0;  // of the line, in the file
  bool m_columns_known = false;
  bool m_is_list = false;  // of Slicer's fiducials
  bool m_is_frame_said = false;
  bool m_is_ras = false;
  std::array<int, 6> m_columns{};
};

}  // namespace

PointFile read_point_file(const std::string& path) {
  require_regular_file(path);
  std::ifstream in(path);
  if (!in) throw_open_error(path, errno);
  std::string content{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw_open_error(path, EIO);
  const std::size_t first = content.find_first_not_of(kAround, mark_bytes(content));
  if (first != std::string::npos && content[first] == '{') {
    return read_markups(path, std::move(content));
  }
  return PointReader(path, std::move(content)).read();
}

PointFile led_to(PointFile from, const PointFile& to) {
  if (to.rows.size() != from.rows.size()) {
    throw InputError({to.path, "points", std::to_string(to.rows.size()),
                      std::to_string(from.rows.size()) + " as in " + from.path});
  }
  for (std::size_t n = 0; n < to.rows.size(); ++n) {
    from.rows[n].by_lps_mm = to.rows[n].at_lps_mm - from.rows[n].at_lps_mm;
  }
  from.has_displacements = true;
  return from;
}

void write_points_like(const std::string& path, const PointFile& file,
                       const std::vector<Vec3d>& points_lps_mm) {
  std::string text;
  text.reserve(file.content.size() + file.content.size() / 2);
  std::size_t taken = 0;
  for (std::size_t n = 0; n < file.rows.size(); ++n) {
    const PointFile::Row& row = file.rows[n];
    std::array<int, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return row.at[std::size_t(a)].begin < row.at[std::size_t(b)].begin;
    });
    for (const int a : order) {
      const PointFile::Span& span = row.at[std::size_t(a)];
      const double value = points_lps_mm[n][a];
      if (value == row.at_lps_mm[a]) continue;
      text.append(file.content, taken, span.begin - taken);
      text += exact_text((row.is_ras && a != 2 ? -value : value) + 0.0);  // never -0
      taken = span.begin + span.size;
    }
  }
  text.append(file.content, taken);
  OutputFile out(path);
  out.write(text);
  out.close();
  out.commit();
}

bool is_point_file_name(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  return extension == ".csv" || extension == ".fcsv" || extension == ".json";
}

}  // namespace supple
