// What a person sees: warnings, notes and progress on stderr, results on stdout. Also keeps the
// time of every stage and turns Ctrl-C into cancellation.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

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
};

class Console final : public Progress {
 public:
  explicit Console(const GlobalOptions& options);
  ~Console() override;

  void warn(const std::string& line) override;
  void note(const std::string& line) override;
  void debug(const std::string& line) override;

  void stage(std::string_view name) override;
  void update(double fraction) override;
  bool cancelled() const override;

  /// Ends the running stage; seconds of every stage so far, in order, equal names added up.
  std::vector<std::pair<std::string, double>> stage_seconds();

 private:
  using Clock = std::chrono::steady_clock;
  void finish_stage();
  void clear_line();
  void print(LogLevel level, const char* prefix, const std::string& line);

  LogLevel m_level;
  bool m_shows_progress;
  bool m_line_open = false;
  std::string m_stage;
  Clock::time_point m_stage_start;
  Clock::time_point m_last_print;
  std::vector<std::pair<std::string, double>> m_seconds;
};

/// The text without what would end the line or steer a terminal, such as a damaged header may hold:
/// ends of lines become blanks, other control characters '?'.
std::string one_line(std::string text);

/// Installs handlers for SIGINT, SIGTERM and SIGHUP that only set a flag; a second signal ends the
/// process.
void install_signal_handlers();
/// The signal that asked to stop, or 0.
int pending_signal();

}  // namespace supple::tools
