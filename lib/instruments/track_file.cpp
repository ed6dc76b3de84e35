#include <array>
#include <cmath>

#include "lib/instruments/track.h"
#include "volumes/base/csv.h"
#include "volumes/base/error.h"
#include "volumes/base/fields.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

struct TrackColumn {
  const char* name;
  bool is_required;
  double& (*value)(TrackKey&);
};
constexpr int kColumnCount = 10;
constexpr std::array<TrackColumn, kColumnCount> kTrackColumns = {{
    {"time_s", true, [](TrackKey& k) -> double& { return k.time_s; }},
    {"tip_x", true, [](TrackKey& k) -> double& { return k.pose.tip_mm.x; }},
    {"tip_y", true, [](TrackKey& k) -> double& { return k.pose.tip_mm.y; }},
    {"tip_z", true, [](TrackKey& k) -> double& { return k.pose.tip_mm.z; }},
    {"axis_x", true, [](TrackKey& k) -> double& { return k.pose.axis.x; }},
    {"axis_y", true, [](TrackKey& k) -> double& { return k.pose.axis.y; }},
    {"axis_z", true, [](TrackKey& k) -> double& { return k.pose.axis.z; }},
    {"roll_degrees", false, [](TrackKey& k) -> double& { return k.pose.roll_degrees; }},
    {"opening_degrees", false, [](TrackKey& k) -> double& { return k.pose.opening_degrees; }},
    {"active", false, [](TrackKey& k) -> double& { return k.pose.active; }},
}};

std::vector<std::string> column_names(bool only_required) {
  std::vector<std::string> names;
  for (const TrackColumn& column : kTrackColumns) {
    if (column.is_required || !only_required) names.push_back(column.name);
  }
  return names;
}

/// Reads lines of one file, whose columns its first line names.
class TrackReader {
 public:
  explicit TrackReader(const std::string& path) : m_path(path), m_text(text_of_input(path)) {
    m_at = m_text.rfind("\xef\xbb\xbf", 0) == 0 ? 3 : 0;
  }

  std::vector<TrackKey> read() {
    take_header(next());
    std::vector<TrackKey> keys;
    while (m_at < m_text.size()) {
      const std::vector<std::string> cells = next();
      if (cells.size() == 1 && trimmed(cells[0]).empty()) continue;
      keys.push_back(key_of(cells));
      check_order(keys);
    }
    return keys;
  }

 private:
  std::vector<std::string> next() {
    ++m_line;
    return take_csv_line(m_text, m_at);
  }

  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_path + ":" + std::to_string(m_line), field, found, expected});
  }

  void take_header(const std::vector<std::string>& cells) {
    m_cell_of.fill(-1);
    for (std::size_t n = 0; n < cells.size(); ++n) {
      const std::string name = trimmed(cells[n]);
      int column = 0;
      while (column < kColumnCount && kTrackColumns[std::size_t(column)].name != name) ++column;
      if (column == kColumnCount) {
        fail("header", "column '" + printable(name) + "'", listed(column_names(false), "or"));
      }
      if (m_cell_of[std::size_t(column)] >= 0) fail("header", name + " twice", "it once");
      m_cell_of[std::size_t(column)] = int(n);
    }
    for (std::size_t c = 0; c < kTrackColumns.size(); ++c) {
      if (kTrackColumns[c].is_required && m_cell_of[c] < 0) {
        fail("header", std::string("no column ") + kTrackColumns[c].name,
             listed(column_names(true)));
      }
    }
    m_cells = cells.size();
  }

  TrackKey key_of(const std::vector<std::string>& cells) const {
    if (cells.size() != m_cells) {
      fail("columns", std::to_string(cells.size()), std::to_string(m_cells) + " as in the header");
    }
    TrackKey key{};
    for (std::size_t c = 0; c < kTrackColumns.size(); ++c) {
      if (m_cell_of[c] < 0) continue;
      const HeaderField field{m_path + ":" + std::to_string(m_line), kTrackColumns[c].name,
                              trimmed(cells[std::size_t(m_cell_of[c])])};
      const double value = field.number();
      if (!std::isfinite(value)) field.fail("a finite number");
      kTrackColumns[c].value(key) = value;
    }
    if (!(key.pose.axis.length() > 1e-9)) {
      fail("axis_x, axis_y, axis_z", "an axis of length 0", "a direction");
    }
    return key;
  }

  void check_order(const std::vector<TrackKey>& keys) const {
    const std::size_t n = keys.size();
    if (n < 2 || keys[n - 1].time_s > keys[n - 2].time_s) return;
    fail("time_s", exact_text(keys[n - 1].time_s),
         "more than " + exact_text(keys[n - 2].time_s) + ", the time of the line before");
  }

  std::string m_path, m_text;
  std::size_t m_at = 0, m_cells = 0;
  int m_line = 0;
  std::array<int, kColumnCount> m_cell_of{};
};

}  // namespace

InstrumentTrack read_track(const std::string& path) {
  return InstrumentTrack(TrackReader(path).read(), path);
}

std::string track_text(const InstrumentTrack& track) {
  std::string text = csv_line(column_names(false));
  for (TrackKey key : track.keys()) {
    std::vector<std::string> cells;
    for (const TrackColumn& column : kTrackColumns) cells.push_back(exact_text(column.value(key)));
    text += csv_line(cells);
  }
  return text;
}

void write_track(const InstrumentTrack& track, const std::string& path) {
  replace_text_file(path, track_text(track));
}

}  // namespace supple
