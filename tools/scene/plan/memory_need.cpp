#include "tools/scene/plan/memory_need.h"

#include <algorithm>
#include <cstdio>

#include "tools/scene/plan/planned_run.h"
#include "volumes/base/error.h"
#include "volumes/base/own_process.h"
#include "volumes/io/load/brick_sample.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

namespace {

constexpr int kMostSlabs = 8;
/// Of the bricks that slabs between those of a sample would have in its mean.
constexpr double kSureOfUnread = 0.5;
/// Slabs that a reader holds: two as they are stored, and one of floats.
constexpr double kStoredSlabs = 2, kFloatBytes = 4;

std::string gigabytes(double mb) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", mb / 1000);
  return text;
}

double needs(const PlanRow& row) {
  return row.held_mb + row.brief_mb;
}

/// "2.5 GB of memory, most of it for output (2.1 GB), and 1.2 GB are there".
std::string need_text(const ScenePlan& plan, double there_mb) {
  const auto largest =
      std::max_element(plan.rows.begin(), plan.rows.end(),
                       [](const PlanRow& a, const PlanRow& b) { return needs(a) < needs(b); });
  return gigabytes(plan.peak_mb) + " of memory, most of it for " + largest->stage + " (" +
         gigabytes(needs(*largest)) + "), and " + gigabytes(there_mb) + " are there";
}

/// A volume before it is read.
class UnreadVolume {
 public:
  UnreadVolume(const Scene& scene, std::unique_ptr<VolumeFile> file)
      : m_scene(scene), m_file(std::move(file)) {
    m_state.geometry = m_file->header().geometry;
  }

  /// The least that the run will need, with so many bricks of tissue.
  ScenePlan plan(double bricks) const {
    const VolumeHeader& header = m_file->header();
    const Vec3i& dims = header.geometry.dims();
    const double slab = double(dims.x) * dims.y * std::min(dims.z, kBrickDim);
    // The largest components may be any part of what was read.
    const bool is_kept = !m_scene.material || m_scene.material->components == 0;
    const ExpectedBricks expected{
        bricks, is_kept ? bricks : 0,
        slab * (kStoredSlabs * bytes_of(header.type) * header.components + kFloatBytes)};
    const double held_mb = rss_mb();
    return plan_scene(m_scene, {nullptr, m_state, 0, 0, held_mb, held_mb, expected}, {});
  }

  double most_bricks() const {
    const Vec3i& dims = m_state.geometry.dims();
    double bricks = 1;
    for (int a = 0; a < 3; ++a) bricks *= (dims[a] + kBrickDim - 1) / kBrickDim;
    return bricks;
  }

  BrickSample sample(double there_mb, Progress* progress) {
    std::optional<std::pair<double, double>> range;
    if (m_scene.material) range = {m_scene.material->active_lo, m_scene.material->active_hi};
    const auto is_enough = [&](const BrickSample& sample) {
      return plan(double(sample.bricks)).peak_mb > there_mb;
    };
    return sample_bricks(*m_file, range, kMostSlabs, is_enough, progress);
  }

 private:
  const Scene& m_scene;
  std::unique_ptr<VolumeFile> m_file;
  State m_state;
};

/// Whether the densities that are elements are known before the volume is.
bool has_known_range(const Scene& scene) {
  if (!scene.material) return true;
  return !scene.material->fits_domain && !scene.material->finds_foreground;
}

[[noreturn]] void refuse(const Scene& scene, const std::string& need) {
  throw SystemError(
      scene.volume_path + ": the run needs " + need +
      "; a box of the volume (supple crop), larger voxels (supple resample --grid) or "
      "less tissue (the material's active densities) need less");
}

}  // namespace

void require_memory_to_run(const Scene& scene, Progress* progress) {
  if (is_state_file(scene.volume_path)) return;
  UnreadVolume volume(scene, open_volume(scene.volume_path, scene.read));
  const double there_mb = rss_mb() + memory_left_mb();
  if (volume.plan(volume.most_bricks()).peak_mb <= there_mb) return;
  const ScenePlan least = volume.plan(0);
  if (least.peak_mb > there_mb) refuse(scene, "at least " + need_text(least, there_mb));
  if (!has_known_range(scene)) return;
  const BrickSample sample = volume.sample(there_mb, progress);
  const double read = double(sample.bricks), all = read / sample.part();
  if (volume.plan(read + kSureOfUnread * (all - read)).peak_mb <= there_mb) return;
  refuse(scene, "about " + need_text(volume.plan(all), there_mb) + " (by " +
                    std::to_string(sample.slabs_read * kBrickDim) + " of its slices)");
}

void require_memory_to_open(const Scene& scene, Progress* progress) {
  Scene opened = scene;
  opened.views.clear();
  opened.output = {};
  require_memory_to_run(opened, progress);
}

void require_memory(const Scene& scene, const SceneRun& run) {
  constexpr double kSmallPart = 0.01;
  const double held_mb = rss_mb(), there_mb = held_mb + memory_left_mb();
  if (held_mb < kSmallPart * there_mb) return;
  const ScenePlan plan = plan_of(scene, run);
  if (plan.peak_mb <= there_mb) return;
  std::string line = scene.volume_path + ": the run needs " + need_text(plan, there_mb);
  if (!scene.output.state.empty()) {
    Scene stateless = scene;
    stateless.output.state.clear();
    line += "; without a state (a scene of pictures, warps and volumes) it needs " +
            gigabytes(plan_of(stateless, run).peak_mb);
  }
  throw SystemError(line);
}

}  // namespace supple::tools
