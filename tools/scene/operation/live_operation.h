// An operation that hands lead while it goes on. Instruments whose pose a hand has asked for follow
// it, all others their tracks. Poses and looks of all steps are kept, so that the session can be
// saved as a scene with tracks that replays to the same bits. No time passes but in steps
// (operation_loop.h has the clock).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/operation/operation.h"
#include "tools/scene/operation/operation_record.h"
#include "tools/scene/operation/operation_scene.h"
#include "volumes/base/table.h"

namespace supple::tools {

/// Parts of a pose that a hand asks for, in the head's frame; the others stay as they are. Without
/// an axis the shaft goes through its incision, where it has one.
struct PoseWish {
  std::optional<Vec3d> tip_mm, axis;
  std::optional<double> roll_degrees, opening_degrees, active;
};
Fields fields(PoseWish& wish);

/// How a person wants to see the operation; what is not there stays as it is.
struct LookWish {
  std::optional<Vec3d> focus_mm;
  std::optional<double> zoom;
  std::string stereo, shadow;  // empty: as it is
};
Fields fields(LookWish& wish);

class LiveOperation {
 public:
  /// Opens the root of an operation's scene. Throws as read_operation() and Operation.
  explicit LiveOperation(const Table& root);
  ~LiveOperation();

  /// Index of an instrument. Throws InputError that lists the names.
  int find(const std::string& instrument) const;
  /// Leads an instrument by hand from now on. Throws InputError for an axis without length.
  void ask(int instrument, const PoseWish& wish);
  /// Lets an instrument follow its track again.
  void let_go(int instrument);
  bool is_led(int instrument) const;
  /// The pose that the next step will ask for, unless a hand asks for another one; of the last step
  /// where a track leads.
  const InstrumentPose& asked(int instrument) const;
  void look(const LookWish& wish);
  /// Index of a membrane. Throws InputError that lists the names.
  int find_membrane(const std::string& name) const;
  /// Exchanges the model that moves a membrane, from the next step on.
  void take_model(int membrane, MembraneModel model);
  /// The model of the next step.
  MembraneModel model(int membrane) const;

  /// Makes one step. Returns what came of it.
  const OperationSample& step();
  /// Goes back to the beginning. Hands keep what they lead, which starts where the scene says.
  void restart();

  /// Files of a session that is saved to `path`: the scene, and a track of each instrument.
  std::vector<std::string> files(const std::string& path) const;
  /// Writes them. Throws SystemError.
  void save(const std::string& path) const;

  const OperationScene& scene() const;
  const Operation& operation() const;
  const OperationRecord& record() const;
  /// The first view as it is seen now.
  const MicroscopeView& view() const;
  int steps() const;
  int restarts() const;
  double time_s() const { return steps() * scene().setup.step_s; }

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple::tools
