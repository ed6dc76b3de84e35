#include "tools/scene/plan/calibrate.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "lib/body/body_cost.h"
#include "lib/chainmail/ecm_cost.h"
#include "lib/fem/voxel/fem_cost.h"
#include "lib/material/material.h"
#include "lib/relax/relax_cost.h"
#include "lib/relax/relaxation.h"
#include "lib/session/session.h"
#include "lib/springs/spring_cost.h"
#include "lib/state/pose.h"
#include "lib/state/state_cost.h"
#include "lib/state/state_outputs.h"
#include "raycast/march/march_cost.h"
#include "raycast/render.h"
#include "raycast/scene/presets.h"
#include "volumes/base/files.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"
#include "volumes/field/inversion/inversion_cost.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/load/load_cost.h"
#include "volumes/io/volume_writer.h"
#include "volumes/phantom/phantom.h"

namespace supple::tools {

const char* const kHeadMaterial = R"(
domain     = [-300, 1500]
active     = [-300, 3100]
components = "largest"
max_length = [[-300, 1.25], [100, 1.20], [250, 1.06], [700, 1.05]]
min_length = [[-300, 0.75], [100, 0.80], [250, 0.94], [700, 0.95]]
shear      = [[-300, 0.30], [100, 0.25], [250, 0.15], [700, 0.13]]
)";

namespace {

constexpr int kRounds = 3;
constexpr int kRelaxPasses = 8, kSpringSteps = 2;
constexpr int kPictureSize = 256;

/// Wall time, or processor time where that is less: on a busy machine, of one thread.
double effort_ms(const std::function<void()>& action) {
  const Stopwatch watch;
  action();
  return std::min(watch.ms(), watch.cpu_ms());
}

/// The least of the rounds is what the others would be on a quiet machine.
double least_ms(Progress& progress, const std::function<void()>& action) {
  double least = HUGE_VAL;
  for (int round = 0; round < kRounds; ++round) {
    if (progress.cancelled()) throw Cancelled();
    least = std::min(least, effort_ms(action));
  }
  return least;
}

double per_unit(double ms, double units) {
  return std::max(1e-3, ms * kNsPerMs / std::max(1.0, units));
}

void write_phantom(const std::string& path, const Phantom& phantom) {
  const Vec3i dims = phantom.geometry.dims();
  write_volume(path, phantom.geometry, ValueType::int16, [&](int k, float* out) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) *out++ = phantom.density(i, j, k);
    }
  });
}

SessionOptions with_material() {
  SessionOptions options;
  options.material = parse_material(kHeadMaterial, "calibration");
  return options;
}

Region middle_of(const Session& session) {
  Vec3i nearest;
  nearest_element(session.body(), session.geometry().dims() / 2, nearest);
  return Region(nearest);
}

class Calibration {
 public:
  explicit Calibration(Progress& progress) : m_progress(progress) {
    write_phantom(m_head, head_phantom({96, 96, 54}));
    write_phantom(m_lips, lips_phantom());
  }
  UnitCosts measure(const std::string& program);

 private:
  void measure_opening();
  void measure_drag(Session& session);
  void measure_relaxation(const Session& session);
  void measure_pose(const State& at_rest, const State& moved);
  void measure_pictures(const State& state);
  void measure_files(const State& at_rest, const State& moved);
  void measure_motion();

  Progress& m_progress;
  const ScratchFolder m_folder;
  const std::string m_head = m_folder / "head.nrrd", m_lips = m_folder / "lips.nrrd";
  UnitCosts m_costs;
};

void Calibration::measure_opening() {
  const SessionOptions options = with_material();
  const MaterialTable& material = *options.material;
  double voxels = 0, elements = 0;
  const double read_ms = least_ms(m_progress, [&] {
    const ElementVolume volume =
        load_elements(m_head, {}, material.active_lo, material.active_hi, material.components);
    voxels = double(volume.volume.geometry.voxel_count());
  });
  const double open_ms = least_ms(m_progress, [&] {
    const Session session(m_head, options);
    elements = double(session.body().elements.active_count());
  });
  m_costs.set(kReadVoxelCost, per_unit(read_ms, voxels));
  m_costs.set(kBodyElementCost, per_unit(std::max(0.0, open_ms - read_ms), elements));
}

void Calibration::measure_drag(Session& session) {
  double least = HUGE_VAL;
  for (int round = 0; round < kRounds; ++round) {
    // Drags follow one another, so that every round moves tissue.
    double moved = 0;
    const double ms = effort_ms(
        [&] { moved = double(session.drag(middle_of(session), Vec3d(0, 6, 0)).report.moved); });
    if (moved > 0) least = std::min(least, per_unit(ms, moved));
  }
  if (least < HUGE_VAL) m_costs.set(kEcmElementCost, least);
}

void Calibration::measure_relaxation(const Session& session) {
  for (const bool conserves : {false, true}) {
    RelaxParams params;
    params.bulk_modulus_kpa = conserves ? 100 : 0;
    double least = HUGE_VAL;
    for (int round = 0; round < kRounds; ++round) {
      if (m_progress.cancelled()) throw Cancelled();
      Body body = session.body();
      Relaxation relaxation(body, {}, {}, params);
      const double ms = effort_ms([&] {
        for (int pass = 0; pass < kRelaxPasses; ++pass) relaxation.pass();
      });
      least = std::min(least, per_unit(ms, relaxation.work() / (conserves ? 3 : 1)));
    }
    m_costs.set(conserves ? kVolumeElementCost : kRelaxElementCost, least);
  }
}

void Calibration::measure_pose(const State& at_rest, const State& moved) {
  const double bricks = double(moved.density.bricks().brick_count());
  Displacement u;
  const double rest_ms = least_ms(
      m_progress, [&] { invert_displacement(at_rest, extended_displacement_of(at_rest)); });
  // Half of it is for each of the two passes over bricks, displacement and inverse.
  m_costs.set(kStillBrickCost, per_unit(rest_ms, 2 * bricks));
  const double extend_ms = least_ms(m_progress, [&] { u = extended_displacement_of(moved); });
  const double invert_ms = least_ms(m_progress, [&] { invert_displacement(moved, u); });
  const double voxels = double(u.u.vectors.stored_bricks()) * kBrickVoxels;
  const double still_ms = m_costs[kStillBrickCost] * bricks / kNsPerMs;
  m_costs.set(kDisplacementVoxelCost,
              per_unit(std::max(0.1 * extend_ms, extend_ms - still_ms), voxels));
  m_costs.set(kInvertVoxelCost, per_unit(std::max(0.1 * invert_ms, invert_ms - still_ms), voxels));
}

void Calibration::measure_pictures(const State& state) {
  std::unique_ptr<Renderer> renderer;
  const double build_ms = least_ms(
      m_progress, [&] { renderer = std::make_unique<Renderer>(state.geometry, state.density); });
  m_costs.set(kSourceBrickCost, per_unit(build_ms, double(state.density.bricks().brick_count())));
  const OffsetField offsets = invert_state(state).offsets;
  renderer->set_offsets(&offsets);
  RenderSettings settings;
  settings.width = settings.height = kPictureSize;
  const Camera camera = default_camera(state.geometry, 1);
  // Two step lengths tell what a sample costs from what a ray does.
  double ms[2], samples[2];
  for (int n = 0; n < 2; ++n) {
    settings.set_step(n == 0 ? 0.5 : 0.125);
    RenderReport report;
    ms[n] = least_ms(m_progress,
                     [&] { renderer->render_float(camera, preset("Bone"), settings, &report); });
    samples[n] = double(report.samples);
  }
  m_costs.set(kSampleCost, per_unit(std::max(0.0, ms[1] - ms[0]), samples[1] - samples[0]));
  const double file_ms = least_ms(m_progress, [&] {
    write_png(m_folder / "picture.png",
              to_image(renderer->render_float(camera, preset("Bone"), settings)));
  });
  // Time beside the march: a picture's cost before it and after, its file included.
  const double rays_ms =
      ms[0] - m_costs[kSampleCost] * samples[0] / kNsPerMs + std::max(0.0, file_ms - ms[1]);
  m_costs.set(kRayCost,
              per_unit(std::max(0.1 * ms[0], rays_ms), double(kPictureSize) * kPictureSize));
}

void Calibration::measure_files(const State& at_rest, const State& moved) {
  const Pose rest = invert_state(at_rest), pose = invert_state(moved);
  const std::string path = m_folder / "state.vdb";
  const double bricks = double(moved.density.bricks().brick_count());
  const double rest_ms = least_ms(m_progress, [&] { write_state(path, at_rest, rest.offsets); });
  const double moved_ms = least_ms(m_progress, [&] { write_state(path, moved, pose.offsets); });
  m_costs.set(kStateBrickCost, per_unit(rest_ms, bricks));
  m_costs.set(kStateVectorBrickCost, per_unit(std::max(0.0, moved_ms - rest_ms),
                                              double(pose.offsets.o.vectors.stored_bricks())));
  const double warp_ms = least_ms(m_progress, [&] {
    WarpOutput output;
    output.path = m_folder / "warp.nrrd";
    output.grid = moved.geometry;
    write_state_warp(output, moved, pose, nullptr);
  });
  m_costs.set(kWarpVoxelCost, per_unit(warp_ms, double(moved.geometry.voxel_count())));
}

void Calibration::measure_motion() {
  const auto step = [&](bool is_fem) {
    Session session(m_lips, with_material());
    Step request;
    request.drags.push_back({middle_of(session), Vec3d(0, 0, 1)});
    const Vec3i& dims = session.geometry().dims();
    request.fix.push_back({{0, 0, 0}, {3, dims.y - 1, dims.z - 1}});  // one end of both
    if (is_fem) {
      request.fem.emplace();
    } else {
      request.springs.emplace();
      request.springs->motion.minimise = true;
      request.springs->most_steps = kSpringSteps;
    }
    StepRecord record;
    const double ms = effort_ms([&] { record = session.step(request); });
    return std::pair(ms, record);
  };
  double springs_ms = HUGE_VAL, spring_steps = 0;
  double fem_ms = HUGE_VAL, fem_units = 0;
  for (int round = 0; round < kRounds; ++round) {
    if (m_progress.cancelled()) throw Cancelled();
    const auto [ms, record] = step(false);
    springs_ms = std::min(springs_ms, ms);
    spring_steps = double(record.sprung.springs) * record.sprung.steps;
    const auto [solved_ms, solved] = step(true);
    fem_ms = std::min(fem_ms, solved_ms);
    const FemReport& fem = solved.equilibrium.report;
    fem_units = fem_work(double(fem.unknowns), fem.iterations);
  }
  m_costs.set(kSpringCost, per_unit(springs_ms, spring_steps));
  m_costs.set(kFemUnknownCost, per_unit(fem_ms, fem_units));
}

UnitCosts Calibration::measure(const std::string& program) {
  m_progress.stage("calibrating");
  measure_opening();
  Session session(m_head, with_material());
  const State at_rest = session.state();
  measure_drag(session);
  const State moved = session.state();
  measure_relaxation(session);
  measure_pose(at_rest, moved);
  measure_pictures(moved);
  measure_files(at_rest, moved);
  measure_motion();
  char day[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(day, sizeof day, "%Y-%m-%d", std::localtime(&now));
  m_costs.measured = std::string(day) + " by " + program;
  return m_costs;
}

}  // namespace

UnitCosts calibrate(const std::string& program, Progress& progress) {
  return Calibration(progress).measure(program);
}

}  // namespace supple::tools
