// Membranes under instruments: triangle meshes of springs that cling to what lies under them, are
// gripped, peeled and torn (thesis section 6.1.2, eq. 6.1 with its misprint corrected:
// F = k (|x| - R) along the spring).
//
// Time goes on in substeps of a fixed length (XPBD, lib/springs/xpbd.h has the formulas), so that
// nothing that breaks depends on the length of a step. Links of adhesion and edges break by force,
// never by length.
//
// Nodes are at least so heavy that the sweeps of a substep solve their springs (sheet.cpp), heavier
// than the sheet itself where sweeps are few: quick motions then meet more inertia. A peeling force
// is the adhesion's energy per area times the width where the pull is slow and where links reach
// over several rows: with a reach of 3, 4 and 5 rows the mean force was 7.6, 3.6 and 1.6 % above it
// (strip of 3 cells at 90 degrees, 20 rows); links that reach less far peel harder.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/instruments/instrument.h"
#include "lib/instruments/tool_contact.h"
#include "lib/mesh/mesh_body.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

enum class MembraneModel { springs, ecm };

struct MembraneParams {
  MembraneModel model = MembraneModel::springs;
  double stiffness_n_m = 20;    // of the sheet: Young's modulus times thickness
  double bending_n_m = 0;       // of springs across edges; 0: none
  double density_kg_m2 = 0.02;  // mass per area, at least
  double damping_per_s = 5;     // of the fluid around it (Rayleigh's alpha)
  double adhesion_j_m2 = 0.05;  // energy that frees an area; 0: none
  double adhesion_mm = 0.05;    // stretch at which a link of adhesion breaks
  double strength_n_m = 20;     // tension along which edges tear; 0: it does not tear
  double friction = 0.1;        // against instruments and what lies under it
  double substep_s = 0.002;
  int sweeps = 2;
  double thickness_mm = 0.02;        // distance that it keeps
  double smallest_piece_mm2 = 0.05;  // torn-off pieces below this area vanish
};
/// Keys of a [[body]] of kind "membrane".
Fields fields(MembraneParams& params);

struct MembraneEvent {
  enum class Kind { link_broken, edge_torn, gripped, released, piece_lost } kind;
  std::int64_t count = 0;   // of links, edges, nodes, triangles
  int tool = -1;            // that grips or releases
  Vec3d place_mm{0, 0, 0};  // middle of them
};

struct MembraneReport {
  std::vector<MembraneEvent> events;
  std::vector<Vec3d> tool_forces_n;  // per ToolMotion: with which the membrane pulls at it
  int contacts = 0, pinched = 0;     // nodes that touch; that two things press at once
  double longest_stretch = 1;        // of an edge, times its length at rest
  int inverted = 0;                  // triangles that face against those beside them
};

/// Energies in J.
struct MembraneEnergy {
  double springs_j = 0, kinetic_j = 0, adhesion_j = 0;
  double total_j() const { return springs_j + kinetic_j + adhesion_j; }
};

class Membrane {
 public:
  /// A membrane at rest that lies on `under` (empty: on nothing); its nodes cling to the nearest
  /// surface within 3 times its thickness. Throws InputError: a mesh that is no manifold with
  /// boundary, parameters out of range.
  Membrane(const TriangleMesh& mesh, const MembraneParams& params, std::vector<Obstacle> under,
           std::string name);
  ~Membrane();
  Membrane(Membrane&&) noexcept;

  /// Moves it by `dt_s`, a whole number of substeps, while the tools go from their poses to the
  /// next ones. `instruments` by ToolMotion::tool. Same bits for the same input.
  MembraneReport step(double dt_s, const std::vector<ToolMotion>& tools,
                      const std::vector<Instrument>& instruments);
  /// Exchanges the model; shape, links and grips stay.
  void take_model(MembraneModel model);

  const std::string& name() const;
  /// Nodes and triangles as they are: torn edges have nodes of their own.
  const MeshBody& body() const;
  /// Node pairs, triangles and so on change where this number does.
  std::int64_t topology_version() const;
  const std::vector<char>& clings() const;  // per node
  std::vector<int> gripped(int tool) const;
  double clinging_mm2() const;
  double torn_mm() const;  // length of torn edges at rest
  MembraneEnergy energy() const;
  /// All that the next step depends on, as bytes for a digest.
  std::string state_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Circular sheet on a sphere about the direction `middle`, which faces the centre: nearly equal
/// triangles between rings of at least `nodes` nodes, the last of which are the rim.
TriangleMesh membrane_on_sphere(const Vec3d& centre_mm, double radius_mm, const Vec3d& middle,
                                double sheet_radius_mm, int nodes);

}  // namespace supple
