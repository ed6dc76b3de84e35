// The folders whose files a page may name, and no others: not by "..", not by a link that leads
// out.
#pragma once

#include <string>
#include <vector>

namespace supple::tools {

class Folders {
 public:
  /// Throws InputError for one that is no folder.
  explicit Folders(const std::vector<std::string>& roots);

  /// The file or folder without links, to be read. Relative paths begin at the first folder. Throws
  /// InputError where it is missing or outside; outside both look alike.
  std::string input(const std::string& path) const;
  /// The path of a file to be written: no link, not hidden, its folder is there. Throws InputError.
  std::string output(const std::string& path) const;

  /// Returns these and another one.
  Folders with(const std::string& root) const;
  /// True if a file that exists lies within.
  bool holds(const std::string& path) const;

  const std::vector<std::string>& roots() const { return m_roots; }

 private:
  std::string absolute(const std::string& path) const;
  bool is_within(const std::string& resolved) const;

  std::vector<std::string> m_roots;  // without links
};

}  // namespace supple::tools
