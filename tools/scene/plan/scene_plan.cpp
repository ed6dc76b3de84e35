#include "tools/scene/plan/scene_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "lib/body/body_cost.h"
#include "lib/session/session.h"
#include "lib/state/state_cost.h"
#include "raycast/march/march_cost.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/moved_bricks.h"
#include "tools/scene/plan/plan_ledger.h"
#include "tools/scene/plan/ray_work.h"
#include "tools/scene/plan/unit_costs.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/text.h"
#include "volumes/field/inversion/inversion_cost.h"
#include "volumes/io/load/load_cost.h"

namespace supple::tools {

namespace {

constexpr double kFieldTableBytes = 108;  // of any brick of a field: masks, neighbours, place
constexpr double kPlaceBytes = 8;         // the same of a field that shares those of the body
constexpr double kStoreNs = 250;          // of a pixel that becomes a part of a PNG file
constexpr double kPathBricks = 2.4;       // that a sampling path fills, of those of the volume
/// Frames of a film find the memory of those before them in pieces.
constexpr double kScatteredPart = 0.5;
constexpr double kPathWork = 3;  // of a voxel along a path, in those of an inversion

// Code and libraries that come with the first picture, dense file, OpenVDB file and HDF5 file:
// measured as the growth of a process that does nothing else (docs/economy.md).
constexpr double kPictureCode = 3.5e6, kDenseCode = 5.5e6, kVdbCode = 10e6, kHdf5Code = 9e6;
constexpr double kLargePageBytes = 3e6;  // of the heap, beside what is in use
constexpr double kLegendCode = 7e6;      // of what draws legends and words, and writes EXR

/// The rows of views and outputs, once the steps are planned.
class ScenePlanner {
 public:
  ScenePlanner(const Scene& scene, const PlanSubject& subject, const UnitCosts& costs,
               ScenePlan& plan)
      : m_scene(scene), m_subject(subject), m_costs(costs), m_ledger(plan, subject) {}

  void plan();

 private:
  double density_bricks() const {
    return m_subject.expected ? m_subject.expected->kept
                              : double(m_subject.state.density.bricks().brick_count());
  }
  double element_bricks() const {
    return m_subject.expected ? m_subject.expected->kept
                              : double(m_subject.state.elements.brick_count());
  }
  bool has_body() const {
    return m_subject.session != nullptr || (m_subject.expected && needs_body(m_scene));
  }
  double frames() const { return m_scene.film ? double(m_scene.film->frames_to_make.size()) : 1; }
  void add(const std::string& stage, const std::string& what, const std::string& why,
           double held_bytes, double brief_bytes, double ns) {
    m_ledger.add({stage, what, why, held_bytes / kMegabyte, brief_bytes / kMegabyte, ns * 1e-9});
  }
  void plan_subject();
  void plan_expected(const ExpectedBricks& expected);
  void plan_steps();
  void plan_pose();
  std::string asks_for_displacement() const;
  std::string asks_for_inverse() const;
  double seen_part(int step) const;
  void plan_view(const SceneView& view);
  bool is_cut() const;
  double bricks_on_path(const SceneView& view) const;
  void plan_path(const SceneView& view, const std::string& stage);
  void plan_march(const SceneView& view, const std::string& stage, double pictures);
  void plan_state();
  void plan_outputs();
  void plan_dense(const std::string& name, const std::string& what, double value_bytes);
  /// Returns those of `bytes`, which come once, that have not come yet.
  double once(double bytes) { return m_loaded.insert(bytes).second ? bytes : 0; }

  const Scene& m_scene;
  const PlanSubject& m_subject;
  const UnitCosts& m_costs;
  PlanLedger m_ledger;
  MovedBricks m_moved;
  std::set<double> m_loaded;
  double m_moved_bricks = 0;  // of fields: elements and the air around them
  double m_inverted_bricks = 0;
};

/// Reading holds every brick that may be kept.
void ScenePlanner::plan_expected(const ExpectedBricks& expected) {
  add("reading", "reading " + bricks_text(expected.read), "the volume is read", 0,
      expected.read * kGridBytes + expected.reading_bytes, 0);
  add("opening", "densities of " + bricks_text(expected.kept), "the volume is read",
      expected.kept * kGridBytes, 0, 0);
  if (!has_body()) return;
  add("opening", "elements in " + bricks_text(expected.kept), "what the material makes tissue",
      expected.kept * kBodyBytes, 0, 0);
}

/// Held already: a part of what the process holds now.
void ScenePlanner::plan_subject() {
  if (m_subject.expected) return plan_expected(*m_subject.expected);
  const State& state = m_subject.state;
  const double grid_mb = double(state.density.bytes()) / kMegabyte;
  const double body_mb =
      m_subject.session == nullptr ? 0 : double(m_subject.session->body().bytes()) / kMegabyte;
  const Vec3i& dims = state.geometry.dims();
  m_ledger.add(
      {"start", "the program and its libraries", "every run", 0, 0, m_subject.start_seconds});
  add("start", "what the heap takes in large pages", "every run", kLargePageBytes, 0, 0);
  m_ledger.add({"open",
                count_text(double(state.geometry.voxel_count()), "voxels in ") +
                    bricks_text(density_bricks()),
                std::filesystem::path(m_scene.volume_path).filename().string() + ", " +
                    std::to_string(dims.x) + "x" + std::to_string(dims.y) + "x" +
                    std::to_string(dims.z),
                grid_mb, 0, m_subject.open_seconds});
  m_ledger.give_back(grid_mb);
  if (m_subject.session == nullptr) {
    m_ledger.leave_out("a body", "nothing moves, and nothing is written of what moved");
    return;
  }
  m_ledger.add({"open",
                count_text(double(state.elements.active_count()), "elements in ") +
                    bricks_text(element_bricks()),
                "what the material makes tissue", body_mb, 0, 0});
  m_ledger.give_back(body_mb);
}

void ScenePlanner::plan_steps() {
  if (m_subject.session == nullptr) return;
  // A method may have chosen other links since the session was opened.
  int links = m_scene.material ? m_scene.material->links : m_subject.session->material().links;
  for (std::size_t n = 0; n < m_scene.steps.size(); ++n) {
    const Step& step = m_scene.steps[n];
    if (!step.body.empty()) continue;  // thousands of nodes beside millions of voxels
    if (step.material) links = step.material->links;
    m_moved = plan_step(step, int(n) + 1, links, *m_subject.session, m_subject.state, m_moved,
                        m_costs, m_ledger);
  }
  const double still = element_bricks() - double(m_moved.count());
  if (still > 0) {
    m_ledger.leave_out("displacement and offsets of " + bricks_text(still), "nothing reaches them");
  }
  m_moved_bricks = double(m_moved.count()) * density_bricks() / std::max(1.0, element_bricks());
}

/// The first that reads the displacement; empty: nothing does.
std::string ScenePlanner::asks_for_displacement() const {
  const std::string inverse = asks_for_inverse();
  if (!inverse.empty()) return inverse;
  for (const SceneView& view : m_scene.views) {
    if (view.deformed) return "view " + view.image;
  }
  const std::vector<std::string>& names = m_scene.output.displacements;
  return names.empty() ? "" : "output " + names.front();
}

/// The first that reads offsets; empty: nothing does.
std::string ScenePlanner::asks_for_inverse() const {
  const SceneOutput& output = m_scene.output;
  for (const SceneView& view : m_scene.views) {
    if (view.deformed && view.inverse) return "view " + view.image;
  }
  if (!output.state.empty()) return "output " + output.state;
  for (const auto* names : {&output.offsets, &output.volumes}) {
    if (!names->empty()) return "output " + names->front();
  }
  if (!output.displacements.empty() && !m_scene.path.empty()) return "the path of displacements";
  return "";
}

/// A joint parts tissue, too.
bool ScenePlanner::is_cut() const {
  return std::any_of(m_scene.steps.begin(), m_scene.steps.end(), [](const Step& step) {
    return !step.cuts.empty() || step.rigid.joint_mm > 0;
  });
}

/// Part of the bricks that move in which the views after a step read offsets.
double ScenePlanner::seen_part(int step) const {
  const auto is_seen = seen_bricks(m_scene, step, m_subject.state.geometry);
  const BrickTopology& elements = m_subject.state.elements;
  const bool is_cut = m_moved.split > 0 || !m_subject.state.cuts.empty();
  if (!is_seen || is_cut || m_moved.count() == 0) return 1;
  std::int64_t seen = 0;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    seen += m_moved.moves_brick(b) && is_seen(elements.origin(b));
  }
  return double(seen) / double(m_moved.count());
}

void ScenePlanner::plan_pose() {
  if (!has_body()) return;
  const std::string reads_u = asks_for_displacement(), reads_o = asks_for_inverse();
  if (reads_u.empty()) {
    m_ledger.leave_out("displacement of voxels", "no view and no output shows the body moved");
  } else {
    // The state of the step is a copy of what moved.
    const double copied =
        double(m_moved.count(0) + m_moved.count(1) + m_moved.count(2)) * kBrickBytes4;
    // A frame of a film is taken back, for which the session keeps what it changed.
    const double of_frame = m_scene.film ? 2 * copied : 0;
    add("pose", "displacement of " + bricks_text(m_moved_bricks), reads_u,
        copied + of_frame + m_moved_bricks * kBrickBytes12 + density_bricks() * kPlaceBytes,
        density_bricks() * kExtendBytes,
        frames() * (m_moved_bricks * kBrickVoxels * m_costs[kDisplacementVoxelCost] +
                    density_bricks() * m_costs[kStillBrickCost]));
  }
  if (reads_o.empty()) {
    m_ledger.leave_out("inverse (offsets)", reads_u.empty()
                                                ? "no view and no output shows the body moved"
                                                : "no view and no output reads it");
  } else {
    double part = 0;
    for (int step = 0; step <= int(m_scene.steps.size()); ++step) {
      part = std::max(part, seen_part(step));
    }
    m_inverted_bricks = m_moved_bricks * part;
    const double inverted = m_inverted_bricks;
    if (inverted < m_moved_bricks) {
      m_ledger.leave_out("offsets of " + bricks_text(m_moved_bricks - inverted),
                         "no picture shows them");
    }
    add("pose", "offsets of " + bricks_text(inverted), reads_o,
        inverted * kBrickBytes12 + density_bricks() * kFieldTableBytes +
            m_moved.split * kSplitBytes + once(std::min(kInvertCode, inverted * kInvertedBytes)),
        inverted * kInvertBytes + density_bricks() * kRestBytes,
        frames() * (inverted * kBrickVoxels * m_costs[kInvertVoxelCost] + m_moved.split * kSplitNs +
                    density_bricks() * m_costs[kStillBrickCost]));
  }
}

/// A path moves every brick, also the air that a picture of it reads.
double ScenePlanner::bricks_on_path(const SceneView& view) const {
  const bool is_sent = !view.path.empty() || (view.deformed && !m_scene.path.empty());
  return is_sent ? kPathBricks * density_bricks() : 0;
}

void ScenePlanner::plan_path(const SceneView& view, const std::string& stage) {
  const double bricks = bricks_on_path(view);
  if (bricks == 0) return;
  add(stage, "offsets of " + bricks_text(bricks), "the path", 0,
      bricks * (2 * kBrickBytes12 + 2 * kFieldTableBytes),
      view.picture.frame_count() * bricks * kBrickVoxels * kPathWork * m_costs[kInvertVoxelCost]);
}

void ScenePlanner::plan_march(const SceneView& view, const std::string& stage, double pictures) {
  const State& state = m_subject.state;
  const double grey_lo = state.density.background();
  const PosedVolume at_rest{state.geometry, state.density, state.elements, nullptr,
                            nullptr,        grey_lo,       grey_lo + 1};
  RenderSettings settings = view_settings(view);
  SceneView plain = view;
  plain.fit.clear();
  const PictureWork work = m_subject.expected
                               ? PictureWork{0, 0}
                               : picture_work(state.density, state.geometry,
                                              camera_of(at_rest, plain), look_of(view), settings);
  const double samples = work.samples;
  const double pixels = double(view.size[0]) * view.size[1];
  const bool is_cubic = view.sampling.interpolation != Interpolation::linear;
  const double sample_work =
      std::max(is_cubic ? kCubicSample : 1.0, view.deformed && is_cut() ? kCutSample : 1.0);
  const double on_path = bricks_on_path(view);
  const double moved = on_path > 0 ? on_path : view.deformed ? m_inverted_bricks : 0;
  const double node_bytes = view.half_offsets ? kHalfNodeBytes : kNodeBytes;
  const double field_bytes = on_path * (kBrickBytes12 + kFieldTableBytes);
  const bool turns = !view.camera_keys.empty() || view.picture.turntable > 0;
  const double read = is_cubic || turns ? density_bricks() : work.bricks;
  const double bytes = read * kSourceBytes + density_bricks() * kTableBytes + field_bytes +
                       (moved > 0 && view.inverse
                            ? moved * node_bytes + std::min(kSlotsInAdvance, moved * kSlotBytes)
                            : 0) +
                       pixels * (kPixelBytes + (settings.auxiliary ? kAuxiliaryBytes : 0));
  const double scattered = m_scene.film ? kScatteredPart : 0;
  add(stage,
      count_text(pixels, "rays, ") + count_text(samples, "samples") +
          (pictures > 1 ? ", " + count_text(pictures, "times") : ""),
      view.deformed ? "a picture of the body moved" : "a picture of the body at rest",
      once(kPictureCode), bytes * (1 + scattered),
      density_bricks() * m_costs[kSourceBrickCost] +
          pictures * (pixels * (m_costs[kRayCost] + kStoreNs) +
                      samples * sample_work * m_costs[kSampleCost]));
}

void ScenePlanner::plan_view(const SceneView& given) {
  const State& state = m_subject.state;
  const SceneView view = effective_view(given, state.geometry, state.density.background());
  const std::string stage = "view " + view.image;
  plan_path(view, stage);
  const double pictures = view.picture.frame_count();
  const bool has_legend = view.picture.shows("offset") || !view.decoration.annotate.empty() ||
                          !view.marks.overlay.empty() ||
                          picture_kind(view.image) == PictureKind::exr;
  if (has_legend)
    add(stage, "legends and words", "the view asks for them", once(kLegendCode), 0, 0);
  const double pixels =
      view.slice ? slice_pixels(*view.slice, state.geometry) : double(view.size[0]) * view.size[1];
  if (view.slice || view.lattice) {
    add(stage, count_text(pixels, "pixels"), view.slice ? "slices" : "a lattice",
        once(kPictureCode), pixels * kPixelBytes,
        pictures * pixels * (m_costs[kRayCost] + kStoreNs));
    return;
  }
  plan_march(view, stage, pictures);
}

void ScenePlanner::plan_dense(const std::string& name, const std::string& what,
                              double value_bytes) {
  const Vec3i& dims = m_subject.state.geometry.dims();
  const double voxels = double(m_subject.state.geometry.voxel_count());
  const double slice = double(dims.x) * dims.y;
  const bool is_vdb = ends_with(name, ".vdb");
  const bool is_hdf5 = ends_with(name, ".h5") || ends_with(name, ".hdf5");
  const double code = is_vdb ? once(kVdbCode) : once(kDenseCode) + (is_hdf5 ? once(kHdf5Code) : 0);
  // Eight slices of vectors, and two on their way into the file.
  add("output " + name, what + " of " + count_text(voxels, "voxels"), "[output]", code,
      slice * (8 * 12.0 + 3 * value_bytes) + density_bricks() * 4 * kFieldTableBytes,
      frames() * voxels * m_costs[kWarpVoxelCost]);
}

/// Plans the state. Where it refers to its volume only bricks that move count, and the densities of
/// the volume are compared once.
void ScenePlanner::plan_state() {
  const bool refers = m_scene.output.refers;
  const double densities = refers ? m_moved_bricks : density_bricks();
  const double elements = refers ? double(m_moved.count()) : element_bricks();
  const double grid_bytes = refers ? kGridBytes + 2 * kBrickBytes12 : 0;
  add("output " + m_scene.output.state,
      refers ? "coordinates and offsets, and densities of what moved"
             : "densities, coordinates and offsets",
      "[output]", once(kVdbCode),
      double(m_moved.count()) * kMovedGridBytes + elements * kElementGridBytes +
          densities * (grid_bytes + 2 * kLeafBytes),
      frames() *
          (densities * m_costs[kStateBrickCost] + m_moved_bricks * m_costs[kStateVectorBrickCost]));
}

void ScenePlanner::plan_outputs() {
  const SceneOutput& output = m_scene.output;
  if (!output.state.empty()) plan_state();
  for (const std::string& name : output.offsets) plan_dense(name, "a warp", 12);
  for (const std::string& name : output.displacements) plan_dense(name, "displacements", 12);
  for (const std::string& name : output.volumes) plan_dense(name, "a resampled volume", 4);
  for (const ElementOutput& elements : output.elements) {
    plan_dense(elements.path, "a value per element", 4);
  }
  if (output.all().empty()) {
    m_ledger.leave_out("a state, warps, resampled volumes", "the scene has no [output]");
  } else if (output.state.empty()) {
    m_ledger.leave_out("a state", "[output] names none");
  }
}

void ScenePlanner::plan() {
  plan_subject();
  plan_steps();
  plan_pose();
  bool marches = false;
  for (const SceneView& view : m_scene.views) {
    plan_view(view);
    marches = marches || !(view.slice || view.lattice || m_subject.state.geometry.dims().z == 1);
  }
  if (!marches) {
    m_ledger.leave_out("sampling bricks, Embree's scene",
                       m_scene.views.empty() ? "no view" : "slices and lattices march no rays");
  }
  plan_outputs();
}

}  // namespace

BodyBytes body_bytes(std::int64_t bricks) {
  const double opened = kGridBytes + kBodyBytes;
  const double posed = kPlaceBytes + kExtendBytes + kFieldTableBytes + kRestBytes;
  const double written = kElementGridBytes + 2 * kLeafBytes;
  const auto of_all = [&](double bytes) { return std::int64_t(double(bricks) * bytes); };
  return {of_all(opened), of_all(opened + kSourceBytes + kTableBytes),
          of_all(opened + posed + written), of_all(opened + posed)};
}

ScenePlan plan_scene(const Scene& scene, const PlanSubject& subject, const UnitCosts& costs) {
  ScenePlan plan;
  plan.costs = origin_of(costs);
  ScenePlanner(scene, subject, costs, plan).plan();
  return plan;
}

}  // namespace supple::tools
