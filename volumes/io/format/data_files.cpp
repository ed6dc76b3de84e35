#include "volumes/io/format/data_files.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "volumes/base/error.h"

namespace supple {

std::string data_path(const HeaderField& field, const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path file = fs::path(name).lexically_normal();
  const HeaderField named{field.file, field.name, name};
  if (name.empty()) named.fail("a file name");
  if (name.find('\0') != std::string::npos) named.fail("a file name without zero bytes");
  if (file.is_absolute() || *file.begin() == "..") {
    named.fail("a file in the header's folder or below it");
  }
  return (fs::path(field.file).parent_path() / file).string();
}

NumberedFiles::NumberedFiles(HeaderField field, const std::string& pattern, std::int64_t first,
                             std::int64_t last, std::int64_t step)
    : m_field(std::move(field)), m_first(first), m_step(step) {
  constexpr int kMaxWidth = 20;
  const std::string expected = "a pattern with one number, such as slice%03d.raw";
  const std::size_t percent = pattern.find('%');
  if (percent == std::string::npos) m_field.fail(expected);
  const std::size_t width = pattern.find_first_not_of("0-+ ", percent + 1);
  if (width == std::string::npos) m_field.fail(expected);
  const std::size_t letter = pattern.find_first_not_of("0123456789", width);
  if (letter == std::string::npos ||
      std::string("diu").find(pattern[letter]) == std::string::npos || letter > width + 2 ||
      pattern.find('%', letter) != std::string::npos) {
    m_field.fail(expected);
  }
  m_before = pattern.substr(0, percent);
  m_flags = pattern.substr(percent + 1, width - percent - 1);
  for (std::size_t at = width; at < letter; ++at) m_width = 10 * m_width + (pattern[at] - '0');
  m_after = pattern.substr(letter + 1);
  if (m_width > kMaxWidth || m_flags.size() > 4) m_field.fail(expected);

  constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();
  if (std::max({std::abs(double(first)), std::abs(double(last)), std::abs(double(step))}) >
          double(kMax) ||
      step == 0 || (last - first) / step < 0 || (last != first && (last > first) != (step > 0))) {
    m_field.fail("numbers min max step that count from min to max");
  }
  m_count = (last - first) / step + 1;
}

std::string NumberedFiles::name(std::int64_t n) const {
  char digits[64];
  const std::string format = "%" + m_flags + "*lld";
  std::snprintf(digits, sizeof digits, format.c_str(), m_width, (long long)(m_first + n * m_step));
  return m_before + digits + m_after;
}

std::int64_t skip_lines(const InputFile& file, std::int64_t offset, std::int64_t lines,
                        const HeaderField& field) {
  std::vector<char> buffer(lines > 0 ? 64 * 1024 : 0);
  while (lines > 0) {
    const std::size_t got = file.read_at(offset, buffer.data(), buffer.size());
    if (got == 0) field.fail("no more lines than " + file.path() + " has");
    std::size_t at = 0;
    while (lines > 0 && at < got) lines -= buffer[at++] == '\n';
    offset += std::int64_t(at);
  }
  return offset;
}

void check_file_count(const HeaderField& field, const std::vector<std::int64_t>& sizes,
                      std::int64_t dimensions, std::int64_t count) {
  const std::int64_t all = std::int64_t(sizes.size());
  if (dimensions < 1 || dimensions > all) {
    field.fail("files of 1 to " + std::to_string(all) + " dimensions");
  }
  if (dimensions == all) {
    if (count < 1 || sizes.back() % count != 0) {
      HeaderField{field.file, field.name, std::to_string(count) + " files"}.fail(
          "files that divide the last size " + std::to_string(sizes.back()));
    }
    return;
  }
  double expected = 1;  // the product may be wild as long as nothing is compared with it
  for (std::int64_t a = dimensions; a < all; ++a) expected *= double(sizes[std::size_t(a)]);
  if (double(count) == expected) return;
  HeaderField{field.file, field.name, std::to_string(count) + " files"}.fail(
      number_text(expected) + ", one per " + std::to_string(dimensions) + "-dimensional part");
}

}  // namespace supple
