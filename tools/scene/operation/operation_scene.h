// Scene files of operations: a scene with a table [operation]. Instruments with tracks, rigid
// shapes, membranes, an eye, voxel bodies, tasks and rules of scores, and views as under a
// microscope, of a scanned volume as in any scene (docs/operations.md). Paths of inputs are
// relative to the file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/instruments/track.h"
#include "lib/operation/operation.h"
#include "lib/operation/score_rule.h"
#include "lib/operation/task.h"
#include "raycast/microscope/microscope.h"
#include "raycast/scene/camera.h"
#include "volumes/base/table.h"
#include "volumes/geometry/keyframes.h"

namespace supple::tools {

struct Scene;

/// True for the root of an operation's scene.
bool is_operation(Table& root);

/// A track of a file, or one that a hand makes along way points; and the instrument's colour.
struct ToolTrack {
  InstrumentTrack track;
  Rgb rgb;
};

struct MembraneLook {
  Rgb rgb{0.93, 0.88, 0.70};
  double opacity = 0.35;
};

enum class StereoKind { none, side_by_side, anaglyph, two_streams };
enum class ShadowKind { none, hard, soft };

/// A view of an operation: a microscope above its focus.
struct MicroscopeView {
  std::string place;
  std::string image;          // of the end; empty: none
  std::string video;          // of all of it; empty: none
  Vec3d focus_mm{0, 0, -11};  // in the head's frame
  Vec3d from{0, 0, 1};        // direction from the focus to the microscope
  Vec3d up{0, 1, 0};
  double distance_mm = 200;  // from the focus
  double field_mm = 9;       // height that is seen there
  double eye_separation_mm = 10;
  StereoKind stereo = StereoKind::none;
  ShadowKind shadow = ShadowKind::hard;
  PixelSize size{800, 600};
  bool smooth_edges = true;
  int vitreous_part = 4;  // of the width at which the vitreous is marched
  double ambient = 0.03;
  bool eyepiece = false;
  bool is_settled = false;  // drawn as well as can be: soft shadow, all of the vitreous
  Track<Vec3d> focus_keys;  // in place of focus_mm
  Track<double> zoom_keys;  // of field_mm

  Camera camera_at(double time_s) const;
  Vec3d focus_at(double time_s) const;
  double zoom_at(double time_s) const;
  MicroscopeSettings settings() const;
};
/// Keys of a [[view]] of an operation, but for its keys over time.
Fields fields(MicroscopeView& view);

/// Files of an operation beside its pictures.
struct OperationOutput {
  std::string log;     // .jsonl
  std::string score;   // .json
  std::string tracks;  // .csv with %s in place of the instrument: poses that hands asked for
};
Fields fields(OperationOutput& output);

struct OperationScene {
  std::string file;
  OperationSetup setup;
  std::vector<ToolTrack> tracks;        // per instrument
  std::vector<MembraneLook> membranes;  // per membrane
  std::vector<TaskSetup> tasks;
  std::vector<ScoreRule> rules;
  std::vector<MicroscopeView> views;
  /// A scanned volume with its first steps and its views, which are films of the operation and then
  /// all that there are; null without.
  std::shared_ptr<Scene> volume;
  OperationOutput output;
  double duration_s = 0;          // 0 as given: until the last track ends
  bool repeats = false;           // tracks begin again when they end
  double frames_per_second = 25;  // of videos

  /// Poses of all instruments that the tracks ask for.
  std::vector<InstrumentPose> poses_at(double time_s) const;
  int step_count() const;
  /// All outputs, relative as written.
  std::vector<std::string> outputs() const;
  int frame_count() const;  // of videos
};

/// Throws InputError: unknown key (line and suggestion), wrong type or value, missing key.
OperationScene read_operation(Table root);

}  // namespace supple::tools
