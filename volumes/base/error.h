// Typed errors of the libraries. `tools/` alone turns them into exit codes (docs/errors.md).
#pragma once

#include <stdexcept>
#include <string>

namespace supple {

/// A fault of one value of one file: printed as "file: field: found X, expected Y". Empty parts are
/// left out.
struct Problem {
  std::string file;
  std::string field;
  std::string found;
  std::string expected;
};

/// The one line that a user reads.
std::string to_line(const Problem& problem);

/// A number as messages show it: six significant digits.
std::string number_text(double value, int digits = 6);

/// Throws InputError, with the value as what was found, unless `holds`.
void require(bool holds, const std::string& field, double found, const std::string& expected,
             const std::string& file = "");

/// Base of all errors of this project; exit code 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A parsed value or a file is unusable; exit code 3.
class InputError : public Error {
 public:
  explicit InputError(const Problem& problem) : Error(to_line(problem)), m_problem(problem) {}
  const Problem& problem() const { return m_problem; }

 private:
  Problem m_problem;
};

/// An option cannot be used, or an output exists and may not be overwritten; exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// The system refuses: disk full, no permission, out of memory; exit code 4.
class SystemError : public Error {
 public:
  using Error::Error;
};

/// The user asked to stop.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

/// InputError or SystemError for a failed open/read of `file`, by errno: a missing file, a folder
/// or an empty name is an InputError; no permission or an I/O fault is a SystemError.
[[noreturn]] void throw_open_error(const std::string& file, int errno_value);

}  // namespace supple
