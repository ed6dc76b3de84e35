// A motion in time in a step of finite elements, and what it was like.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/fem/voxel/fem_results.h"
#include "lib/model/fem_motion.h"
#include "volumes/base/fields.h"

namespace supple {

class MotionFrames;

struct MotionStep {
  double time_s = 0;
  std::optional<double> step_s;  // none: a hundredth of the time
  std::optional<double> ramp_s;  // of the handles' ways; none: the time
  double mass_damping_per_s = 0;
  std::vector<Vec3i> watch;           // voxels whose displacement is recorded
  std::vector<double> frame_times_s;  // ascending; at which the body's shape is kept

  /// Steps of one length, none longer than was asked for.
  int steps() const;
  double step_length_s() const { return time_s / steps(); }
  /// Number of steps on the handles' ways.
  int ramp_steps() const;
  /// Throws InputError: more steps than are taken for a mistake.
  void validate() const;
};

/// The motion at one time.
struct MotionSample {
  double time_s = 0;
  MotionEnergy energy;
  double largest_mm = 0;           // displacement of a node
  std::vector<Vec3d> watched_mm;   // displacements, LPS
  std::vector<Vec3d> reactions_n;  // of `gripped`, LPS
};

struct MotionRecord {
  double step_s = 0;
  int steps = 0;
  std::vector<Vec3i> watched;
  std::vector<MotionSample> samples;  // the start, and after each step
  /// Largest imbalance of energy, work and damping, relative to the largest sum of energies.
  double energy_error = 0;
  LargestMotion largest;                 // turn and strain of an element, at any time
  std::shared_ptr<MotionFrames> frames;  // one per time that was asked for; null: none was
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
