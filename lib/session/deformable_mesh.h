// A mesh body beside the voxel body of a session: a membrane, a surface or a network that a file
// describes, moved by springs or by Enhanced ChainMail on its links. It shares the step and the
// history of its session, and meets no other body yet.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/model/mesh_ecm_model.h"
#include "lib/model/spring_models.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

/// A mesh body as a scene describes it.
struct MeshSetup {
  std::string place;  // "file:line", for errors
  std::string name;   // by which steps name it
  std::string path;   // of its mesh: STL, PLY, OBJ or legacy VTK, LPS mm
  MeshSpringParams springs;
  MeshLimits limits{1.2, 0.8, 0.2};
  bool fixes_rim = false;  // nodes at edges of one triangle alone stay where they are
  Rgb rgb{0.75, 0.78, 0.82};
  double opacity = 1;  // of one layer in pictures
};
/// Keys of a table [[body]].
Fields fields(MeshSetup& setup);

/// A move of a mesh body: by springs, or where there are none by ChainMail.
struct MeshMove {
  std::vector<MeshHandle> handles;
  NodeSet fix;            // nodes that stay from now on
  bool releases = false;  // lets go of all that earlier moves held or fixed, but not of the rim
  std::optional<MotionParams> springs = {};
  int steps = 1;                  // of springs, at most
  double mass_damping_per_s = 0;  // Rayleigh's alpha, of a motion
};

/// Results of a move.
struct MeshMoveReport {
  MeshEcmReport ecm;  // where ChainMail moved it
  int steps = 0;      // of springs, as all that follows
  std::size_t springs = 0;
  ModelEnergy before, after;
  std::optional<double> residual_mn;       // of a minimum: largest force on a free node
  std::optional<SpringStepReport> motion;  // of all steps of a motion
  std::vector<Reaction> reactions;         // of the handles
  std::vector<Vec3d> collider_forces_n;
  double milliseconds = 0;
};

/// A step of a mesh body: what it was asked, by nodes, and its results.
struct MeshRecord {
  MeshMove move;
  MeshMoveReport report;
};

class DeformableMesh {
 public:
  /// A body at rest; equal vertices become one node. Throws InputError: what read_network() throws,
  /// and a mesh without triangles or lines, named by its setup.
  explicit DeformableMesh(MeshSetup setup);
  /// A body as record() has described it. Throws InputError that names `file`.
  DeformableMesh(const Value& record, const std::string& file);

  const MeshSetup& setup() const { return m_setup; }
  const std::string& name() const { return m_setup.name; }
  const MeshBody& body() const { return m_body; }
  /// Triangles and links of neither, where they are now.
  LineNetwork shape() const;
  /// Setup, nodes and what holds them, so that a state can be continued.
  Value record() const;
  std::size_t bytes() const;

  /// Nodes whose places at rest satisfy `chooses`, ascending.
  template <class Choice>
  NodeSet nodes_where(const Choice& chooses) const {
    NodeSet nodes;
    for (std::size_t n = 0; n < m_body.node_count(); ++n) {
      if (chooses(m_body.rest_mm[n])) nodes.push_back(int(n));
    }
    return nodes;
  }
  /// The node nearest to a place at rest.
  int nearest_node(const Vec3d& at_lps_mm) const;

  /// Warns of drags that were stopped, of links that were projected and of a minimum that was not
  /// reached. Throws InputError as the models do, and Cancelled; the body is unchanged then.
  MeshMoveReport move(const MeshMove& move, Progress* progress);

  /// Data that a move changes.
  struct Shape {
    std::vector<Vec3d> pos_mm, velocity_mm_s;
    NodeSet fixed, held;
  };
  Shape kept() const { return {m_body.pos_mm, m_body.velocity_mm_s, m_fixed, m_held}; }
  void restore(Shape shape);

 private:
  NodeSet rim() const;
  void move_by_springs(const MeshMove& move, const HeldMesh& held, MeshMoveReport& report,
                       Progress* progress);
  void warn_of(const MeshMoveReport& report, const MeshMove& move, Progress* progress) const;

  MeshSetup m_setup;
  MeshBody m_body;
  NodeSet m_fixed, m_held;  // anchors, and what handles hold
};

}  // namespace supple
