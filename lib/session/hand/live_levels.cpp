// The search for the levels of responses.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/fem/fem_solution.h"
#include "lib/session/fem_task.h"
#include "lib/session/hand/live_level.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"

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
/// Places are rounded to 2^-16 voxel: what a direction asks less than this is no motion.
constexpr double kRounding = 2.0 / (1 << 16);

double percentile(std::vector<float> values, double part) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return double(*at);
}

/// Cancels what runs where a direction has been asked for, too.
class UntilAsked final : public RelayedProgress {
 public:
  UntilAsked(const LiveResponses& live, Progress* next) : RelayedProgress(next), m_live(live) {}
  bool cancelled() const override { return m_live.has_asked() || RelayedProgress::cancelled(); }

 private:
  const LiveResponses& m_live;
};

}  // namespace

/// The loads of the place where the handle is, with all forces, then what directions add to them.
std::vector<NodalLoads> LiveResponses::loads(const std::vector<std::vector<Handle>>& handles,
                                             const FemTask& task, Progress* progress) {
  const VoxelFemModel& model = m_voxels->model;
  const FemModel& solid = model.solid();
  const FemLoads acting = loads_of(m_step, task, m_voxels->solid);
  std::vector<NodalLoads> all(handles.size());
  parallel_for(all.size(), [&](std::size_t n) {
    poll(progress);
    VoxelFemModel own(task.held, model);
    if (n == 0) own.set_loads(acting);
    const FemLoads& loads = own.loads_of(handles[n], progress);
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

void LiveResponses::make_solid(const FemTask& task, std::shared_ptr<KeptVoxels> ahead,
                               Progress* progress) {
  ResponseKey key = solid_key(m_step, task);
  const auto is_of_key = [&](const std::shared_ptr<KeptVoxels>& voxels) {
    return voxels && voxels->key.change_to(key).empty();
  };
  if (!is_of_key(m_voxels)) m_voxels = std::move(ahead);
  if (!is_of_key(m_voxels)) {
    m_voxels = std::make_shared<KeptVoxels>(std::move(key), m_step, task, progress);
  }
  m_solver = std::make_unique<LevelSolver>(m_voxels->model.solid());
}

/// Makes the loads of directions that have been asked for.
void LiveResponses::take_asked(const FemTask& task, Progress* progress) {
  std::vector<std::vector<Handle>> handles;
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    handles = m_asked;
    m_has_asked = false;
  }
  const std::size_t before = m_found.size();
  if (handles.size() == before) return;
  if (before > 0) handles.erase(handles.begin() + 1, handles.begin() + std::ptrdiff_t(before));
  std::vector<NodalLoads> all = loads(handles, task, progress);
  for (std::size_t n = before > 0 ? 1 : 0; n < all.size(); ++n) {
    m_found.push_back(std::make_unique<Direction>());
    m_found.back()->loads = std::move(all[n]);
    m_solver->add(m_found.back()->loads);
  }
}

/// Solves this level of all directions that lack it; false where another one was asked for.
bool LiveResponses::solve_level(int number, const FemParams& params, Progress* progress) {
  const bool is_last = kLevels[number].iterations == 0;
  m_solver->prepare(params.doublings, progress);
  UntilAsked until_asked(*this, progress);
  for (std::size_t n = 0; n < m_found.size(); ++n) {
    Direction& direction = *m_found[n];
    if (direction.next_level != number || direction.solution) continue;
    try {
      direction.solution =
          m_solver->solve(n, params, !is_last, params.doublings > 0 ? progress : &until_asked);
    } catch (const Cancelled&) {
      poll(progress);
      return false;
    }
    if (is_last) direction.loads.u_mm = direction.solution->u_mm;
  }
  return true;
}

void LiveResponses::publish(int number) {
  const VoxelFemModel& model = m_voxels->model;
  parallel_for(m_found.size(), [&](std::size_t n) {
    Direction& of = *m_found[n];
    if (of.next_level != number || !of.solution) return;
    auto found = std::make_shared<LiveResponse>();
    found->doublings = kLevels[number].doublings;
    found->is_last = kLevels[number].iterations == 0;
    const std::vector<Vec3d> centres = model.centres_mm(of.solution->u_mm);
    found->pieces = m_fits.moments(centres);
    std::vector<float> values(3 * centres.size());
    for (std::size_t e = 0; e < centres.size(); ++e) {
      for (std::size_t a = 0; a < 3; ++a) values[3 * e + a] = float(centres[e][int(a)]);
    }
    for (std::size_t g = 0; g < m_is_handle.size(); ++g) {
      if (m_is_handle[g]) found->force_n += pull_n(of.loads, g, of.solution->residual_mn);
    }
    if (of.best) {
      found->change_mm =
          percentile(changes_between(values, *of.best->displacements, kSample, kMoved), kSampled);
    }
    found->displacements = std::make_shared<const std::vector<float>>(std::move(values));
    of.best = std::move(found);
    of.next_level = number + 1;
    if (kLevels[number].doublings > 0) of.loads.u_mm = std::move(of.solution->u_mm);
    if (!of.best->is_last) of.solution.reset();
  });
  auto level = std::make_shared<LiveLevel>();
  for (const std::unique_ptr<Direction>& of : m_found) {
    if (!of->best) break;
    level->of.push_back(of->best);
    level->field.add(of->best->displacements);
  }
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_best = std::move(level);
  ++m_ready;
}

/// Puts the solutions of the last level together for steps.
void LiveResponses::keep() {
  if (!m_kept) {
    m_kept = std::make_shared<FemResponses>();
    m_kept->voxels = m_voxels;
  }
  const Vec3d spacing = m_body.geometry.spacing_mm();
  const double rounding_mm = kRounding * std::min({spacing.x, spacing.y, spacing.z});
  for (const std::unique_ptr<Direction>& of : m_found) {
    if (!of->solution) continue;
    m_voxels->model.solid().keep(m_found.front()->loads, of->loads, std::move(*of->solution),
                                 m_step.params, rounding_mm, m_kept->known);
    of->solution.reset();
    of->loads.u_mm = {};
  }
  const std::lock_guard<std::mutex> lock(m_mutex);
  if (!m_has_asked) m_all = m_kept;
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
  if (!m_solver) make_solid(task, std::move(ahead), progress);
  const int deepest = int(m_voxels->model.solid().levels().meshes.size()) - 1;
  while (ready() < levels) {
    take_asked(task, progress);
    int number = kAllLevels;
    for (const std::unique_ptr<Direction>& of : m_found) {
      number = std::min(number, of->next_level);
    }
    if (number == kAllLevels) {
      keep();
      if (found()) return;
      continue;
    }
    const auto [doublings, iterations] = kLevels[number];
    if (doublings > deepest) {
      for (const std::unique_ptr<Direction>& of : m_found) {
        if (of->next_level == number) ++of->next_level;
      }
      continue;
    }
    FemParams params = m_step.params;
    params.doublings = doublings;
    if (doublings > 0) {
      params.tolerance = std::max(params.tolerance.value_or(kRough), kRough);
      params.reaction_tolerance = std::numeric_limits<double>::infinity();
      params.error_mm.reset();
    }
    if (iterations > 0) params.max_iterations = std::min(params.max_iterations, iterations);
    if (solve_level(number, params, progress)) publish(number);
  }
}

}  // namespace supple
