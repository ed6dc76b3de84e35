#include "volumes/io/point_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "volumes/base/error.h"
#include "volumes/io/text_header.h"

namespace supple {

namespace {

constexpr std::array<const char*, 6> kColumns = {"x", "y", "z", "dx", "dy", "dz"};

/// Fields between commas; a field in double quotes may hold commas.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

class PointReader {
 public:
  explicit PointReader(const std::string& path) { m_file.path = path; }

  void take(std::string line) {
    ++m_line;
    if (m_line == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);
    line = trimmed(line);
    if (line.empty()) return;
    if (line[0] == '#') {
      take_comment(line.substr(1));
    } else if (m_columns_known) {
      take_point(fields_of(line));
    } else {
      take_columns(line);
    }
  }

  PointFile result() {
    if (m_file.rows.empty()) {
      throw InputError({m_file.path, "points", "none",
                        m_columns_known ? "one point a line below the header"
                                        : "a header line with x,y,z and one point a line"});
    }
    return std::move(m_file);
  }

 private:
  std::string place() const { return m_file.path + ":" + std::to_string(m_line); }

  /// "key = value" as Slicer writes it; any other comment is ignored.
  void take_comment(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) return;
    const std::string key = lower_case(trimmed(text.substr(0, equals)));
    const std::string value = trimmed(text.substr(equals + 1));
    if (key == "columns" && !m_columns_known) take_columns(value);
    if (key == "coordinatesystem") take_frame(value);
  }

  void take_frame(const std::string& value) {
    const std::string frame = lower_case(value);
    m_is_ras = frame == "ras" || frame == "0";
    if (m_is_ras || frame == "lps" || frame == "1") return;
    throw InputError({place(), "CoordinateSystem", "'" + printable(value) + "'", "LPS or RAS"});
  }

  void take_columns(const std::string& text) {
    const std::vector<std::string> names = fields_of(lower_case(text));
    int found = 0;
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto at = std::find(names.begin(), names.end(), kColumns[c]);
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

  void take_point(const std::vector<std::string>& fields) {
    PointFile::Row row{m_line, {}, {}};
    for (int a = 0; a < 3; ++a) row.at_lps_mm[a] = number(fields, a);
    for (int a = 0; a < 3 && m_file.has_displacements; ++a) {
      row.by_lps_mm[a] = number(fields, a + 3);
    }
    m_file.rows.push_back(row);
  }

  /// In LPS.
  double number(const std::vector<std::string>& fields, int column) const {
    const std::size_t at = std::size_t(m_columns[std::size_t(column)]);
    const char* name = kColumns[std::size_t(column)];
    if (at >= fields.size()) {
      throw InputError({place(), name, std::to_string(fields.size()) + " columns",
                        "it in column " + std::to_string(at + 1)});
    }
    const HeaderField field{place(), name, fields[at]};
    const double value = field.number();
    if (!std::isfinite(value)) field.fail("a finite number of millimetres");
    return m_is_ras && column % 3 != 2 ? -value : value;
  }

  PointFile m_file;
  int m_line = 0;
  bool m_columns_known = false;
  bool m_is_ras = false;
  std::array<int, 6> m_columns{};
};

}  // namespace

PointFile read_point_file(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw_open_error(path, EISDIR);
  std::ifstream in(path);
  if (!in) throw_open_error(path, errno);
  PointReader reader(path);
  for (std::string line; std::getline(in, line);) reader.take(std::move(line));
  return reader.result();
}

bool is_point_file_name(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  return extension == ".csv" || extension == ".fcsv";
}

}  // namespace supple
