// The files that a detached header of NRRD or MetaImage names: one, a list, or numbered ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

/// The data file `name` that `field` of a header names, in the header's folder or below it. Throws
/// InputError for absolute names and for names that leave the folder ("../x"): a header that came
/// by mail must not choose among all files of the reader. Links are followed.
std::string data_path(const HeaderField& field, const std::string& name);

/// Names such as "slice%03d.raw" with the numbers first, first + step, … up to last.
class NumberedFiles {
 public:
  /// Throws InputError unless the pattern holds one %d (flags 0 - + and blank, a width; %i and %u
  /// too), step is not 0, and last can be reached from first.
  NumberedFiles(HeaderField field, const std::string& pattern, std::int64_t first,
                std::int64_t last, std::int64_t step);
  std::int64_t count() const { return m_count; }
  std::string name(std::int64_t n) const;

 private:
  HeaderField m_field;
  std::string m_before, m_flags, m_after;
  int m_width = 0;
  std::int64_t m_first, m_step, m_count = 0;
};

/// Offset of the first byte behind `lines` further line ends from `offset` on.
std::int64_t skip_lines(const InputFile& file, std::int64_t offset, std::int64_t lines,
                        const HeaderField& field);

/// Checks that `count` files which hold the first `dimensions` axes of `sizes` each (all axes:
/// equal parts along the last) are as many as the volume has.
void check_file_count(const HeaderField& field, const std::vector<std::int64_t>& sizes,
                      std::int64_t dimensions, std::int64_t count);

}  // namespace supple
