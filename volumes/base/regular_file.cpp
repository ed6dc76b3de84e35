#include "volumes/base/regular_file.h"

#include <cerrno>

#include <sys/stat.h>

#include "volumes/base/error.h"

namespace supple {

void require_regular_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
  if (S_ISDIR(status.st_mode)) throw_open_error(path, EISDIR);
  throw InputError({path, "", "a device, pipe or socket", "a regular file"});
}

}  // namespace supple
