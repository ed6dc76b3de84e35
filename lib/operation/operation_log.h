// Log of an operation: lines of JSON, written while it goes on, so that memory does not grow with
// it. From the log alone the same score is found again, bit for bit.
//
// First line: {"operation_log": 1, "plan": {...}}, all that the score depends on beside the steps.
// Then for each step the rows of its events,
//   {"t": s, "event": kind, "by": instrument, "at": name, "place": [x, y, z], "value": v},
// and its row,
//   {"t": s, "tools": [{"asked": pose, "pose": pose, "force": N}, ...], "turn": [x, y, z] degrees,
//    "focus": [x, y, z] mm, "zoom": z, "clinging": mm², "vitreous": part, "membranes": {name:
//    mm²}, "inverted": {name: triangles}},
// the last only where a membrane has triangles that face backwards, with a pose as nine numbers:
// tip in mm, axis, roll and opening in degrees, activity. The last row is {"steps": count}: a log
// without it is not whole. Numbers have digits enough to read the same bits.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "lib/operation/score.h"
#include "volumes/base/atomic_file.h"

namespace supple {

class OperationLog {
 public:
  /// Begins a log, which has its final name after finish() and not before. Throws SystemError,
  /// InputError as AtomicFile.
  OperationLog(const std::string& path, const OperationPlan& plan);

  /// Writes a step. Throws SystemError where the disk is full, InputError for a number that is not
  /// finite.
  void add(const OperationSample& sample);
  /// Writes the last row: the log is whole then, under its temporary name. Throws SystemError.
  void end();
  /// Gives it its final name, after end() where that was not called. Throws SystemError.
  void finish();

 private:
  void write(const Value& row);

  AtomicFile m_file;
  std::ofstream m_out;
  std::int64_t m_steps = 0;
  bool m_is_ended = false;
};

class OperationLogReader {
 public:
  /// Throws InputError for a file that is no log, SystemError where it cannot be read.
  explicit OperationLogReader(const std::string& path);

  const OperationPlan& plan() const { return m_plan; }
  /// The next step with its events; nothing after the last one. Throws InputError that names file
  /// and line: a row that is damaged, times that descend, an end before the last row.
  std::optional<OperationSample> next();

 private:
  Table next_row();
  OperationSample read_step(Table& row);
  OperationEvent read_event(Table& row);
  void read_end(Table& row);

  std::string m_path;
  std::ifstream m_in;
  std::vector<char> m_text;  // of a line
  int m_line = 0;
  OperationPlan m_plan;
  std::int64_t m_steps = 0;
  std::optional<double> m_before_s;
  bool m_is_over = false;
};

/// The score of a log.
OperationScore score_of_log(const std::string& path);

}  // namespace supple
