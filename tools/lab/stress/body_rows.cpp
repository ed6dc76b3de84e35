#include <algorithm>
#include <cmath>

#include "lib/springs/lattice_springs.h"
#include "lib/springs/stability.h"
#include "tools/lab/stress/stress_rows.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/run/scene_run.h"

#ifdef SUPPLE_HAS_REFERENCE
#include "lib/chainmail/reference/original_chainmail.h"
#endif

namespace supple::tools {

namespace {

/// Offsets are stored in steps of 2^-16 voxel.
constexpr double kOffsetStep = 2.0 / 65536;
/// Bound on ways in ways of the handle: rounding adds to those of elements that go all of it.
constexpr double kWholeWay = 1.0001;

/// The scene of the input, run.
class RunScene {
 public:
  RunScene(const StressInput& input, const std::string& folder, bool has_view, Console& console)
      : m_scene(read_scene(write_input(input, folder, has_view))),
        m_run(m_scene, folder, false, console) {
    m_run.check_steps();
    m_run.run();
  }
  const Session& session() const { return *m_run.session(); }
  const StepRecord& first() const { return session().records().front(); }

 private:
  Scene m_scene;
  SceneRun m_run;
};

Vec3d offset_of(const Body& body, const Vec3i& voxel) {
  return Vec3d(body.offset(voxel, 0), body.offset(voxel, 1), body.offset(voxel, 2)) / kFixedOne;
}

double largest_of(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Measures how far elements went, in mm along the grid axes, of the handle's way; whether the
/// handle is where it was taken, after `part` of its way, and what is fixed where it was.
void measure_places(const StressInput& input, const Body& body, double part, double most,
                    MeasuredValues& all) {
  const Vec3d spacing = body.geometry.spacing_mm();
  double farthest_mm = 0, fixed_voxels = 0;
  for_each_voxel(body.elements, [&](const Vec3i& voxel) {
    const Vec3d u = offset_of(body, voxel);
    farthest_mm = std::max(farthest_mm, (u * spacing).length());
    if (input.is_fixed(voxel)) fixed_voxels = std::max(fixed_voxels, largest_of(u));
  });
  const Vec3d missed = offset_of(body, input.grabbed) - input.by_voxels * part;
  all.push_back(
      {"farthest element, of the handle's way", farthest_mm / input.by_mm().length(), 0, most});
  all.push_back({"handle off its place, voxels", largest_of(missed), 0, kOffsetStep});
  all.push_back({"fixed elements moved, voxels", fixed_voxels, 0, 0});
}

/// Counts links beyond their limits; checks that a result other than what was asked for was told.
void measure_links(const Session& session, bool must_hold, bool is_all, MeasuredValues& all) {
  const double violated = double(check_links(session.body()).violated);
  if (must_hold) all.push_back({"links beyond their limits", violated, 0, 0});
  const bool is_told = !session.messages().empty();
  const bool is_as_asked = is_all && violated == 0;
  all.push_back({"shortfalls that were not told", is_as_asked || is_told ? 0.0 : 1.0, 0, 0});
}

}  // namespace

void run_ecm(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all) {
  const RunScene run(input, folder, false, console);
  const double part = run.first().report.fraction();
  all.push_back({"part of the drag", part, 0, 1});
  measure_places(input, run.session().body(), part, kWholeWay, all);
  measure_links(run.session(), true, part == 1, all);
}

void run_ball(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all) {
  const RunScene run(input, folder, false, console);
  measure_places(input, run.session().body(), 1, 1.01, all);
  const BallReport& report = run.first().ball.value();
  const bool is_told = !run.session().messages().empty();
  const bool is_all = report.violated == 0 && !report.capped;
  all.push_back({"shortfalls that were not told", is_all || is_told ? 0.0 : 1.0, 0, 0});
  all.push_back({"worst link too long, rest lengths", report.worst_excess_voxels, 0,
                 is_all ? 1e-3 : input.by_mm().length() / 1e-3});
}

void run_relaxed(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all) {
  const RunScene run(input, folder, false, console);
  const StepRecord& first = run.first();
  const double part = first.report.fraction();
  measure_places(input, run.session().body(), part, 1.5, all);
  measure_links(run.session(), true, part == 1, all);
  const double before = first.relaxed.energy_before;
  all.push_back({"energy after, µJ", first.relaxed.energy_after, 0, before * (1 + 1e-9)});
  if (!first.relaxed.volumes_after) return;
  all.push_back({"smallest cell, of its volume", first.relaxed.volumes_after->smallest, 0.01, 100});
}

void run_springs_at_rest(const StressInput& input, const std::string& folder, Console& console,
                         MeasuredValues& all) {
  const RunScene run(input, folder, false, console);
  measure_places(input, run.session().body(), 1, 1.5, all);
  measure_links(run.session(), false, true, all);
  const SpringRecord& record = run.first().sprung;
  const bool is_told = !run.session().messages().empty();
  const double residual = record.residual_mn.value_or(-1);
  const double tolerance = run.first().springs->motion.tolerance_mn;
  all.push_back({"elastic energy, J", record.after.elastic_j, 0, 1e300});
  all.push_back({"force left, mN", residual, 0, is_told ? 1e300 : tolerance});
}

namespace {

/// Longest stable step in s; 10 ms where nothing can swing.
double stable_step_of(const StressInput& input, const std::string& folder, Console& console) {
  const Scene scene = read_scene(write_input(input, folder, false));
  const Session session(scene.volume_path, {scene.material}, &console);
  const LatticeSprings springs = make_springs(session.body(), material_springs(session.body()));
  const double stable = stable_step_s(spectral_bounds(springs.system));
  return std::isfinite(stable) ? stable : 0.01;
}

/// Sets a spring step, and a time of 10 of the longest stable steps, in 10 to 1000 steps.
void choose_spring_steps(StressInput& input, double stable_s) {
  const double step_s = input.spring_step * stable_s;
  const double time_s = step_s * std::clamp(std::round(10 / input.spring_step), 10.0, 1000.0);
  const std::string springs = input.step.at("springs");
  const std::string keys = "{ step = " + exact_text(step_s) + ", time = " + exact_text(time_s) +
                           ", " + springs.substr(springs.find('{') + 1);
  input.step["springs"] = keys;
  input.later_steps = {{{"model", "\"springs\""}, {"springs", keys}}};
}

}  // namespace

void run_springs(const StressInput& given, const std::string& folder, Console& console,
                 MeasuredValues& all) {
  StressInput input = given;
  choose_spring_steps(input, stable_step_of(given, folder, console));
  const RunScene run(input, folder, false, console);
  measure_places(input, run.session().body(), 1, 3, all);
  measure_links(run.session(), false, true, all);
  const double moved_j = run.first().sprung.after.total_j();
  const double held_j = run.session().records().back().sprung.after.total_j();
  const bool is_symplectic =
      run.first().springs->motion.method == SpringMethod::symplectic;  // swings about its energy
  all.push_back({"energy once moved, J", moved_j, 0, 1e300});
  all.push_back({"energy later, of it", moved_j > 0 ? held_j / moved_j : held_j, 0,
                 is_symplectic ? 2 : 1 + 1e-6});
}

void run_fem(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all) {
  const RunScene run(input, folder, false, console);
  measure_places(input, run.session().body(), 1, 2, all);
  measure_links(run.session(), false, true, all);
  const FemReport& report = run.first().equilibrium.report;
  all.push_back({"force left, of the largest", report.residual_max, 0, 1e-5});
  all.push_back({"balance of forces", report.force_balance, 0, 1e-4});
  all.push_back({"energy identity", report.energy_identity, 0, 1e-3});
  all.push_back({"energy, mJ", report.energy_mj, 0, 1e300});
  if (!report.newton) return;
  all.push_back({"smallest det F", report.newton->smallest_j, 1e-6, 1e6});
}

void run_inverse(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all) {
  const Scene scene = read_scene(write_input(input, folder, false));
  Session session(scene.volume_path, {scene.material}, &console);
  session.step(scene.steps.front(), &console);
  const Pose& pose = session.pose(&console);
  const InversionCertificate& certificate = pose.offsets.certificate;
  all.push_back({"largest residual, voxels", certificate.residual_max, 0, 1e-3});
  all.push_back({"voxels without solution", double(certificate.unresolved_voxels), 0, 0});
  const bool may_fold = !check_links(session.body()).fold_free;
  const double tissue_folds = double(certificate.folded_cells - certificate.folded_air_cells);
  all.push_back({"folded cells of tissue", tissue_folds, 0, may_fold ? 1e12 : 0});
  if (may_fold) return;
  all.push_back({"smallest det F", certificate.min_det, 1e-9, 1e9});
}

void run_original(const StressInput& input, const std::string& folder, Console& console,
                  MeasuredValues& all) {
#ifdef SUPPLE_HAS_REFERENCE
  const Scene scene = read_scene(write_input(input, folder, false));
  const Session session(scene.volume_path, {scene.material}, &console);
  session.places(scene.steps.front());
  std::array<std::int32_t, 3> by_q{};
  for (int c = 0; c < 3; ++c) {
    const double q = std::round(input.by_voxels[c] * kFixedOne);
    if (std::abs(q) > kMaxOffset) {
      throw InputError({"by", "", number_text(input.by_voxels[c]) + " voxels",
                        "at most " + number_text(std::floor(kMaxOffset / kFixedOne))});
    }
    by_q[c] = std::int32_t(q);
  }
  const Body moved = reference::original_chainmail(session.body(), input.grabbed, by_q);
  StressInput free = input;
  free.fixed.reset();
  measure_places(free, moved, 1, kWholeWay, all);
  all.push_back({"links beyond their limits", double(check_links(moved).violated), 0, 0});
#else
  static_cast<void>(input), static_cast<void>(folder), static_cast<void>(console);
  static_cast<void>(all);
  throw InputError({"original", "", "a build without it", "one with SUPPLE_BENCH"});
#endif
}

}  // namespace supple::tools
