// A file written front to back under a temporary name, whose errors name the final path.
#pragma once

#include <fstream>
#include <string>

#include "volumes/base/atomic_file.h"

namespace supple {

/// A file to be written, of which nothing remains without commit(). Throws SystemError (disk full,
/// no permission) and as AtomicFile.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);

  void write(const void* data, std::size_t size);
  void write(const std::string& text) { write(text.data(), text.size()); }
  /// Sets where the next bytes go, from the start of the file.
  void seek(std::int64_t offset);
  std::int64_t position();
  /// Hands everything to the system; no more writing.
  void close();
  /// Brings the closed file to disk, then to its final name.
  void commit() { m_file.commit(); }

  const std::string& final_path() const { return m_file.final_path(); }

 private:
  void check() const;

  AtomicFile m_file;
  std::ofstream m_stream;
};

}  // namespace supple
