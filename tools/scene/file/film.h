// A film as a scene's [film] asks for it: numbered frames, in each of which the handles that follow
// a path, and the cameras, are at their poses at one time.
#pragma once

#include <vector>

#include "volumes/base/fields.h"

namespace supple::tools {

struct Film {
  int frames = 0;  // 0 as given: to the last key
  double frames_per_second = 25;
  bool counts_frames = false;       // keys have numbers of frames, not seconds
  std::vector<int> frames_to_make;  // ascending; all unless the command says so
  bool makes_videos = true;

  /// Time of a frame, as keys have it.
  double time_of(int frame) const { return counts_frames ? frame : frame / frames_per_second; }
  /// Frames until a time, that included.
  int frames_until(double time) const;
};
Fields fields(Film& film);

}  // namespace supple::tools
