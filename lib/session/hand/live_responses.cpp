#include "lib/session/hand/live_responses.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/fem_solution.h"
#include "lib/fem/response/response_field.h"
#include "lib/fem/voxel/level_solver.h"
#include "lib/session/fem_limits.h"
#include "lib/session/fem_task.h"
#include "lib/session/handles/handle_motion.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Elements whose changes are looked at: every one of so many.
constexpr std::size_t kSample = 61;
constexpr double kSampled = 0.95;
/// Part of the largest displacement from which on an element counts as moved.
constexpr double kMoved = 0.05;
/// Tolerance of all levels but the last.
constexpr double kRough = 1e-1;
/// Elements of 2^doublings voxels, solved by so many iterations at most, of voxels with those of
/// the levels before; 0: as the step asks.
/// Voxels need no more time than elements of twice their size to come as near, since their cycle
/// knows thin parts.
struct LevelKind {
  int doublings, iterations;
};
constexpr LevelKind kLevels[kAllLevels] = {{3, 100}, {2, 100}, {0, 2},  {0, 3},
                                           {0, 5},   {0, 10},  {0, 21}, {0, 0}};
/// Directions that are shorter than this part of their target are no directions of their own.
constexpr double kLeastPart = 1e-6;
/// Places are rounded to 2^-16 voxel: what a direction asks less than this is no motion.
constexpr double kRounding = 2.0 / (1 << 16);

double percentile(std::vector<float> values, double part) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return double(*at);
}

double dot_of(const std::array<double, 12>& a, const std::array<double, 12>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// Solves A x = b, A symmetric and not negative; unknowns without a pivot of their own are 0.
std::vector<double> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t count = b.size();
  std::vector<double> scale(count), x(count, 0.0);
  for (std::size_t n = 0; n < count; ++n) scale[n] = a[n][n];
  std::vector<bool> is_used(count, false);
  for (std::size_t n = 0; n < count; ++n) {
    is_used[n] = a[n][n] > kLeastPart * kLeastPart * scale[n] && scale[n] > 0;
    if (!is_used[n]) continue;
    for (std::size_t row = n + 1; row < count; ++row) {
      const double factor = a[row][n] / a[n][n];
      for (std::size_t m = n; m < count; ++m) a[row][m] -= factor * a[n][m];
      b[row] -= factor * b[n];
    }
  }
  for (std::size_t n = count; n-- > 0;) {
    if (!is_used[n]) continue;
    double sum = b[n];
    for (std::size_t m = n + 1; m < count; ++m) sum -= a[n][m] * x[m];
    x[n] = sum / a[n][n];
  }
  return x;
}

}  // namespace

struct LiveLevel {
  int doublings = 0;
  bool is_last = false;
  ResponseField field;                            // the base, and one per direction
  std::vector<Vec3d> force_n;                     // likewise, of the handle
  std::vector<std::vector<PieceMoments>> pieces;  // likewise, per piece
  std::vector<double> change_mm;  // likewise, since the level before; empty: none was
};

LiveResponses::LiveResponses(const SessionBody& in, const Step& grab,
                             std::vector<DragPose> directions)
    : m_body(in.body),
      m_fits(m_body),
      m_density(in.state.density),
      m_labels(in.state.labels),
      m_cuts(in.cuts()),
      m_anchors(in.anchors),
      m_holds(in.holds) {
  if (!grab.fem || grab.drags.size() != 1) {
    throw InputError({"", "responses", "a step without finite elements or with several handles",
                      "one handle under finite elements"});
  }
  m_step = *grab.fem;
  const Vec3d edges_mm = m_body.geometry.spacing_mm();
  m_step.params =
      solved_params(m_step, !m_labels.empty(), std::min({edges_mm.x, edges_mm.y, edges_mm.z}));
  const std::string reason = why_no_sum(m_step.params);
  if (!reason.empty()) throw InputError({"", "responses", reason, "linear equilibria of voxels"});
  if (in.responses && m_step.params.elements.touching == Touching::apart) {
    m_voxels = in.responses->voxels;
  }
  const SlotSet grabbed = elements_of(m_body, in.region_of(grab.drags.front()), "grab");
  m_about_mm = centre_lps_mm(m_body, grabbed);
  double squares = 0;
  grabbed.for_each([&](Slot slot) {
    squares += (m_body.geometry.world_from_index(place_now(m_body, slot)) - m_about_mm).length2();
  });
  const Vec3d spacing = m_body.geometry.spacing_mm();
  m_radius_mm = std::max(std::sqrt(squares / double(grabbed.size())), spacing.x / 2);
  directions.insert(directions.begin(), DragPose{Vec3d(0), {}});
  for (DragPose& pose : directions) {
    Step step = grab;
    Drag& drag = step.drags.front();
    if (!pose.motion.about_lps_mm) pose.motion.about_lps_mm = m_about_mm;
    drag.by_mm = pose.by_mm;
    drag.motion = pose.motion;
    m_handles.push_back(in.handles_of(step, in.motions_of(step), 1));
    m_directions.push_back(affine_of(pose));
  }
}

LiveResponses::~LiveResponses() = default;

/// Shift of the middle, and the linear map less the identity times the radius: a motion of about so
/// many mm each.
LiveResponses::Affine LiveResponses::affine_of(const DragPose& pose) const {
  const Geometry& geometry = m_body.geometry;
  Affine out{};
  const GridSteps steps = steps_of(pose.motion, geometry);
  const auto moved_way = [&](const Vec3d& way_mm) {
    const Vec3d index = geometry.index_vector_from_world(way_mm);
    const Vec3d moved = steps[0] * index.x + steps[1] * index.y + steps[2] * index.z;
    return geometry.world_vector_from_index(moved) - way_mm;
  };
  const Vec3d about = pose.motion.about_lps_mm.value_or(m_about_mm);
  const Vec3d shift = geometry.world_vector_from_index(pose.by_mm / geometry.spacing_mm()) +
                      moved_way(m_about_mm - about);
  for (int a = 0; a < 3; ++a) {
    out[std::size_t(a)] = shift[a];
    Vec3d unit(0.0);
    unit[a] = m_radius_mm;
    const Vec3d column = moved_way(unit);
    for (std::size_t c = 0; c < 3; ++c) out[3 + 3 * c + a] = column[int(c)];
  }
  return out;
}

/// The loads of the place where the handle is, with all forces, then what directions add to them.
std::vector<NodalLoads> LiveResponses::loads(const VoxelFemModel& model, const FemTask& task,
                                             Progress* progress) {
  const FemModel& solid = model.solid();
  const FemLoads acting = loads_of(m_step, task, m_voxels->solid);
  std::vector<NodalLoads> all(m_handles.size());
  parallel_for(all.size(), [&](std::size_t n) {
    poll(progress);
    VoxelFemModel own(task.held, model);
    if (n == 0) own.set_loads(acting);
    const FemLoads& loads = own.loads_of(m_handles[n], progress);
    if (n > 0) {
      all[n] = nodal_loads(solid.mesh(), solid.material(), loads);
      all[n].within_held_mn = forces_within_held(solid.mesh(), solid.material(), all[n]);
      return;
    }
    FemReport report;
    all[n] = solid.checked_loads(loads, m_step.params, progress, report);
    m_is_handle.clear();
    for (const FemGrip& grip : own.grips()) {
      m_is_handle.push_back(grip.kind == GripKind::handle || grip.kind == GripKind::edge);
    }
  });
  const NodalLoads& base = all.front();
  HeldBits held(base.held.size(), 0);  // without loose islands
  for (const auto& nodes : base.nodes_of) {
    for (const NodeIndex node : nodes) held[std::size_t(node)] = kAllHeld;
  }
  for (std::size_t d = 1; d < all.size(); ++d) {
    NodalLoads& direction = all[d];
    if (direction.held != held)
      throw InputError({"", "responses", "other elements that a direction holds",
                        "those of the handle where it is"});
    direction.held = base.held;
    for (std::size_t n = 0; n < base.u_mm.size(); ++n) direction.u_mm[n] -= base.u_mm[n];
    if (!direction.within_held_mn.empty() || !base.within_held_mn.empty()) {
      direction.within_held_mn.resize(base.u_mm.size(), 0.0);
      for (std::size_t n = 0; n < base.within_held_mn.size(); ++n) {
        direction.within_held_mn[n] -= base.within_held_mn[n];
      }
    }
  }
  return all;
}

std::shared_ptr<LiveLevel> LiveResponses::level_of(const VoxelFemModel& model,
                                                   const std::vector<NodalLoads>& loads,
                                                   const std::vector<NodalSolution>& solutions,
                                                   const LiveLevel* before) const {
  const std::size_t count = solutions.size();
  auto level = std::make_shared<LiveLevel>();
  level->force_n.resize(count, Vec3d(0.0));
  level->pieces.resize(count);
  std::vector<std::vector<float>> fields(count);
  parallel_for(count, [&](std::size_t n) {
    const std::vector<Vec3d> centres = model.centres_mm(solutions[n].u_mm);
    level->pieces[n] = m_fits.moments(centres);
    fields[n].resize(3 * centres.size());
    for (std::size_t e = 0; e < centres.size(); ++e) {
      for (int a = 0; a < 3; ++a) fields[n][3 * e + std::size_t(a)] = float(centres[e][a]);
    }
    for (std::size_t g = 0; g < m_is_handle.size(); ++g) {
      if (m_is_handle[g]) level->force_n[n] += pull_n(loads[n], g, solutions[n].residual_mn);
    }
  });
  for (std::vector<float>& values : fields) level->field.add(std::move(values));
  if (before == nullptr) return level;
  for (std::size_t n = 0; n < count; ++n) {
    level->change_mm.push_back(
        percentile(level->field.changes(n, before->field, kSample, kMoved), kSampled));
  }
  return level;
}

void LiveResponses::run(Progress* progress, std::shared_ptr<KeptVoxels> ahead, int levels) {
  std::shared_ptr<const FemResponses> none;
  const FemTask task{{m_body, m_anchors, m_holds},
                     m_cuts,
                     m_density,
                     m_labels,
                     {},
                     m_pieces,
                     {},
                     nullptr,
                     none,
                     {}};
  ResponseKey key = solid_key(m_step, task);
  const auto is_of_key = [&](const std::shared_ptr<KeptVoxels>& voxels) {
    return voxels && voxels->key.change_to(key).empty();
  };
  if (!is_of_key(m_voxels)) m_voxels = std::move(ahead);
  if (!is_of_key(m_voxels)) {
    m_voxels = std::make_shared<KeptVoxels>(std::move(key), m_step, task, progress);
  }
  const VoxelFemModel& model = m_voxels->model;
  const FemModel& solid = model.solid();
  std::vector<NodalLoads> all = loads(model, task, progress);
  const int deepest = int(solid.levels().meshes.size()) - 1;
  LevelSolver solver(solid, all);
  std::shared_ptr<const LiveLevel> before;
  for (const auto& [doublings, iterations] : kLevels) {
    if (doublings > deepest) continue;
    if (ready() >= levels) return;
    const bool is_last = iterations == 0;
    FemParams params = m_step.params;
    params.doublings = doublings;
    if (doublings > 0) {
      params.tolerance = std::max(params.tolerance.value_or(kRough), kRough);
      params.reaction_tolerance = std::numeric_limits<double>::infinity();
      params.error_mm.reset();
    }
    if (!is_last) params.max_iterations = std::min(params.max_iterations, iterations);
    std::vector<NodalSolution> solutions = solver.solve(params, !is_last, progress);
    std::shared_ptr<LiveLevel> found = level_of(model, all, solutions, before.get());
    found->doublings = doublings;
    found->is_last = is_last;
    before = found;
    if (doublings > 0 || is_last) {
      for (std::size_t n = 0; n < all.size(); ++n) {
        all[n].u_mm = is_last ? solutions[n].u_mm : std::move(solutions[n].u_mm);
      }
    }
    if (is_last) keep(all, std::move(solutions));
    publish(std::move(found));
  }
}

/// Puts the solutions of the last level together for steps.
void LiveResponses::keep(const std::vector<NodalLoads>& loads,
                         std::vector<NodalSolution> solutions) {
  auto found = std::make_shared<FemResponses>();
  found->voxels = m_voxels;
  const Vec3d spacing = m_body.geometry.spacing_mm();
  const double rounding = kRounding * std::min({spacing.x, spacing.y, spacing.z});
  m_voxels->model.solid().keep(loads, std::move(solutions), m_step.params, rounding, found->known);
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_found = std::move(found);
}

void LiveResponses::publish(std::shared_ptr<const LiveLevel> level) {
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_best = std::move(level);
  ++m_ready;
}

int LiveResponses::ready() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_ready;
}

std::shared_ptr<const FemResponses> LiveResponses::found() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_found;
}

LivePose LiveResponses::pose(const DragPose& target) const {
  LivePose out;
  const Affine asked = affine_of(target);
  const std::size_t count = m_directions.size() - 1;
  std::vector<std::vector<double>> products(count, std::vector<double>(count));
  std::vector<double> of_asked(count);
  for (std::size_t n = 0; n < count; ++n) {
    of_asked[n] = dot_of(m_directions[n + 1], asked);
    for (std::size_t m = 0; m < count; ++m) {
      products[n][m] = dot_of(m_directions[n + 1], m_directions[m + 1]);
    }
  }
  out.parts = solved(std::move(products), std::move(of_asked));
  Affine left = asked;
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t a = 0; a < left.size(); ++a) {
      left[a] -= out.parts[n] * m_directions[n + 1][a];
    }
  }
  out.beyond_mm = std::sqrt(dot_of(left, left));
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    out.level = m_ready - 1;
    out.of = m_best;
  }
  if (!out.of) return out;
  out.doublings = out.of->doublings;
  if (out.of->is_last) {
    out.error_mm = 0;
  } else if (!out.of->change_mm.empty()) {
    out.error_mm = out.of->change_mm[0];
    for (std::size_t n = 0; n < count; ++n) {
      out.error_mm += std::abs(out.parts[n]) * out.of->change_mm[n + 1];
    }
  }
  return out;
}

namespace {

/// The parts with that of the base, which is 1.
std::vector<double> with_base(const LivePose& pose) {
  std::vector<double> parts = pose.parts;
  parts.insert(parts.begin(), 1);
  return parts;
}

}  // namespace

void LiveResponses::displacements(const LivePose& pose, std::size_t begin, std::size_t end,
                                  Vec3f* out) const {
  pose.of->field.sum(with_base(pose), begin, end, out);
}

Vec3d LiveResponses::force_n(const LivePose& pose) const {
  const std::vector<double> parts = with_base(pose);
  Vec3d sum(0);
  for (std::size_t n = 0; n < parts.size(); ++n) sum += pose.of->force_n[n] * parts[n];
  return sum;
}

std::vector<RigidPose> LiveResponses::piece_poses(const LivePose& pose) const {
  const std::vector<double> parts = with_base(pose);
  std::vector<PieceMoments> sums(m_body.rigid.list.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    for (std::size_t p = 0; p < sums.size(); ++p) sums[p].add(pose.of->pieces[n][p], parts[n]);
  }
  return m_fits.poses(sums);
}

std::size_t LiveResponses::bytes() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  const std::size_t sum = m_body.bytes() + (m_best ? m_best->field.bytes() : 0);
  return sum + (m_found ? m_found->known.bytes() : 0);
}

}  // namespace supple
