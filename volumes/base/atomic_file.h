// A file that appears under its final name only when it is complete.
#pragma once

#include <string>

namespace supple {

/// SystemError for a failed write of `path`, or InputError where its folder is missing.
[[noreturn]] void throw_write_error(const std::string& path, int errno_value);

/// Throws InputError unless `path` can name an output: not a directory, device, pipe or socket, of
/// at most 255 bytes, and its folder exists.
void check_output_place(const std::string& path);

/// The part of a temporary name that tells which file it is of: the file's own name, or where that
/// leaves no room in a name of 255 bytes, a number made of it and its extension.
std::string temporary_part(const std::string& file_name);

/// Returns the name under which a file is written before it has its final name.
std::string temporary_name(const std::string& final_path);

/// Owns a temporary file beside `final_path`. Write to `path()` by any means, then commit().
/// Without commit() the destructor removes the temporary file and the final name is untouched.
class AtomicFile {
 public:
  /// Creates the temporary file; a link as final path stands for the file it points at. Throws
  /// SystemError (no permission, disk full) or as check_output_place.
  explicit AtomicFile(std::string final_path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return m_temporary_path; }
  const std::string& final_path() const { return m_final_path; }

  /// Flushes to disk (fsync) and renames to the final name; a file that is replaced hands on its
  /// mode bits. Throws SystemError.
  void commit();

 private:
  std::string m_final_path;
  std::string m_temporary_path;
};

/// Files that belong together get their final names while it lives.
class CommonCommit {
 public:
  CommonCommit();
  ~CommonCommit();
  CommonCommit(const CommonCommit&) = delete;
  CommonCommit& operator=(const CommonCommit&) = delete;

  /// True if there is one, so that the process should not end. A signal handler may ask.
  static bool is_under_way();
};

}  // namespace supple
