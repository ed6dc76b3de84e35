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

  /// One picture of the view, valid until the next one; a stereo pair side by side, also for two
  /// streams, or as an anaglyph.
  const Image& draw(const MicroscopeView& view, double time_s, MicroscopeTimes* times = nullptr);
  /// The camera of a view in the eye's frame.
  Camera camera_of(const MicroscopeView& view, double time_s) const;

 private:
  struct Placed {
    int tool, jaw, rigid;  // indices
  };
  void add_instruments(const Operation& operation);
  void add_iris(const EyeSetup& eye);
  LampLight lamp_of(const Operation& operation) const;
  void follow_membranes(const Operation& operation);
  void follow_vitreous(const Vitreous& vitreous);
  HazeLayer* layer();

  const OperationScene& m_scene;
  Microscope m_microscope;
  Image m_image;
  std::vector<Placed> m_placed;
  /// A membrane as the picture has it.
  struct Soft {
    int shape;
    std::int64_t topology_version = -1;
    std::vector<Vec3d> pos_mm = {};
  };
  std::vector<Soft> m_soft;
  struct Haze;
  std::unique_ptr<Haze> m_haze;  // of the vitreous, where there is one
  EyeTurn m_turn;
};

/// The left half of a pair side by side, or the right one.
Image half_of(const Image& both, bool is_right);

}  // namespace supple::tools
