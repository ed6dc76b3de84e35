// A film as a scene's [film] asks for it: numbered frames, in each of which the handles that follow
// a path, and the cameras, are at their poses at one time.
#pragma once

#include <vector>

#include "volumes/base/error.h"
#include "volumes/base/table.h"

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

/// Throws InputError where the last key of a list comes before the one ahead of it.
template <class Keys>
void require_later(const Table& table, const Keys& keys) {
  if (keys.size() < 2 || keys.back().time > keys[keys.size() - 2].time) return;
  table.fail("time", number_text(keys.back().time),
             "a time after that of the key before it, " + number_text(keys[keys.size() - 2].time));
}

}  // namespace supple::tools
