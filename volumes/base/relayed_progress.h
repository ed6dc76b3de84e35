// Listeners that hand on some of what they hear.
#pragma once

#include <atomic>

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

/// Hands on all but lines for the user.
class UntoldProgress final : public RelayedProgress {
 public:
  using RelayedProgress::RelayedProgress;
  void warn(const std::string&) override {}
  void note(const std::string&) override {}
  void debug(const std::string&) override {}
};

/// Cancels as another one does and says nothing, for example while work is timed.
class CancelOnly final : public Progress {
 public:
  /// null: nobody cancels.
  explicit CancelOnly(const Progress* asked) : m_asked(asked) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_asked != nullptr && m_asked->cancelled(); }

 private:
  const Progress* m_asked;
};

/// Cancels where another thread asks for it; says nothing.
class CancelWhere final : public Progress {
 public:
  explicit CancelWhere(const std::atomic<bool>& is_cancelled) : m_is_cancelled(is_cancelled) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_is_cancelled; }

 private:
  const std::atomic<bool>& m_is_cancelled;
};

}  // namespace supple
