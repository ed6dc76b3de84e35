// Points as CSV and as markups.
#include "tests/fuzz/fuzz_file.h"
#include "volumes/io/point_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  supple::fuzz::with_file("a.csv", data, size,
                          [](const std::string& path) { supple::read_point_file(path); });
  return 0;
}
