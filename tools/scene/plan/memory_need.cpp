#include "tools/scene/plan/memory_need.h"

#include <algorithm>
#include <cstdio>

#include "lib/state/state_source.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/plan_ledger.h"
#include "tools/scene/plan/scene_plan.h"
#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/brick_sample.h"

namespace supple::tools {

namespace {

constexpr int kMostSlabs = 8;
/// Part of the bricks that slabs between those of a sample would have by its mean.
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

/// Writes "2.5 GB of memory, most of it for output (2.1 GB), and 1.2 GB are there".
std::string need_text(const ScenePlan& plan, double there_mb) {
  const auto largest =
      std::max_element(plan.rows.begin(), plan.rows.end(),
                       [](const PlanRow& a, const PlanRow& b) { return needs(a) < needs(b); });
  return gigabytes(plan.peak_mb) + " of memory, most of it for " + largest->stage + " (" +
         gigabytes(needs(*largest)) + "), and " + gigabytes(there_mb) + " are there";
}

/// The scene with a state that refers to its volume, where it writes one that does not.
std::optional<Scene> referring(const Scene& scene) {
  if (scene.output.state.empty() || scene.output.refers) return std::nullopt;
  Scene other = scene;
  other.output.refers = true;
  return other;
}

std::string referring_text(const ScenePlan& plan) {
  return "; with a state that refers to its volume (--refer, or refer = true in a scene) it "
         "needs " +
         gigabytes(plan.peak_mb);
}

/// Tissue that becomes elements, as far as it is known before the volume is read.
struct Tissue {
  std::optional<std::pair<double, double>> range;
  int components = 0;
  bool is_known = true;  // whether the densities that are elements are
};

Tissue tissue_of(const Scene& scene) {
  if (!scene.material) return {};
  return {{{scene.material->active_lo, scene.material->active_hi}},
          scene.material->components,
          !scene.material->fits_domain && !scene.material->finds_foreground};
}

/// A volume before it is read.
class UnreadVolume {
 public:
  UnreadVolume(const Scene& scene, std::unique_ptr<VolumeFile> file, Tissue tissue)
      : m_scene(scene), m_file(std::move(file)), m_tissue(std::move(tissue)) {
    m_state.geometry = m_file->header().geometry;
  }

  /// The least that the run will need, with so many bricks of tissue.
  ScenePlan plan(double bricks) const { return plan(m_scene, bricks); }
  ScenePlan plan(const Scene& scene, double bricks) const {
    const VolumeHeader& header = m_file->header();
    const Vec3i& dims = header.geometry.dims();
    const double slab = double(dims.x) * dims.y * std::min(dims.z, kBrickDim);
    // The largest components may be any part of what was read.
    const ExpectedBricks expected{
        bricks, m_tissue.components == 0 ? bricks : 0,
        slab * (kStoredSlabs * bytes_of(header.type) * header.components + kFloatBytes)};
    const double held_mb = rss_mb();
    return plan_scene(scene, {nullptr, m_state, 0, 0, held_mb, held_mb, expected}, {});
  }

  double most_bricks() const {
    const Vec3i& dims = m_state.geometry.dims();
    double bricks = 1;
    for (int a = 0; a < 3; ++a) bricks *= (dims[a] + kBrickDim - 1) / kBrickDim;
    return bricks;
  }

  BrickSample sample(double there_mb, Progress* progress) {
    const auto is_enough = [&](const BrickSample& sample) {
      return plan(double(sample.bricks)).peak_mb > there_mb;
    };
    return sample_bricks(*m_file, m_tissue.range, kMostSlabs, is_enough, progress);
  }
  bool has_known_range() const { return m_tissue.is_known; }

 private:
  const Scene& m_scene;
  std::unique_ptr<VolumeFile> m_file;
  Tissue m_tissue;
  State m_state;
};

/// The volume that a run will read; null where it reads none, or one that it will refuse.
std::unique_ptr<UnreadVolume> unread_volume(const Scene& scene) {
  if (!is_state_file(scene.volume_path)) {
    return std::make_unique<UnreadVolume>(scene, open_volume(scene.volume_path, scene.read),
                                          tissue_of(scene));
  }
  const auto source = source_of_state_file(scene.volume_path);
  if (source == nullptr) return nullptr;
  try {
    return std::make_unique<UnreadVolume>(
        scene, open_volume(source->path, source->read),
        Tissue{{{source->lo, source->hi}}, source->components, true});
  } catch (const InputError&) {
    return nullptr;
  }
}

/// Ends the run of so many bricks, of which `how` says how they are known.
[[noreturn]] void refuse(const Scene& scene, const UnreadVolume& volume, double bricks,
                         double there_mb, const std::string& about, const std::string& how) {
  const auto other = referring(scene);
  throw SystemError(
      scene.volume_path + ": the run needs " + about + " " +
      need_text(volume.plan(bricks), there_mb) + how +
      (other ? referring_text(volume.plan(*other, bricks)) : "") +
      "; a box of the volume (supple crop), larger voxels (supple resample --grid) or "
      "less tissue (the material's active densities) need less");
}

}  // namespace

void require_memory_to_run(const Scene& scene, Progress* progress) {
  const auto unread = unread_volume(scene);
  if (unread == nullptr) return;
  UnreadVolume& volume = *unread;
  const double there_mb = rss_mb() + memory_left_mb();
  if (volume.plan(volume.most_bricks()).peak_mb <= there_mb) return;
  if (volume.plan(0).peak_mb > there_mb) refuse(scene, volume, 0, there_mb, "at least", "");
  if (!volume.has_known_range()) return;
  const BrickSample sample = volume.sample(there_mb, progress);
  const double read = double(sample.bricks), all = read / sample.part();
  if (volume.plan(read + kSureOfUnread * (all - read)).peak_mb <= there_mb) return;
  refuse(scene, volume, all, there_mb, "about",
         " (by " + std::to_string(sample.slabs_read * kBrickDim) + " of its slices)");
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
    if (const auto other = referring(scene)) line += referring_text(plan_of(*other, run));
    Scene stateless = scene;
    stateless.output.state.clear();
    line += "; without a state (a scene of pictures, warps and volumes) it needs " +
            gigabytes(plan_of(stateless, run).peak_mb);
  }
  throw SystemError(line);
}

void require_memory(const std::string& path, std::int64_t bytes, const std::string& work,
                    const std::string& ways_out) {
  const double needed_mb = double(bytes) / kMegabyte, there_mb = memory_left_mb();
  if (needed_mb <= there_mb) return;
  throw SystemError(path + ": " + work + " needs " + gigabytes(needed_mb) + " of memory, and " +
                    gigabytes(there_mb) + " are there; " + ways_out);
}

}  // namespace supple::tools
