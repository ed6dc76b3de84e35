#include "volumes/base/error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace supple {

std::string to_line(const Problem& problem) {
  std::string line;
  const auto append = [&line](const std::string& separator, const std::string& part) {
    if (part.empty()) return;
    if (!line.empty()) line += separator;
    line += part;
  };
  append("", problem.file);
  append(": ", problem.field);
  if (!problem.found.empty()) append(": ", "found " + problem.found);
  if (!problem.expected.empty()) {
    append(problem.found.empty() ? ": " : ", ", "expected " + problem.expected);
  }
  return line;
}

std::string number_text(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

void require(bool holds, const std::string& field, double found, const std::string& expected,
             const std::string& file) {
  if (!holds) throw InputError({file, field, number_text(found), expected});
}

void throw_open_error(const std::string& file, int errno_value) {
  if (file == "-" && errno_value == ENOENT) {
    throw InputError({file, "", "a pipe", "the name of a file: pipes are not read"});
  }
  switch (errno_value) {
    case ENOENT:
    case ENOTDIR:
      throw InputError({file, "", "no such file", "a readable file"});
    case EISDIR:
      throw InputError({file, "", "a directory", "a file"});
    default:
      throw SystemError(file + ": " + std::strerror(errno_value));
  }
}

}  // namespace supple
