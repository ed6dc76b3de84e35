#include "tools/scene/file/film.h"

#include <algorithm>
#include <cmath>

#include "tools/scene/pictures/picture_options.h"

namespace supple::tools {

int Film::frames_until(double time) const {
  // A key that lies on a frame but for rounding counts.
  const double frame = counts_frames ? time : time * frames_per_second;
  return int(std::floor(std::clamp(frame, 0.0, double(kMostFrames)) + 1e-6)) + 1;
}

Fields fields(Film& film) {
  return {
      Field("frames", film.frames, "Pictures, numbered from 0")
          .range(1, kMostFrames)
          .otherwise("to the last key"),
      Field("fps", film.frames_per_second, "Frames a second").range(0.1, 240),
      Field("times", film.counts_frames, {"seconds", "frames"}, "What times of keys count"),
  };
}

}  // namespace supple::tools
