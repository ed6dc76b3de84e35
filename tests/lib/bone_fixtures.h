// Bones beside each other for tests of their contact.
#pragma once

#include <string>

#include "lib/session/session.h"
#include "tests/support/program.h"

namespace supple::test {

/// `ct-head` without relaxation, undo kept.
SessionOptions bone_options();

/// Two bones with a wavy joint of four voxels; a third one, free in the soft tissue beyond them.
std::string write_wavy_joint(const TemporaryFolder& folder, bool has_third_bone);
/// The right one of them dragged, the left one held.
Step wavy_drag(const Vec3d& by_mm);

/// The box around the upper jaw of the scan: its voxels from 84, 150, 0 to 172, 240, 40.
std::string write_jaw_crop(const std::string& raw, const TemporaryFolder& folder);
/// Parts the jaw from the skull, and holds that.
Step jaw_step();
Step jaw_drag(const Vec3d& by_mm);

}  // namespace supple::test
