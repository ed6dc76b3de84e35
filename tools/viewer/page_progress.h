// How far long work has come, for the pages: told when it has taken a while, a few times a second.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include "tools/viewer/pages.h"
#include "volumes/base/progress.h"

namespace supple::tools {

class PageProgress final : public Progress {
 public:
  /// `behind` says whether the program ends, and shows the same on a terminal.
  PageProgress(Pages& pages, Progress& behind);

  void stage(std::string_view name) override;
  void update(double fraction) override;
  bool cancelled() const override;
  void warn(const std::string& line) override;
  void note(const std::string& line) override;
  void debug(const std::string& line) override { m_behind.debug(line); }

  /// Notes that work begins, which can be cancelled until end().
  void begin();
  /// Notes that nothing runs any more; tells the pages so, if they were told that something does.
  void end();
  /// Ends what runs, if anything, with Cancelled; from any thread.
  void cancel() {
    if (m_is_running) m_is_cancelled = true;
  }

 private:
  void log(const char* level, const std::string& line);

  Pages& m_pages;
  Progress& m_behind;
  std::string m_stage;
  std::chrono::steady_clock::time_point m_begun, m_entered, m_told;  // the work, its stage
  bool m_is_told = false;
  std::atomic<bool> m_is_running{false}, m_is_cancelled{false};
};

}  // namespace supple::tools
