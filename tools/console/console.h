// Output for people: warnings, notes and progress on stderr, results on stdout. Progress is a line
// that changes on a terminal; elsewhere a line every ten seconds, or as many as the environment
// variable SUPPLE_PROGRESS_SECONDS says; for 3D Slicer as filter_progress.h has it. Also keeps the
// time of every stage, holds the names of outputs and turns Ctrl-C into cancellation.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/console/filter_progress.h"
#include "tools/scene/run/stage_times.h"
#include "volumes/base/files.h"
#include "volumes/base/progress.h"
#include "volumes/base/text.h"

namespace supple::tools {

enum class LogLevel { error, warning, info, debug };

/// Options that every subcommand takes.
struct GlobalOptions {
  int threads = 0;  // 0: all
  bool quiet = false;
  bool json = false;
  bool force = false;
  LogLevel log_level = LogLevel::info;
  std::vector<std::string> arguments;  // all of the command line, from the program's name on
};

class Console final : public Progress {
 public:
  explicit Console(const GlobalOptions& options);
  ~Console() override;

  /// Prints an error of one of several inputs, where the others are worked on all the same.
  void error(const std::string& line);
  void warn(const std::string& line) override;
  void note(const std::string& line) override;
  void debug(const std::string& line) override;

  void enter(const std::string& what, int number) override;
  void tell_repeats() override;

  void stage(std::string_view name) override;
  void update(double fraction) override;
  bool cancelled() const override;

  /// Holds the names of files that are going to be written, so that no other process writes them
  /// meanwhile. Throws as ReservedNames.
  void claim(const std::vector<std::string>& outputs);
  /// Notes which outputs are there, with size and time since the start.
  void tell_outputs();
  /// Ends the line of progress, before results are printed.
  void clear_line();

  /// Ends the running stage; seconds of every stage so far, in order, equal names added up.
  std::vector<std::pair<std::string, double>> stage_seconds();

 private:
  using Clock = std::chrono::steady_clock;
  void show_progress(double fraction, Clock::time_point now);
  void print(LogLevel level, const char* prefix, const std::string& line);
  void print_once(LogLevel level, const char* prefix, const std::string& line);

  LogLevel m_level;
  bool m_has_terminal;
  std::optional<RepeatedLines> m_repeated;
  std::chrono::duration<double> m_line_every;  // without a terminal
  Clock::time_point m_start = Clock::now();
  std::vector<std::string> m_outputs;
  std::optional<ReservedNames> m_reserved{std::in_place};
  bool m_line_open = false;
  std::string m_stage;
  Clock::time_point m_stage_start;
  StageTimes m_times;
  FilterProgress m_filter;  // for 3D Slicer
  Clock::time_point m_last_print;
};

/// The text without characters that would end the line or steer a terminal, such as a damaged
/// header may hold: ends of lines become blanks, other control characters '?'.
std::string one_line(std::string text);

}  // namespace supple::tools
