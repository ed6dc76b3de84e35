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
#include "volumes/base/files.h"
#include "volumes/base/vec.h"

namespace supple {

// The shapes that a body takes at times of its motion, in a file among the temporary ones: where
// these lie on a disk, a film of many frames takes no more memory than one of few. Cost: 12 bytes
// per element and frame there.

class MotionFrames {
 public:
  /// Throws SystemError.
  MotionFrames();

  /// The next frame: displacement of the elements' centres in mm, LPS, in the order of the bricks.
  /// All frames have as many elements. Throws SystemError, as where the disk is full.
  void add(const std::vector<Vec3f>& displacement_mm);
  /// Returns one of the frames, from 0. Throws std::out_of_range; SystemError.
  std::vector<Vec3f> at(std::size_t frame) const;
  std::size_t count() const { return m_count; }

 private:
  ScratchFolder m_folder;
  std::string m_path;
  std::size_t m_elements = 0, m_count = 0;
};

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
