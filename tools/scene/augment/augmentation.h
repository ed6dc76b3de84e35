// Random deformations of one body, each from rest: certified to fold no tissue, bones rigid, and
// the same by seed and number, whatever was drawn before. A motion that the limits of the tissue do
// not allow goes as far as they do; one that folds tissue, or whose handles do not agree, goes half
// as far, and again.
#pragma once

#include <cstdint>
#include <string>

#include "lib/session/session.h"
#include "tools/scene/augment/random_motion.h"
#include "volumes/base/progress.h"

namespace supple::tools {

struct AugmentParams {
  std::string motion = "drag";  // of random_motions()
  DrawnLimits limits;
  double least_det = 0;  // det F is above it everywhere in the tissue
  int passes = 10;       // of relaxation after each motion; 0: none
  int seed = 0;
};
Fields fields(AugmentParams& params);

class Augmentation {
 public:
  /// The session keeps undo, and must outlive this; what its body is now is rest. Throws InputError
  /// as draws of motions.
  Augmentation(Session& session, const AugmentParams& params);

  /// Takes the session to sample `number`, from rest, and says how: keys `sample`, `seed`,
  /// `motion`, `step` (as a scene has it), `part` of the drawn way that was gone, `certificate`,
  /// `pieces` and `hash` of the state. At rest (`part` 0) where no part of the way was free of
  /// folds. Throws Cancelled, at rest again.
  Value draw(int number, Progress* progress = nullptr);
  /// Takes the session back to rest, bit for bit.
  void take_back();

 private:
  /// The part of the way of these keys that the body went; 0 and at rest where that may not be.
  double go(const Value& keys, Progress& progress);
  bool is_whole(const InversionCertificate& certificate) const;

  Session& m_session;
  AugmentParams m_params;
  const RandomMotion& m_motion;
  DrawnBody m_body;
  std::size_t m_rest;  // steps that can be undone at rest
};

}  // namespace supple::tools
