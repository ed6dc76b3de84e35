// The text of --raw over a file of 64 bytes.
#include <string>

#include "tests/fuzz/fuzz_file.h"
#include "volumes/io/format/volume_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t values[64] = {};
  const std::string spec(reinterpret_cast<const char*>(data), size);
  if (spec.empty()) return 0;
  supple::fuzz::with_file("a.raw", values, sizeof values,
                          [&](const std::string& path) { supple::open_volume(path, {spec}); });
  return 0;
}
