// A triangle mesh of one format, named FUZZ_NAME, and the same file as a network of lines.
#include "tests/fuzz/fuzz_file.h"
#include "volumes/io/mesh/triangle_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  supple::fuzz::with_file(FUZZ_NAME, data, size,
                          [](const std::string& path) { supple::read_mesh(path); });
  supple::fuzz::with_file(FUZZ_NAME, data, size,
                          [](const std::string& path) { supple::read_network(path); });
  return 0;
}
