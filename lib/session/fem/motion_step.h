// A motion in time in a step of finite elements, and what it was like.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/fem/fem_report.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/model/fem_motion.h"
#include "volumes/base/fields.h"

namespace supple {

/// Begins the motion, goes through all its steps, and gives the body its end. Throws InputError:
/// a watched voxel that is no element; SystemError: no place for the frames; else as
/// VoxelFemMotion.
MotionRecord run_motion(const MotionStep& step, VoxelFemMotion& model, const Body& body,
                        const std::vector<Handle>& handles, const std::vector<SlotSet>& gripped,
                        Progress* progress);

/// The elements lie, at rest, where the record's frame has them.
void take_frame(const MotionRecord& record, std::size_t frame, Body& body);

/// Writes a row per sample: time in s, energies in mJ, displacements in mm, and the forces with
/// which the body pulls at `handles`, whose reactions the samples have, in N.
std::string motion_csv(const MotionRecord& record, const std::vector<std::string>& handles);

/// Keys of `motion = { … }` of fem, but for `watch`.
Fields fields(MotionStep& step);

}  // namespace supple
