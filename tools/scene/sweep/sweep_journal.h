// The journal of a sweep: a file of one line of JSON per finished case, with all of its report, so
// that a sweep goes on after whatever ended it, and other columns need no other run.
//
// A case is known by a digest of all that its result depends on. The first line has that of the
// scene; lines of cases are on the disk before add() returns, and one that was cut off is dropped.
#pragma once

#include <map>
#include <string>

#include "volumes/base/value.h"

namespace supple::tools {

class SweepJournal {
 public:
  /// Reads the file where it is there. `anew`: forgets the cases in it. Throws InputError for
  /// another file than the journal of this scene; SystemError where it cannot be written.
  SweepJournal(const std::string& path, const std::string& scene_digest, bool anew);
  ~SweepJournal();
  SweepJournal(const SweepJournal&) = delete;
  SweepJournal& operator=(const SweepJournal&) = delete;

  /// The report of a case, null where it is not known.
  const Value* find(const std::string& case_digest) const;
  /// Makes the file with the first case. Throws SystemError, InputError as AtomicFile.
  void add(const std::string& case_digest, const Value& report);

 private:
  void read(const std::string& text, bool anew);
  void append(const Value& line);

  std::string m_path, m_scene_digest;
  std::map<std::string, Value> m_reports;
  std::size_t m_whole_bytes = 0;  // of the lines that are to stay
  int m_file = -1;
};

}  // namespace supple::tools
