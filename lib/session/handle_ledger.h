// The handles that steps so far hold, and the forces on them, as a haptic device would feel them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/fem/fem_report.h"
#include "lib/relax/relax_report.h"
#include "lib/session/step.h"

namespace supple {

class HandleLedger {
 public:
  /// The handles of a step are held from now on. Elements that they take belong to earlier handles
  /// no more. Throws InputError for one without element.
  void add(int step, const std::vector<Handle>& handles, const Body& body);
  void release() { m_handles.clear(); }
  /// Follows a removal of elements: keeps the remaining elements of each handle, on the bricks of
  /// `to`.
  void move_to(const BrickTopology& from, const BrickTopology& to);

  bool empty() const { return m_handles.empty(); }
  /// The elements of each handle; no element is in two.
  std::vector<SlotSet> elements() const;
  /// Names the handles of `reactions`, which are those of elements().
  std::vector<HandleReaction> name(const std::vector<Reaction>& reactions) const;
  std::vector<HandleReaction> name(const std::vector<FemReaction>& reactions) const;

 private:
  struct LedgerEntry {
    int step, handle;
    std::string name;
    SlotSet elements;
  };
  std::vector<LedgerEntry> m_handles;
};

}  // namespace supple
