// The runs of `supple stress`. Each function writes the input into the folder, runs it by the
// stages that `supple run` uses and adds what was measured. All throw as a scene does.
#pragma once

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

// Rows whose model moves a body: the scene is run by the stage that `supple run` uses, and its
// result is measured anew, not only read from its report.

/// Each writes the input into the folder, runs it and adds what was measured. Throws as a scene
/// does.
void run_ecm(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all);
void run_ball(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all);
void run_relaxed(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
void run_springs_at_rest(const StressInput& input, const std::string& folder, Console& console,
                         MeasuredValues& all);
/// Steps are StressInput::spring_step of the longest stable one. In a second step the handle stays.
void run_springs(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
void run_fem(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all);
void run_inverse(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
/// Gibson's algorithm, which knows no anchors; it is in no scene.
void run_original(const StressInput& input, const std::string& folder, Console& console,
                  MeasuredValues& all);

// The row of bones: random drags of the upper jaw of a head CT, each judged by where voxels are.

/// StressInput::operations drags of the jaw of build/data/ct_head.nhdr, parted from the skull as in
/// docs/scenes/head_upper_jaw.toml, by up to 8 mm along each axis, every second one away from the
/// skull, every fourth with a turn; each is taken back. Then drags that open both rami, which seeds
/// part. Throws InputError without that file.
void run_bones(const StressInput& input, const std::string& folder, Console& console,
               MeasuredValues& all);

// The row of a live session: random operations, each looked at.

/// StressInput::operations of all kinds but pictures, the same in every run. An operation that is
/// refused must have changed nothing; then all are taken back, and the journal is carried out by a
/// second session.
void run_live(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all);

// Rows whose result is a picture.

/// Runs the scene, reads the picture file that it leaves, and draws the view once more into
/// numbers. Throws as a scene does.
void run_picture(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);

}  // namespace supple::tools
