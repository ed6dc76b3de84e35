// Texts of messages: numbers, voxels and counts, the nearest of known names, labels of a
// segmentation by number or name, and lines that come again.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Writes "1 cell", "2 cells".
std::string with_count(std::int64_t count, const std::string& what);

/// The name with the fewest edits (Levenshtein) to `name`, at most three and fewer than it has
/// characters; empty where none is that near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& names);

/// The shortest decimal number that reads back to the same bits.
std::string exact_text(double value);

/// Writes so many decimal places.
std::string decimal_text(double value, int places);

/// Bytes as RFC 4648 writes them, with padding.
std::string base64_of(std::string_view bytes);

/// Writes "1,2,3".
std::string to_text(const Vec3i& v, const char* between = ",");
/// Writes a vector with six significant digits.
std::string to_text(const Vec3d& v, const char* between = ",");

bool ends_with(const std::string& text, const std::string& end);

/// Lines of work that is done many times, such as warnings of the frames of a film: the first of a
/// kind is told with the place where it came, later ones are counted. Lines that differ in numbers
/// alone are of one kind.
class RepeatedLines {
 public:
  /// `what`: the kind of thing that is numbered, "frame" or "pose".
  explicit RepeatedLines(std::string what) : m_what(std::move(what)) {}

  /// Lines from now on are of this number.
  void enter(int number) { m_number = number; }
  /// Returns "frame 3: LINE"; nothing where a line of its kind was told before.
  std::optional<std::string> take(const std::string& line);
  /// A line for each kind that came again, in the order of the first ones.
  std::vector<std::string> repeats() const;

 private:
  struct Kind {
    std::string first;
    int number;                // of the first
    std::vector<int> repeats;  // numbers, each once
  };
  std::string m_what;
  int m_number = 0;
  std::vector<Kind> m_kinds;
  std::map<std::string, std::size_t> m_kind_of;  // by the line without its numbers
};

constexpr std::int32_t kMaxLabel = 65535;

/// Names of a segmentation's labels, in the order of its file. Names may come twice.
using LabelNames = std::vector<std::pair<std::int32_t, std::string>>;

/// The label that `text` means: the number that it is, 1 to kMaxLabel without leading zeros, or the
/// only one of that name; else nothing.
std::optional<std::int32_t> find_label(const LabelNames& names, const std::string& text);

/// Returns the numbers and the first names, for errors.
std::string expected_label(const LabelNames& names);

}  // namespace supple
