// Pictures of an operation: its surfaces, lamp, blood and tasks under the microscope.
#pragma once

#include <memory>
#include <vector>

#include "lib/operation/operation.h"
#include "raycast/microscope/deformed_haze.h"
#include "raycast/microscope/microscope.h"
#include "raycast/pictures/image.h"
#include "tools/scene/operation/operation_scene.h"

namespace supple::tools {

class OperationPicture {
 public:
  /// Makes what stays the same: globe, instruments, iris. Refers to the scene.
  explicit OperationPicture(const OperationScene& scene, const Operation& operation);
  ~OperationPicture();

  /// Takes the state of a step; balls are those of the tasks.
  void follow(const Operation& operation, const std::vector<TaskBall>& balls);

  /// One picture of the view, a stereo pair side by side or as an anaglyph. Two streams give the
  /// pair side by side, too.
  Image draw(const MicroscopeView& view, double time_s, MicroscopeTimes* times = nullptr);
  /// A pair of two streams.
  Microscope::Pair draw_pair(const MicroscopeView& view, double time_s,
                             MicroscopeTimes* times = nullptr);
  /// The camera of a view in the eye's frame.
  Camera camera_of(const MicroscopeView& view, double time_s) const;

 private:
  struct Placed {
    int tool, jaw, rigid;  // indices
  };
  void add_instruments(const Operation& operation);
  void add_iris(const EyeSetup& eye);
  LampLight lamp_of(const Operation& operation) const;
  void follow_vitreous(const Vitreous& vitreous);
  HazeLayer* layer();

  const OperationScene& m_scene;
  Microscope m_microscope;
  std::vector<Placed> m_placed;
  std::vector<int> m_soft;  // per membrane
  struct Haze;
  std::unique_ptr<Haze> m_haze;  // of the vitreous, where there is one
  EyeTurn m_turn;
};

/// Two pictures of one height beside each other.
Image beside(const Image& left, const Image& right);

}  // namespace supple::tools
