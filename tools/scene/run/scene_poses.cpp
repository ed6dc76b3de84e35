// Poses of the tissue of a scene after its steps, as views and outputs ask for them: each pose is
// found once, and what nothing reads is not.
#include <algorithm>
#include <utility>

#include "tools/scene/run/drawn_view.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

/// Voxels of air around the densities above the minimum that a surface needs.
constexpr int kAirRings = 2;
/// Voxels beside a picture whose offsets may be read: those around the border of tissue come from
/// up to a brick away, gradients from the next cell. Slices read those of their own cells, and of
/// the next ones for det F.
constexpr double kBesidePicture = 2 * kBrickDim, kBesideSlice = 3;

/// Elements that lie beyond the outer voxel faces.
std::int64_t count_outside_box(const State& state, const Displacement& displacement) {
  const Vec3i& dims = state.geometry.dims();
  std::int64_t count = 0;
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    const std::int32_t same = displacement.u.topology.find(state.elements.origin(b));
    const Vec3f* const vectors = displacement.u.vectors.brick(std::size_t(same));
    if (vectors == nullptr) continue;  // at rest, and so inside
    for_each_active(state.elements.mask(b), [&](int offset) {
      const Vec3i voxel = state.elements.origin(b) + brick_local(offset);
      const Vec3f& u = vectors[offset];
      bool is_inside = true;
      for (int a = 0; a < 3; ++a) {
        const double place = double(voxel[a]) + u[a];
        is_inside = is_inside && place >= -0.5 && place <= dims[a] - 0.5;
      }
      count += !is_inside;
    });
  }
  return count;
}

/// Pictures, warps and volumes show the box of the source.
void warn_of_lost_sight(const State& state, const Displacement& displacement, Progress& progress) {
  const std::int64_t elements = state.elements.active_count();
  const std::int64_t outside = count_outside_box(state, displacement);
  if (2 * outside <= elements) return;
  progress.warn(std::to_string(outside) + " of " + with_count(elements, "element") +
                " lie outside of the volume's box, which pictures and warps show");
}

}  // namespace

/// The certificate stays, and of the state all but where its elements are.
void SceneRun::forget_pose() {
  take_deformed();
  m_seen.reset();
  m_state.q = {};
  m_state_step = m_displaced_step = m_inverted_step = m_seen_step = -1;
}

/// True if anything reads the displacement of a state that does not move once it is inverted.
bool SceneRun::reads_displacement_later() const {
  const bool is_flat = m_state.geometry.dims().z == 1;  // and drawn as a lattice
  return m_session || is_flat || !m_scene.path.empty() ||
         std::any_of(m_scene.views.begin(), m_scene.views.end(), reads_displacement);
}

void SceneRun::take_state(int step) {
  if (m_session && m_state_step != step) m_state = m_session->state();
  m_state_step = step;
}

/// State and displacement after the present step, computed once and only when something needs
/// them.
const Displacement& SceneRun::displacement(int step) {
  if (m_displaced_step != step) {
    m_progress.stage(kDisplacementStage);
    take_state(step);
    m_deformed.displacement = extended_displacement_of(m_state);
    warn_of_lost_sight(m_state, m_deformed.displacement, m_progress);
    if (!m_session) m_state.q = {};  // nothing else reads the offsets of its elements
    m_displaced_step = step;
  }
  return m_deformed.displacement;
}

bool reads_inverse(const Scene& scene) {
  const SceneOutput& output = scene.output;
  if (!(output.state.empty() && output.offsets.empty() && output.volumes.empty())) return true;
  return !output.displacements.empty() && !scene.path.empty();
}

std::function<bool(const Vec3i& origin)> seen_bricks(const Scene& scene, int step,
                                                     const Geometry& geometry) {
  if (scene.film || !scene.path.empty()) return {};
  const int last = int(scene.steps.size());
  if (step == last && reads_inverse(scene)) return {};
  struct Seen {
    ViewVolume volume;
    Vec3d beside;
  };
  std::vector<Seen> parts;
  for (const SceneView& view : scene.views) {
    if (view.after_step.value_or(last) != step || !view.deformed || !view.inverse) continue;
    const auto seen = seen_of(view, geometry);
    if (!seen) return {};
    const Vec3d beside(view.slice ? kBesideSlice : kBesidePicture);
    for (const ViewVolume& volume : *seen) parts.push_back({volume, beside});
  }
  return [parts, dims = geometry.dims()](const Vec3i& origin) {
    // Offsets beyond the outer voxels count, too, where rays begin.
    for (int a = 0; a < 3; ++a) {
      if (origin[a] < 0 || origin[a] + kBrickDim > dims[a]) return true;
    }
    return std::any_of(parts.begin(), parts.end(), [&](const Seen& seen) {
      return seen.volume.meets(Vec3d(origin) - seen.beside,
                               Vec3d(origin) + Vec3d(kBrickDim) + seen.beside);
    });
  };
}

/// Returns the pose with its inverse.
const Pose& SceneRun::deformed(int step) {
  displacement(step);
  if (m_inverted_step != step) {
    m_deformed.offsets = invert_displacement(m_state, m_deformed.displacement, &m_progress,
                                             seen_bricks(m_scene, step, m_state.geometry));
    m_inverted_step = step;
    m_has_inverted = true;
    if (!reads_displacement_later()) m_deformed.displacement.u = {};
  }
  return m_deformed;
}

/// Returns the pose as the scene's path shows it.
const Pose& SceneRun::seen(int step) {
  if (m_scene.path.empty()) return deformed(step);
  if (m_seen_step != step) {
    m_seen = send_along(m_scene.path, deformed(step), m_progress);
    m_seen_step = step;
  }
  return *m_seen;
}

/// The displacement for a view in which samples solve for themselves.
const Displacement& SceneRun::without_inverse(const SceneView& view, int step) {
  const Displacement& moved = displacement(step);
  if (has_open_cuts(m_state, moved)) {
    throw InputError({view.place, "inverse", "cuts that have opened", "a body without"});
  }
  return moved;
}

/// True if the view, seen along a path of its own, is all that a state is opened for.
bool SceneRun::is_all_that_reads(const SceneView& view) const {
  return !m_session && !m_scene.film && m_scene.views.size() == 1 && view.picture.sequence == 0;
}

/// Leaves the certificate.
Pose SceneRun::take_deformed() {
  Pose deformed = std::exchange(m_deformed, {});
  m_deformed.offsets.certificate = deformed.offsets.certificate;
  return deformed;
}

/// Pose that a view shows, with its inverse; null: the body at rest. The view gets the path of the
/// scene, too.
const Pose* SceneRun::posed_for(SceneView& view, int step) {
  const bool has_own = !view.path.empty();
  if (view.deformed) {
    view.path.insert(view.path.begin(), m_scene.path.begin(), m_scene.path.end());
    if (!has_own) return &seen(step);
    deformed(step);
    m_own = is_all_that_reads(view) ? send_along(view.path, take_deformed(), m_progress)
                                    : send_along(view.path, m_deformed, m_progress);
    return &*m_own;
  }
  take_state(step);
  if (!has_own) return nullptr;
  m_own = send_along(view.path, m_state.geometry, m_state.density.bricks(), m_progress);
  return &*m_own;
}

/// Pose of a volume that moves along the warp and the path; null: as it is.
const Pose* SceneRun::posed_volume_for(SceneView& view) {
  std::vector<OffsetFunction>& path = view.path;
  if (view.deformed) path.insert(path.begin(), m_scene.path.begin(), m_scene.path.end());
  const bool has_warp = m_has_warp && view.deformed;
  if (path.empty()) return has_warp ? &m_deformed : nullptr;
  if (has_warp) {
    m_own = Pose{{}, send_along(path, m_deformed.offsets, m_progress)};
  } else {
    const BrickTopology& bricks = m_state.density.bricks();
    // The air that pictures of the volume at rest read belongs to it, too.
    const BrickTopology body =
        view.slice ? bricks : dilate_inside(bricks, kAirRings, m_state.geometry.dims());
    m_own = send_along(path, m_state.geometry, body, m_progress);
  }
  return &*m_own;
}

/// The mesh bodies as they are now, of a session or of a state that nothing moves.
void SceneRun::add_meshes(SceneView& view) const {
  std::vector<DeformableMesh> of_state;
  if (!m_session) {
    for (const Value& record : m_state.meshes) of_state.emplace_back(record, m_scene.volume_path);
  }
  for (const DeformableMesh& mesh : m_session ? m_session->meshes() : of_state) {
    const MeshSetup& setup = mesh.setup();
    LineNetwork shape = mesh.shape();
    if (shape.mesh.triangles.empty() || setup.opacity == 0) continue;
    view.meshes.push_back({setup.place, setup.path,
                           std::make_shared<const TriangleMesh>(std::move(shape.mesh)), setup.rgb,
                           setup.opacity, false});
  }
}

SceneRun::Drawn SceneRun::drawn_after(int step, const SceneView& view) {
  SceneView asked = view;
  const OffsetField* offsets = nullptr;
  const Displacement* moved = nullptr;
  const bool solves = !m_is_volume && view.deformed && !view.inverse;
  if (solves) {
    moved = &without_inverse(view, step);
  } else if (const Pose* pose = m_is_volume ? posed_volume_for(asked) : posed_for(asked, step)) {
    offsets = &pose->offsets;
    if (!m_has_warp || !view.deformed) moved = &pose->displacement;
  }
  SceneView drawn = effective_view(asked, m_state.geometry, m_state.density.background());
  if (offsets != nullptr && !reads_displacement(drawn)) moved = nullptr;
  if (!drawn.slice && !drawn.lattice && m_state.geometry.dims().z > 1) add_meshes(drawn);
  const BrickTopology& elements = m_is_volume ? m_state.density.bricks() : m_state.elements;
  return {std::move(drawn),
          {m_state.geometry, m_state.density, elements, offsets, moved, m_grey_lo, m_grey_hi,
           m_is_volume ? kAirRings : 0, m_is_volume ? nullptr : &m_state.elements, &m_state.cuts,
           &m_state.labels}};
}

}  // namespace supple::tools
