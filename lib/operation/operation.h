// An operation: instruments that hands or tracks lead, rigid surfaces, membranes and a voxel body
// that they meet, and the eye that holds all of it where there is one (thesis section 6.1.2). Time
// goes on in equal steps; a step depends on the state and on the poses that are asked for, and on
// nothing else, so that tracks replay to the same bits.
//
// Order of a step: the eye turns, instruments go as far as rigid surfaces let them, the voxel
// bodies and membranes follow, touches bleed. All bodies live in the eye's frame.
//
// Parts that a scene does not have take neither memory nor time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/instruments/tool_contact.h"
#include "lib/membrane/membrane.h"
#include "lib/operation/eye.h"
#include "lib/operation/operation_sample.h"
#include "lib/operation/pushed_body.h"
#include "lib/operation/vitreous.h"

namespace supple {

/// An instrument in an operation.
struct OperationTool {
  InstrumentSetup shape;
  std::string incision;       // of the eye; empty: none
  InstrumentPose start = {};  // free of all surfaces
};

/// Another model takes a membrane over while the operation goes on.
struct ModelChange {
  double time_s = 0;  // after 0; the first step that ends then or later is its own
  MembraneModel model = MembraneModel::springs;
};

struct OperationMembrane {
  std::string name;
  TriangleMesh mesh;
  MembraneParams params;
  std::vector<ModelChange> changes = {};
};

/// A scanned body of voxels, which lives as long as the operation and is moved by it alone.
struct OperationVolume {
  Body* body = nullptr;
  SlotSet held;  // elements that stay where they are
};

struct OperationSetup {
  double step_s = 0.02;
  std::optional<EyeSetup> eye;
  std::vector<Obstacle> shapes;  // beside those of the eye
  std::vector<OperationTool> tools;
  std::vector<OperationMembrane> membranes;
  std::optional<VitreousSetup> vitreous;
  std::optional<OperationVolume> volume;
  std::uint64_t seed = 1;
};

/// Milliseconds of the parts of a step.
struct OperationTimes {
  double contact_ms = 0, vitreous_ms = 0, volume_ms = 0, membranes_ms = 0, total_ms = 0;
};

class Operation {
 public:
  /// Throws InputError: an incision that the eye does not have, an instrument that starts within a
  /// surface, and what Membrane and make_instrument() throw.
  explicit Operation(const OperationSetup& setup);
  ~Operation();
  Operation(Operation&&) noexcept;

  /// Makes one step towards the poses that hands ask for, in the head's frame, one per instrument.
  /// Returns what came of it, poses in the eye's frame.
  const OperationSample& step(const std::vector<InstrumentPose>& asked);

  /// From the next step on another model moves a membrane, as by a change of the setup.
  void take_model(std::size_t membrane, MembraneModel model);

  const OperationSetup& setup() const;
  const OperationSample& sample() const;
  const OperationTimes& times() const;
  const std::vector<Instrument>& instruments() const;
  const std::vector<Obstacle>& obstacles() const;
  const std::vector<Membrane>& membranes() const;
  const Vitreous* vitreous() const;
  /// What the last step did to the scanned body.
  const PushReport& pushed() const;
  const EyeTurn& turn() const;
  const std::vector<Bleeding>& bleedings() const;
  /// Digest of all that the next step depends on: SHA-256.
  std::string digest() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
