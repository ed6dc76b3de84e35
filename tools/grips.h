// The handles that steps so far hold, and what they feel: what a haptic device would.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/chainmail/ecm.h"
#include "lib/relax/reaction.h"

namespace supple::tools {

/// A handle that is held, and the force with which the body pulls at its holder.
struct HandleReaction {
  int step, handle;  // that grabbed it, from 1
  std::string name;  // of its region
  Reaction reaction;
};

class HandleLedger {
 public:
  /// The handles of a step are held from now on; what they take of earlier ones these lose. Throws
  /// InputError for one without element.
  void add(int step, const std::vector<Handle>& handles, const Body& body);
  void release() { m_grips.clear(); }

  bool empty() const { return m_grips.empty(); }
  /// The elements of each; no element is in two.
  std::vector<SlotSet> elements() const;
  /// `reactions` are those of elements().
  std::vector<HandleReaction> forces(const std::vector<Reaction>& reactions) const;

 private:
  struct Grip {
    int step, handle;
    std::string name;
    SlotSet elements;
  };
  std::vector<Grip> m_grips;
};

nlohmann::ordered_json to_json(const std::vector<HandleReaction>& forces);
/// One line per handle on stdout.
void print(const std::vector<HandleReaction>& forces);

}  // namespace supple::tools
