// Parameters of solutions by finite elements, and the reports that they give of themselves: of
// equilibria, of modes of vibration and of motions in time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volumes/base/error.h"
#include "volumes/base/vec.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

/// Small displacements, of which forces are linear; or any (neo-Hookean, voxel/finite_strain.h).
enum class StrainTheory { linear, finite };

/// The volumetric strain of an element: its mean, or that of each point of integration.
enum class Dilatation { mean, pointwise };
/// Elements that touch by an edge or a corner alone: with nodes of their own, or with shared ones.
enum class Touching { apart, joined };

/// Conventions by which programs make elements of voxels.
struct ElementChoice {
  Dilatation dilatation = Dilatation::mean;
  Touching touching = Touching::apart;

  ElementChoice() = default;
  ElementChoice(Dilatation of, Touching by = Touching::apart) : dilatation(of), touching(by) {}
};

/// Treatment of islands: pieces of the body whose rigid motions nothing prevents.
enum class LooseIslands {
  hold,   // their nodes stay where they are, and what acts on them is carried by what holds them
  refuse  // an error
};

struct LooseCount {
  std::int64_t islands = 0;        // in all
  std::int64_t loose_islands = 0;  // with fewer than six of the rigid motions prevented
  std::int64_t loose_elements = 0;
};

enum class FemQuantity {
  von_mises,    // kPa
  pressure,     // kPa, positive where it is compressed
  principal_1,  // kPa, the largest principal stress
  principal_2,
  principal_3,
  energy_density,  // kPa
  strain_1,        // the largest principal strain
  strain_3,        // the smallest
  volume_strain
};
constexpr std::array<std::pair<FemQuantity, std::string_view>, 9> kFemQuantities{
    {{FemQuantity::von_mises, "von_mises"},
     {FemQuantity::pressure, "pressure"},
     {FemQuantity::principal_1, "principal_1"},
     {FemQuantity::principal_2, "principal_2"},
     {FemQuantity::principal_3, "principal_3"},
     {FemQuantity::energy_density, "energy_density"},
     {FemQuantity::strain_1, "strain_1"},
     {FemQuantity::strain_3, "strain_3"},
     {FemQuantity::volume_strain, "volume_strain"}}};

/// Angles of rotation, and principal strains by their amount.
struct MotionLimits {
  double rotation_deg = 5, strain = 0.05;
};
/// The largest of all elements, where they are, and how many elements are beyond the limits.
struct LargestMotion {
  double rotation_deg = 0, strain = 0;
  Vec3i turned{0, 0, 0}, strained{0, 0, 0};  // voxels of the mesh
  std::int64_t beyond = 0;
  double smallest_det_f = 1;  // at the elements' centres

  /// Takes the larger one of two sets of elements, or of two times; of equal ones the first.
  void take(const LargestMotion& other);
};

/// Displacements in mm, LPS, three per node: of an equilibrium from which another goes on.
using NodeStart = std::vector<float>;

/// Displacements and velocities of nodes, three values each, LPS, of which the elements of a body
/// know the means alone.
struct FemNodes {
  std::vector<double> u_mm, v_mm_s;  // no velocities: at rest
  std::vector<Vec3d> elements_mm;    // where the body then had its elements
};

constexpr int kMostDoublings = 3;

/// Solver of the linear equations: the own multigrid, CalculiX's direct solver (SPOOLES), its
/// conjugate gradients with incomplete Cholesky factors, or DOLFINx with algebraic multigrid.
enum class EquationSolver { multigrid, calculix, calculix_iterative, dolfinx };

/// Purpose of a solution: places, to a small part of a voxel; numbers, to the rounding of states;
/// or a picture, which goes on from an earlier equilibrium of the body where there is one. Solvers
/// know the voxel by `error_mm` alone (solved_params() in lib/session); without it places are
/// numbers.
enum class FemAccuracy { voxel, exact, picture };
constexpr double kPictureTolerance = 0.1;  // of residual and reactions
constexpr double kExactTolerance = 1e-6, kExactReactions = 1e-5;
/// Reactions beside an error: while they change by more, displacements are still to come that their
/// own changes do not tell of (error_estimate.h).
constexpr double kReactionsBesideError = 0.02;

struct FemParams {
  FemAccuracy accuracy = FemAccuracy::exact;
  StrainTheory strain = StrainTheory::linear;
  ElementChoice elements;  // of models that are made for these parameters
  /// Ends when all of these hold: the residual, largest and rms over nodes, is at most `tolerance`
  /// of the largest nodal force (of loads, reactions included); the reactions changed by at most
  /// `reaction_tolerance`, relative, over the last iteration; the estimated error of displacements
  /// (error_estimate.h) is at most `error_mm`. Beside `error_mm` a residual that is not given
  /// counts for nothing and reactions count kReactionsBesideError; otherwise these are what
  /// `accuracy` stands for.
  std::optional<double> tolerance, reaction_tolerance;
  /// The error is for voxels in linear theory by the own solver.
  std::optional<double> error_mm;
  int max_iterations = 400;  // of each linear system
  /// Elements of 2^doublings voxels in each direction (coarse_elements.h); in linear theory.
  int doublings = 0;
  /// Others than the own one know linear theory without `doublings`; what they leave on nodes
  /// beyond `tolerance` is a warning.
  EquationSolver solver = EquationSolver::multigrid;
  LooseIslands loose = LooseIslands::hold;
  /// Bounds of linear theory; larger ones are flagged.
  double max_rotation_deg = 5;
  double max_strain = 0.05;

  /// Takes the accuracy, and none of the limits that were given.
  void set_accuracy(FemAccuracy chosen);
  /// The limits that hold; infinite: none.
  double residual_limit() const;
  double reaction_limit() const;
  double error_limit_mm() const;
  /// True for the equations that `error_mm` is for.
  bool can_end_by_error() const {
    return strain == StrainTheory::linear && doublings == 0 && solver == EquationSolver::multigrid;
  }
  /// Throws InputError.
  void validate() const;
};

/// Resultant force and moment with which the body pulls at one held set.
struct FemReaction {
  Vec3d force_n{0, 0, 0};     // LPS
  Vec3d moment_nmm{0, 0, 0};  // LPS, about `centre_mm`
  Vec3d centre_mm{0, 0, 0};  // mean position of the nodes: at rest, at finite strain where they are
  std::int64_t nodes = 0;
};

struct NewtonReport {
  int load_steps = 0, rejected_steps = 0;
  int newton_iterations = 0, shortened_steps = 0;  // the latter by the line search
  int cg_iterations = 0;
  double load_part = 0;  // for which equilibrium was found
  double smallest_j = 1;
  double energy_uj = 0;
  /// Largest residual of a node after each iteration of the last load step, mN.
  std::vector<double> residuals_mn;
};

/// A solution that is a sum of earlier ones (response/response_set.h).
struct ResponseReport {
  int used = 0, solved = 0;  // terms of the sum, and solutions that had to be found
  std::string changed;       // what made earlier ones useless, such as "other loads"; or empty
};

struct FemReport {
  std::int64_t elements = 0, nodes = 0, unknowns = 0;  // of elements of several voxels, too
  int levels = 0;
  int iterations = 0;
  double residual_max = 0, residual_rms = 0;  // relative to the largest nodal force
  double largest_force_n = 0;
  /// |sum of loads and reactions| relative to the sum of their lengths.
  double force_balance = 0;
  /// |u.K(u) - u.(f + r)| relative to u.K(u); r are the reactions.
  double energy_identity = 0;
  double energy_mj = 0;        // u.Ku / 2, or W(u)
  double reaction_change = 0;  // relative, over the last iteration
  /// Estimated 95th percentile of the error of the displacement of nodes that the iterations left;
  /// none: not by conjugate gradients on voxels in linear theory.
  std::optional<double> error_mm;
  std::int64_t loose_islands = 0, loose_elements = 0, islands = 0;
  double largest_rotation_deg = 0, largest_strain = 0;
  Vec3i turned{0, 0, 0}, strained{0, 0, 0};  // where, in voxels of the mesh
  std::int64_t beyond_elements = 0;          // that turn or strain by more than the bounds
  bool beyond_linear = false;                // never at finite strain
  double smallest_det_f = 1;                 // at the elements' centres, in linear theory, too
  double volume_change_ml = 0;               // of all elements together
  std::optional<NewtonReport> newton;        // at finite strain
  std::optional<ResponseReport> responses;   // of a solution that may be a sum
  std::size_t bytes = 0;                     // at the most, of the solver and its mesh
  double setup_ms = 0, solve_ms = 0;
};

/// The solver did not reach its tolerances; the message carries the numbers.
class NotConverged : public Error {
 public:
  explicit NotConverged(const FemReport& report);
  const FemReport& report() const { return m_report; }

 private:
  FemReport m_report;
};

/// Energies in mJ. `work` is that of loads and of what is held, `dissipated` what damping took,
/// since the motion began.
struct MotionEnergy {
  double elastic_mj = 0, kinetic_mj = 0, work_mj = 0, dissipated_mj = 0;
};

struct ModesReport {
  std::int64_t elements = 0, nodes = 0, unknowns = 0;
  int levels = 0;
  int solutions = 0, iterations = 0;  // of linear systems, and of conjugate gradients in all
  int late_modes = 0;                 // that only the search among the rest found
  std::int64_t islands = 0, loose_islands = 0, loose_elements = 0;
  std::int64_t rigid_modes = 0;  // left out
  double mass_kg = 0;            // of the whole mesh
  double largest_residual = 0;
  double orthogonality = 0;  // the largest entry of phi^T M phi - 1
  std::size_t bytes = 0;     // at the most, of the solver and its mesh
  double milliseconds = 0;
};

// Parts of a step of finite elements and of its record.

/// A value per element.
struct ElementValues {
  FemQuantity quantity = FemQuantity::von_mises;
  BrickTopology elements;         // of the body at that step
  std::vector<float> of_element;  // in the order of their bricks
};

/// Means over the elements of a label, volumes being alike.
struct StrainGauge {
  std::int32_t label = 0;
  std::int64_t elements = 0;
  std::array<double, kFemQuantities.size()> mean{};
};

struct ModeStep {
  int count = 10;
  int shape = 1;                       // which the body takes, the lowest is 1
  std::optional<double> amplitude_mm;  // of its largest displacement; none: default_amplitude_mm()
};

/// A mode without its shape at nodes.
struct ModeRow {
  double frequency_hz = 0, residual = 0;
  Vec3d participation_kg_half{0, 0, 0}, effective_mass_kg{0, 0, 0};
  /// Displacement of the elements' centres along LPS, the longest of length 1, in the order of the
  /// bricks.
  std::vector<Vec3f> shape;
};

struct ModesRecord {
  ModesReport report;
  std::vector<ModeRow> modes;  // ascending
  double amplitude_mm = 0;     // with which they are shown
};

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

/// A handle beside others, or beside what is held, that does not reach its place: offsets from rest
/// of its elements, in the mean.
struct SharedHandle {
  std::string name;
  Vec3d asked_mm{0, 0, 0}, reached_mm{0, 0, 0};  // LPS
  double off_voxels = 0;                         // of an element, at most
};

}  // namespace supple
