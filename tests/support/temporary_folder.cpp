#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace supple::test {

TemporaryFolder::TemporaryFolder() = default;

std::vector<std::string> TemporaryFolder::entries() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path())) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string TemporaryFolder::write(const std::string& name, const std::string& bytes) const {
  write_text(*this / name, bytes);
  return *this / name;
}

std::string read_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string output_path(const std::string& name) {
  const char* output = std::getenv("SUPPLE_TEST_OUTPUT");
  const std::filesystem::path folder = output != nullptr
                                           ? std::filesystem::path(output)
                                           : std::filesystem::temp_directory_path() / "supple-test";
  const std::filesystem::path path = folder / name;
  std::filesystem::create_directories(path.parent_path());
  return path.string();
}

void write_text(const std::string& path, const std::string& bytes) {
  std::filesystem::remove(path);
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), std::streamsize(bytes.size()));
}

FileSizeLimit::FileSizeLimit(rlim_t bytes) {
  m_handler = std::signal(SIGXFSZ, SIG_IGN);
  ::getrlimit(RLIMIT_FSIZE, &m_before);
  const rlimit limit{bytes, m_before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

FileSizeLimit::~FileSizeLimit() {
  ::setrlimit(RLIMIT_FSIZE, &m_before);
  std::signal(SIGXFSZ, m_handler);
}

}  // namespace supple::test
