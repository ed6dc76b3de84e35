#include "lib/fem/dynamics/modes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Spectra/SymGEigsShiftSolver.h>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/dynamics/rigid_motions.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Part of the largest force that a solution may leave. Lanczos' vectors are no more exact.
constexpr double kSolveTolerance = 1e-9;
/// Error of a Ritz vector, relative to its eigenvalue; the second one where only the eigenvalue is
/// asked for, whose error is the square.
constexpr double kLanczosTolerance = 1e-9, kCheckTolerance = 1e-3;
constexpr int kMaxRestarts = 300;
constexpr Eigen::Index kLeastVectors = 20, kCheckVectors = 10;
/// Modes closer than this are alike.
constexpr double kAlike = 1e-6;
/// The shift of a body that nothing holds, of the least Rayleigh quotient of its even strains.
constexpr double kShiftPart = 1e-3;

using Vector = Eigen::VectorXd;

void clear_held_components(const HeldBits& held, double* x) {
  for_ranges(3 * held.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if ((held[n / 3] >> n % 3 & 1) != 0) x[n] = 0;
    }
  });
}

/// M between vectors whose held components are 0, as Spectra wants it.
class FreeMass {
 public:
  using Scalar = double;

  FreeMass(const MassMatrix& mass, const HeldBits& held) : m_mass(&mass), m_held(&held) {}

  Eigen::Index rows() const { return 3 * Eigen::Index(m_held->size()); }
  Eigen::Index cols() const { return rows(); }
  void perform_op(const double* x, double* y) const {
    std::vector<double> free(x, x + rows());
    clear_held_components(*m_held, free.data());
    std::fill_n(y, rows(), 0.0);
    m_mass->add(free.data(), y);
    clear_held_components(*m_held, y);
  }
  double product(const double* x, const double* y) const {
    std::vector<double> forces(3 * m_held->size());
    perform_op(y, forces.data());
    return dot(x, forces.data(), forces.size());
  }

 private:
  const MassMatrix* m_mass;
  const HeldBits* m_held;
};

/// A body whose modes are computed, with its masses and its equations.
struct Vibration {
  const ElasticSolid& solid;
  HeldBits held;
  MassMatrix mass_matrix;
  FreeMass mass;
  std::optional<RigidMotions> rigid;  // of a body that nothing holds
  double shift_per_s2 = 0;
  std::unique_ptr<LinearSystem> system;  // K + s M
  ModesReport& report;

  Vibration(const ElasticSolid& of, const MassDensities& density, HeldBits held_bits,
            ModesReport& report_of, Progress* progress)
      : solid(of),
        held(std::move(held_bits)),
        mass_matrix(of, density),
        mass(mass_matrix, held),
        report(report_of) {
    const bool is_free = std::all_of(held.begin(), held.end(), [](auto bits) { return bits == 0; });
    if (is_free) {
      rigid.emplace(solid, mass_matrix);
      report.rigid_modes = rigid->count();
      shift_per_s2 = kShiftPart * least_quotient_of_strains();
      const ElementWeights shifted{density, even_parts(1), shift_per_s2};
      system = solid.system(&shifted, held, progress);
    } else {
      system = solid.system(nullptr, held, progress);
    }
    report.levels = system->level_count();
  }
  Vibration(const Vibration&) = delete;
  Vibration& operator=(const Vibration&) = delete;

  std::size_t size() const { return 3 * held.size(); }
  /// Values of nodes that have displacements; turns follow.
  std::size_t displacements() const { return size() - 3 * solid.turn_axes().size(); }

  /// K u.
  void apply(const std::vector<double>& u, std::vector<double>& forces) const {
    forces.assign(u.size(), 0.0);
    solid.matrix().add(u.data(), forces.data());
  }

  /// x^T K x / x^T M x of the even stretches along the axes, without rigid motions.
  double least_quotient_of_strains() const {
    const std::vector<Vec3d> positions = solid.node_positions();
    const std::size_t places = displacements() / 3;
    double least = 0;
    std::vector<double> u(size()), scratch, forces;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill(u.begin(), u.end(), 0.0);
      for (std::size_t n = 0; n < places; ++n) {
        u[3 * n + std::size_t(axis)] = positions[n][axis];
      }
      rigid->remove_from(u.data(), scratch);
      apply(u, forces);
      const double quotient =
          dot(u.data(), forces.data(), size()) / mass.product(u.data(), u.data());
      if (axis == 0 || quotient < least) least = quotient;
    }
    return least;
  }
};

/// (K + s M)^-1, without the rigid motions and without modes that are known.
class ShiftedInverse {
 public:
  using Scalar = double;

  ShiftedInverse(Vibration& of, const std::vector<VibrationMode>& known, const ModeParams& params,
                 double expected, Progress* progress)
      : m_of(&of),
        m_known(&known),
        m_params(&params),
        m_expected(of.report.solutions + expected),
        m_progress(progress) {}

  Eigen::Index rows() const { return Eigen::Index(m_of->size()); }
  Eigen::Index cols() const { return rows(); }
  void set_shift(double) {}

  void perform_op(const double* force, double* y) const {
    NodalLoads loads;
    loads.held = m_of->held;
    loads.u_mm.assign(m_of->size(), 0.0);
    loads.force_mn.assign(force, force + m_of->size());
    clear_held_components(m_of->held, loads.force_mn.data());
    // Reactions do not count.
    ConjugateGradients solver(*m_of->system, loads,
                              {kSolveTolerance, 1e300, m_params->max_iterations});
    const bool converged = solver.run(m_progress);
    ModesReport& report = m_of->report;
    ++report.solutions;
    // A solver that begins once solves for as many vectors as it has.
    supple::report(m_progress, std::min(1.0, double(report.solutions) / m_expected));
    report.iterations += solver.iterations();
    report.bytes = std::max(report.bytes, solver.bytes());
    if (!converged) throw NotConverged(as_fem_report(solver));
    std::copy(solver.u().begin(), solver.u().end(), y);
    if (m_of->rigid) m_of->rigid->remove_from(y, m_scratch);
    take_known_out_of(y);
  }

  void take_known_out_of(double* y) const {
    if (m_known->empty()) return;
    m_scratch.resize(m_of->size());
    m_of->mass.perform_op(y, m_scratch.data());
    for (const VibrationMode& mode : *m_known) {
      const double part = dot(mode.shape.data(), m_scratch.data(), m_of->size());
      for_ranges(m_of->size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) y[n] -= part * mode.shape[n];
      });
    }
  }

 private:
  FemReport as_fem_report(const ConjugateGradients& solver) const {
    FemReport report;
    report.unknowns = m_of->report.unknowns;
    report.iterations = solver.iterations();
    report.residual_max = solver.size().max;
    report.residual_rms = solver.size().rms;
    return report;
  }

  Vibration* m_of;
  const std::vector<VibrationMode>* m_known;
  const ModeParams* m_params;
  double m_expected;  // solutions, these and earlier ones
  Progress* m_progress;
  mutable std::vector<double> m_scratch;
};

/// A vector without structure, the same on every machine.
Vector start_vector(const HeldBits& held, std::uint32_t seed) {
  Vector x(3 * Eigen::Index(held.size()));
  for (Eigen::Index n = 0; n < x.size(); ++n) {
    seed = seed * 1664525u + 1013904223u;
    x[n] = double(seed >> 8) / double(1 << 24) - 0.5;
  }
  clear_held_components(held, x.data());
  return x;
}

/// phi^T K phi / phi^T M phi and what is left of the equation, phi of norm 1 in M.
VibrationMode mode_of_shape(const Vibration& of, Vector shape) {
  VibrationMode mode;
  clear_held_components(of.held, shape.data());
  std::vector<double> inertia(of.size()), forces;
  const double norm = std::sqrt(of.mass.product(shape.data(), shape.data()));
  Eigen::Index largest;
  shape.cwiseAbs().maxCoeff(&largest);
  shape /= shape[largest] < 0 ? -norm : norm;
  mode.shape.assign(shape.data(), shape.data() + shape.size());
  of.mass.perform_op(mode.shape.data(), inertia.data());
  of.apply(mode.shape, forces);
  clear_held_components(of.held, forces.data());
  mode.eigenvalue_per_s2 = dot(mode.shape.data(), forces.data(), of.size());
  mode.frequency_hz = std::sqrt(std::max(mode.eigenvalue_per_s2, 0.0)) / (2 * kPi);
  double left = 0, all = 0;
  for (std::size_t n = 0; n < of.size(); ++n) {
    const double rest = forces[n] - mode.eigenvalue_per_s2 * inertia[n];
    left += rest * rest;
    all += forces[n] * forces[n];
  }
  mode.residual = all > 0 ? std::sqrt(left / all) : 0;
  return mode;
}

/// The lowest modes beside those that are known.
std::vector<VibrationMode> find_modes(Vibration& of, const std::vector<VibrationMode>& known,
                                      int count, double tolerance, std::int64_t free_dimensions,
                                      const ModeParams& params, Progress* progress) {
  const Eigen::Index vectors =
      std::min(Eigen::Index(free_dimensions),
               count == 1 ? kCheckVectors : std::max<Eigen::Index>(kLeastVectors, 2 * count + 1));
  ShiftedInverse inverse(of, known, params, double(vectors), progress);
  Spectra::SymGEigsShiftSolver<ShiftedInverse, FreeMass, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, of.mass, count, vectors, -of.shift_per_s2);
  Vector start = start_vector(of.held, std::uint32_t(known.size()) + 1);
  solver.init(start.data());
  solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, tolerance,
                 Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful) {
    throw Error("modes did not converge: " + std::to_string(solver.eigenvalues().size()) + " of " +
                std::to_string(count) + " after " + std::to_string(of.report.solutions) +
                " solutions");
  }
  of.report.bytes += std::size_t(vectors + count) * of.size() * sizeof(double);
  const Eigen::MatrixXd shapes = solver.eigenvectors();
  std::vector<VibrationMode> modes;
  for (Eigen::Index n = 0; n < shapes.cols(); ++n) {
    modes.push_back(mode_of_shape(of, shapes.col(n)));
  }
  return modes;
}

void sort_modes(std::vector<VibrationMode>& modes) {
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.eigenvalue_per_s2 < b.eigenvalue_per_s2;
  });
}

/// Takes in what is lower than the last of the modes and was not found with them.
void find_late_modes(Vibration& of, std::int64_t free_dimensions, const ModeParams& params,
                     Progress* progress, std::vector<VibrationMode>& modes) {
  const std::size_t count = modes.size();
  while (true) {
    const double last = modes[count - 1].eigenvalue_per_s2;
    const std::int64_t rest = free_dimensions - std::int64_t(modes.size());
    if (rest < 2) return;
    const VibrationMode lowest =
        find_modes(of, modes, 1, kCheckTolerance, rest, params, progress).front();
    if (lowest.eigenvalue_per_s2 >= last * (1 - kAlike)) return;
    modes.push_back(find_modes(of, modes, 1, kLanczosTolerance, rest, params, progress).front());
    sort_modes(modes);
    ++of.report.late_modes;
  }
}

void tell_participation(const Vibration& of, std::vector<VibrationMode>& modes) {
  const std::size_t displacements = of.displacements();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along(of.size(), 0.0);
    for (std::size_t n = std::size_t(axis); n < displacements; n += 3) along[n] = 1;
    const std::vector<double> inertia = of.mass_matrix.times(along);
    of.report.mass_kg = dot(along.data(), inertia.data(), of.size());
    for (VibrationMode& mode : modes) {
      mode.participation_kg_half[axis] = dot(mode.shape.data(), inertia.data(), of.size());
    }
  }
}

double largest_overlap(const Vibration& of, const std::vector<VibrationMode>& modes) {
  double most = 0;
  std::vector<double> inertia(of.size());
  for (std::size_t a = 0; a < modes.size(); ++a) {
    of.mass.perform_op(modes[a].shape.data(), inertia.data());
    for (std::size_t b = 0; b <= a; ++b) {
      const double product = dot(modes[b].shape.data(), inertia.data(), of.size());
      most = std::max(most, std::abs(product - (a == b ? 1 : 0)));
    }
  }
  return most;
}

/// Loose islands are held as well; not where nothing is held.
void hold_islands(const ElasticSolid& solid, LooseIslands loose, HeldBits& held,
                  ModesReport& report) {
  const bool is_held = std::any_of(held.begin(), held.end(), [](auto of) { return of != 0; });
  const LooseCount count = solid.hold_loose(is_held && loose == LooseIslands::hold, held);
  report.islands = count.islands;
  report.loose_islands = count.loose_islands;
  report.loose_elements = count.loose_elements;
  if (is_held && count.loose_islands > 0 && loose == LooseIslands::refuse) {
    throw InputError({"", "modes",
                      std::to_string(count.loose_islands) + " pieces of " +
                          std::to_string(count.loose_elements) + " elements that nothing holds",
                      "every piece held so that it cannot move as a rigid body"});
  }
}

}  // namespace

void ModeParams::validate() const {
  if (count < 1) throw InputError({"", "count", std::to_string(count), "at least 1"});
  if (!(tolerance > 0 && tolerance < 1)) {
    throw InputError({"", "tolerance", number_text(tolerance), "between 0 and 1"});
  }
  if (max_iterations < 1) {
    throw InputError({"", "max_iterations", std::to_string(max_iterations), "at least 1"});
  }
}

VibrationModes lowest_modes(const ElasticSolid& solid, const MassDensities& density, HeldBits held,
                            const ModeParams& params, Progress* progress) {
  params.validate();
  const Stopwatch clock;
  VibrationModes out;
  ModesReport& report = out.report;
  report.elements = solid.element_count();
  report.nodes = solid.node_count();
  hold_islands(solid, params.loose, held, report);
  for (const std::uint8_t of : held) report.unknowns += 3 - __builtin_popcount(of);
  Vibration vibration(solid, density, std::move(held), report, progress);
  stage(progress, "modes");
  const std::int64_t free_dimensions = report.unknowns - report.rigid_modes;
  if (2 * params.count > free_dimensions) {
    throw InputError({"", "count", std::to_string(params.count),
                      "at most " + std::to_string(free_dimensions / 2) +
                          ", half of the ways in which the body can move"});
  }
  out.modes =
      find_modes(vibration, {}, params.count, kLanczosTolerance, free_dimensions, params, progress);
  sort_modes(out.modes);
  find_late_modes(vibration, free_dimensions, params, progress, out.modes);
  out.modes.resize(std::size_t(params.count));
  tell_participation(vibration, out.modes);
  for (const VibrationMode& mode : out.modes) {
    report.largest_residual = std::max(report.largest_residual, mode.residual);
  }
  if (report.largest_residual > params.tolerance) {
    throw Error("modes did not converge: residual " + number_text(report.largest_residual) +
                " after " + std::to_string(report.solutions) + " solutions");
  }
  report.orthogonality = largest_overlap(vibration, out.modes);
  report.bytes += solid.bytes() + vibration.mass_matrix.bytes() + vibration.system->bytes() +
                  (vibration.rigid ? vibration.rigid->bytes() : 0);
  report.milliseconds = clock.ms();
  return out;
}

}  // namespace supple
