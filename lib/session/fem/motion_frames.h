// The shapes that a body takes at times of its motion, in a file among the temporary ones: where
// these lie on a disk, a film of many frames takes no more memory than one of few. Cost: 12 bytes
// per element and frame there.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/files.h"
#include "volumes/base/vec.h"

namespace supple {

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

}  // namespace supple
