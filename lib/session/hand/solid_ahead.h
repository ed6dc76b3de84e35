// The solid of finite elements of a session's body, made before a handle is grabbed: meshes,
// stiffnesses and what else does not depend on what is held. A body of two million elements takes
// seconds. Made by the thread of the session, run by another one.
#pragma once

#include <memory>
#include <mutex>

#include "lib/body/body.h"
#include "lib/fem/response/response_key.h"
#include "lib/session/fem_step.h"

namespace supple {

struct KeptVoxels;   // lib/session/kept_voxels.h
struct SessionBody;  // lib/session/session_body.h

class SolidAhead {
 public:
  /// Copies what it needs of the body, which may go on. `step`: which elements, why_no_sum() empty.
  SolidAhead(SessionBody& in, const FemStep& step);
  ~SolidAhead();

  /// True for the solid of that body and step.
  bool is_of(SessionBody& in, const FemStep& step) const;
  /// Makes it. Throws as FemModel, Cancelled.
  void run(Progress* progress);
  /// The solid, once run() is done; null before.
  std::shared_ptr<KeptVoxels> voxels() const;

 private:
  FemStep m_step;
  Body m_body;
  LinkCuts m_cuts;
  ResponseKey m_key;
  mutable std::mutex m_mutex;
  std::shared_ptr<KeptVoxels> m_voxels;
};

}  // namespace supple
