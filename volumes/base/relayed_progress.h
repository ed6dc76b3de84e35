// A base of listeners that change some of what they hand on.
#pragma once

#include "volumes/base/progress.h"

namespace supple {

/// Hands everything on to another one, or to nobody.
class RelayedProgress : public Progress {
 public:
  explicit RelayedProgress(Progress* next) : m_next(next) {}
  void hand_on_to(Progress* next) { m_next = next; }

  void stage(std::string_view name) override { supple::stage(m_next, name); }
  void update(double fraction) override {
    if (m_next != nullptr) m_next->update(fraction);
  }
  bool cancelled() const override { return m_next != nullptr && m_next->cancelled(); }
  void warn(const std::string& line) override { supple::warn(m_next, line); }
  void note(const std::string& line) override { supple::note(m_next, line); }
  void debug(const std::string& line) override { supple::debug(m_next, line); }

 private:
  Progress* m_next;
};

}  // namespace supple
