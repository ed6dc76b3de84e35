#include "tests/fuzz/fuzz_file.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/process.h"

namespace supple::fuzz {

namespace {

/// Removed when the process ends.
struct Folder {
  std::string path = "/dev/shm/supple-fuzz-" + std::to_string(::getpid());
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

void with_file(const std::string& name, const std::uint8_t* data, std::size_t size,
               const std::function<void(const std::string& path)>& read) {
  static const Folder folder;
  allow_child_processes(true);
  const std::string path = folder.path + "/" + name;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size) std::abort();
  std::fclose(file);
  try {
    read(path);
  } catch (const Error&) {
  }
}

}  // namespace supple::fuzz
