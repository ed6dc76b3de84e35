// Pieces that the text headers of NRRD, MetaImage and raw share: lines, numbers, and errors that
// name file, field, found and expected.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple {

/// Headers longer than this are rejected.
constexpr std::size_t kMaxTextHeader = std::size_t(1) << 20;

/// Takes lines off a text one by one; understands "\n" and "\r\n".
class LineReader {
 public:
  explicit LineReader(const std::string& text) : m_text(text) {}
  /// Takes the next line; false at the end. A last line without newline counts.
  bool next(std::string& line);
  /// Offset of the first byte behind the last line.
  std::size_t position() const { return m_position; }

 private:
  const std::string& m_text;
  std::size_t m_position = 0;
};

/// Text as it may stand in a one-line message: at most 60 characters, control characters as '?'.
std::string printable(const std::string& text);
/// The text without blanks at both ends.
std::string trimmed(const std::string& text);
std::string lower_case(std::string text);
/// The parts of a text between blanks.
std::vector<std::string> words_of(const std::string& text);

/// One field of a header, parsed strictly: anything but the expected form is an InputError.
struct HeaderField {
  std::string file;
  std::string name;
  std::string text;

  [[noreturn]] void fail(const std::string& expected) const;
  std::int64_t integer() const;
  double number() const;
  bool boolean() const;  // True/False as MetaImage writes them
  std::vector<std::int64_t> integers() const;
  std::vector<double> numbers() const;
};

/// Sizes as a lattice; two sizes make one slice. Throws InputError unless 1 <= size < 2^31.
Vec3i dims_from(const HeaderField& field, const std::vector<std::int64_t>& sizes);

/// Geometry's own checks, with the file's name put into their errors.
Geometry make_geometry(const std::string& file, const Vec3i& dims, const Vec3d& origin_lps_mm,
                       const std::array<Vec3d, 3>& axes_mm);

}  // namespace supple
