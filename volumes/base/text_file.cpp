#include "volumes/base/text_file.h"

#include <cerrno>
#include <fstream>
#include <sstream>

#include "volumes/base/atomic_file.h"

namespace supple {

std::string text_of_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void replace_text_file(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  std::ofstream stream(file.path(), std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw_write_error(path, errno);
  stream.close();
  file.commit();
}

}  // namespace supple
