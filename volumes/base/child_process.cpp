#include "volumes/base/child_process.h"

#include <sstream>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// The lines that begin so, without that.
std::vector<std::string> lines_of(const std::string& text, const std::string& prefix) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(prefix, 0) == 0 && line.size() > prefix.size()) {
      lines.push_back(line.substr(prefix.size()));
    }
  }
  return lines;
}

std::string last_of(const std::vector<std::string>& lines) {
  return lines.empty() ? "" : lines.back();
}

/// Returns the complaint of a child that ended by itself.
std::string complaint_of(const std::string& err) {
  const std::string error = last_of(lines_of(err, "supple: error: "));
  if (!error.empty()) return error;
  const std::vector<std::string> lines = lines_of(err, "");
  for (const std::string& line : lines) {
    for (const char* report :
         {"runtime error: ", "ERROR: AddressSanitizer", "ERROR: LeakSanitizer"}) {
      if (line.find(report) != std::string::npos) return line;
    }
  }
  return last_of(lines);
}

}  // namespace

ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   const ProgramLimits& limits, const std::function<bool()>& cancelled) {
  ChildEnd end{run_program(program, arguments, "", limits, cancelled), {}, {}};
  for (const std::string& line : lines_of(end.err, "supple: warning: ")) {
    end.warnings += (end.warnings.empty() ? "" : "; ") + line;
  }
  end.complaint = complaint_of(end.err);
  if (end.timed_out) {
    end.complaint = "no result after " + number_text(limits.wall_s) + " s";
  } else if (end.over_memory) {
    end.complaint = "more than " + number_text(limits.resident_mb) + " MB";
  } else if (end.signal != 0) {
    end.complaint = "ended by signal " + std::to_string(end.signal) +
                    (end.complaint.empty() ? "" : ": " + end.complaint);
  }
  return end;
}

}  // namespace supple
