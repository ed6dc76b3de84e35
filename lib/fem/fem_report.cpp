#include "lib/fem/fem_report.h"

#include <cmath>
#include <limits>

#include "lib/fem/fem_solution.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

std::string not_converged_text(const FemReport& report) {
  std::string text = "finite elements did not converge";
  if (report.newton) {
    const NewtonReport& newton = *report.newton;
    text += " beyond " + number_text(100 * newton.load_part) + " % of the load (" +
            std::to_string(newton.load_steps) + " steps, " + std::to_string(newton.rejected_steps) +
            " given up, " + std::to_string(newton.newton_iterations) +
            " corrections, smallest det F " + number_text(newton.smallest_j) + ")";
  }
  text += ": residual " + number_text(report.residual_max) + " of the largest nodal force (rms " +
          number_text(report.residual_rms) + "), reactions changed by " +
          number_text(report.reaction_change) + " after " + std::to_string(report.iterations) +
          " iterations, " + std::to_string(report.unknowns) + " unknowns";
  if (report.error_mm) {
    text += ", an estimated error of " + number_text(*report.error_mm) + " mm left";
  }
  return text;
}

}  // namespace

void FemParams::set_accuracy(FemAccuracy chosen) {
  accuracy = chosen;
  tolerance.reset();
  reaction_tolerance.reset();
  error_mm.reset();
}

double FemParams::residual_limit() const {
  const bool is_picture = accuracy == FemAccuracy::picture;
  return tolerance.value_or(error_mm ? kNoLimit : is_picture ? kPictureTolerance : kExactTolerance);
}

double FemParams::reaction_limit() const {
  const bool is_picture = accuracy == FemAccuracy::picture;
  return reaction_tolerance.value_or(error_mm     ? kReactionsBesideError
                                     : is_picture ? kPictureTolerance
                                                  : kExactReactions);
}

double FemParams::error_limit_mm() const {
  return error_mm.value_or(kNoLimit);
}

void FemParams::validate() const {
  if (tolerance) {
    require(*tolerance > 0 && *tolerance < 1, "tolerance", *tolerance, "between 0 and 1");
  }
  require(reaction_limit() > 0, "reaction_tolerance", reaction_limit(), "above 0");
  require(error_limit_mm() > 0, "error_mm", error_limit_mm(), "above 0 mm");
  if (error_mm && !can_end_by_error()) {
    throw InputError({"", "error_mm", "an error beside finite strain, coarsen or another program",
                      "tolerance, or none of these"});
  }
  require(max_iterations > 0, "max_iterations", max_iterations, "at least 1");
  require(doublings >= 0 && doublings <= kMostDoublings, "coarsen", doublings, "0 to 3");
  require(doublings == 0 || strain == StrainTheory::linear, "coarsen", doublings,
          "0 at finite strain");
  const bool is_plain = doublings == 0 && strain == StrainTheory::linear;
  if (solver != EquationSolver::multigrid && !is_plain) {
    throw InputError(
        {"", "solver", "another program at finite strain or with coarsen", "multigrid"});
  }
  require(max_rotation_deg > 0, "max_rotation_deg", max_rotation_deg, "above 0");
  require(max_strain > 0, "max_strain", max_strain, "above 0");
}

NotConverged::NotConverged(const FemReport& report)
    : Error(not_converged_text(report)), m_report(report) {}

void note(const ResidualSize& size, FemReport& report) {
  report.residual_max = size.max;
  report.residual_rms = size.rms;
  report.largest_force_n = size.largest_force_mn * kNPerMn;
  report.reaction_change = size.reaction_change;
}

MotionLimits limits_of(const FemParams& params) {
  return {params.max_rotation_deg, params.max_strain};
}

void note(const LargestMotion& largest, FemReport& report) {
  report.largest_rotation_deg = largest.rotation_deg;
  report.largest_strain = largest.strain;
  report.turned = largest.turned;
  report.strained = largest.strained;
  report.beyond_elements = largest.beyond;
  report.smallest_det_f = largest.smallest_det_f;
}

void balance(const NodalLoads& loads, const std::vector<double>& u, const std::vector<double>& r,
             double least_force_mn, FemReport& report) {
  Vec3d sum(0);
  double lengths = least_force_mn, energy = 0, work_of_residual = 0, farthest_mm = 0;
  for (std::size_t n = 0; n < loads.held.size(); ++n) {
    Vec3d held(0), load(0);
    for (int a = 0; a < 3; ++a) {
      const std::size_t at = 3 * n + std::size_t(a);
      if (!loads.force_mn.empty()) load[a] = loads.force_mn[at];
      energy += u[at] * (load[a] - r[at]);
      farthest_mm = std::max(farthest_mm, std::abs(u[at]));
      if ((loads.held[n] >> a & 1) != 0) {
        held[a] = -r[at];
      } else {
        work_of_residual += u[at] * r[at];
      }
    }
    sum += held + load;
    lengths += held.length() + load.length();
  }
  report.energy_mj = energy / 2 * kMjPerUj;
  report.force_balance = lengths > 0 ? sum.length() / lengths : 0;
  const double least_energy = std::max(std::abs(energy), least_force_mn * farthest_mm);
  report.energy_identity = least_energy > 0 ? std::abs(work_of_residual) / least_energy : 0;
}

namespace {

/// The force in N with which the body pulls at what holds the n-th node of a set.
Vec3d pull_of_node(const NodalLoads& loads, std::size_t held, std::size_t n,
                   const std::vector<double>& r) {
  const NodeIndex node = loads.nodes_of[held][n];
  Vec3d force(0);
  for (int a = 0; a < 3; ++a) {
    if ((loads.held[node] >> a & 1) == 0) continue;
    force[a] = r[3 * std::size_t(node) + std::size_t(a)] * loads.share(held, n) * kNPerMn;
  }
  return force;
}

}  // namespace

Vec3d pull_n(const NodalLoads& loads, std::size_t held, const std::vector<double>& r) {
  Vec3d sum(0);
  for (std::size_t n = 0; n < loads.nodes_of[held].size(); ++n) {
    sum += pull_of_node(loads, held, n, r);
  }
  return sum;
}

std::vector<FemReaction> reactions_of(const ElasticSolid& solid, const NodalLoads& loads,
                                      const std::vector<double>& r,
                                      const std::vector<double>* u_mm) {
  std::vector<FemReaction> out;
  for (std::size_t held = 0; held < loads.nodes_of.size(); ++held) {
    const std::vector<NodeIndex>& nodes = loads.nodes_of[held];
    std::vector<Vec3d> positions = solid.node_positions(nodes);
    FemReaction reaction;
    reaction.nodes = std::int64_t(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (u_mm != nullptr) {
        const double* u = &(*u_mm)[3 * std::size_t(nodes[n])];
        positions[n] += Vec3d(u[0], u[1], u[2]);
      }
      reaction.centre_mm += positions[n];
    }
    if (!nodes.empty()) reaction.centre_mm /= double(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vec3d force = pull_of_node(loads, held, n, r);
      reaction.force_n += force;
      reaction.moment_nmm += (positions[n] - reaction.centre_mm).cross(force);
    }
    out.push_back(reaction);
  }
  return out;
}

}  // namespace supple
