// TIFF files of several pages for the reader tests, written by libtiff.
#pragma once

#include "tests/support/io_fixtures.h"

namespace supple::test {

/// One page per entry of `bytes`, which are its rows; the description goes to the first.
inline void write_tiff_pages(const std::string& path, int width, int height, TiffOptions options,
                             const std::vector<std::string>& bytes) {
  const bool is_big = std::string(options.mode) == "w8";
  for (const std::string& rows : bytes) {
    write_tiff(path, width, height, options, rows);
    options.mode = is_big ? "a8" : "a";
    options.description.clear();
  }
}

/// Pages of one value each: 'a', 'b', and so on.
inline std::vector<std::string> lettered_pages(int count, std::size_t size) {
  std::vector<std::string> pages;
  for (int n = 0; n < count; ++n) pages.push_back(std::string(size, char('a' + n)));
  return pages;
}

}  // namespace supple::test
