// How the steps of a scene are solved, by a name in place of what the scene says: "relax-26:64" is
// Enhanced ChainMail with 26 links, then 64 passes of relaxation. Loads, anchors, cuts, views and
// outputs stay those of the scene, so that methods are compared under one load.
#pragma once

#include <string>
#include <vector>

#include "tools/scene/scene.h"

namespace supple::tools {

/// Methods that differ in one number, the knob, which trades time for error.
struct MethodFamily {
  const char* name;                             // "relax-26"
  const char* title;                            // for charts and tables
  const char* knob;                             // what the number is: "passes"
  double lowest, highest;                       // that the knob may have
  bool is_whole;                                // the knob is a whole number
  std::vector<double> ladder;                   // its values from the fastest to the most exact
  int links;                                    // of the material; 0: its own; kKnobLinks: the knob
  void (*solve)(SceneStep& step, double knob);  // sets what moves the body
};
constexpr int kKnobLinks = -1;

/// All of them, in the order of charts. A new method is one line.
const std::vector<MethodFamily>& method_families();

struct StepMethod {
  const MethodFamily* family = nullptr;
  double knob = 0;

  /// "relax-26:64".
  std::string name() const;
};

/// Of "NAME:KNOB"; "NAME" takes the last of the ladder. Throws InputError.
StepMethod parse_method(const std::string& text);

/// Steps that only relaxed, or only named a model, are left out; views go by the steps that stay.
/// Throws InputError, with the step's place, where the method cannot take what a step asks for:
/// forces and shapes in contact without the model that knows them, tightened limits; and for links
/// of a scene without material, for films and journals.
void solve_by(Scene& scene, const StepMethod& method);

}  // namespace supple::tools
