// Ctrl-C during work that nobody is told of.
#pragma once

#include "tools/console/console.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// Stops an engine but prints nothing, for example while it is timed.
class CancelOnly final : public Progress {
 public:
  explicit CancelOnly(const Console& console) : m_console(console) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_console.cancelled(); }

 private:
  const Console& m_console;
};

}  // namespace supple::tools
