#include "tools/scene/run/scene_poses.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "lib/material/material.h"
#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/space_marks.h"
#include "volumes/base/text.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/warp_file.h"

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

/// Throws InputError where a warp is asked for beside what moves by itself.
void require_no_warp(const Scene& scene, const std::string& found) {
  if (scene.warp_path.empty()) return;
  throw InputError({scene.file, "offsets", found, "a volume alone"});
}

/// The warp file as offsets of the volume; warns when none of them leads into it.
OffsetField read_offsets(const std::string& path, const Geometry& source, Progress& progress) {
  OffsetField offsets = offsets_from_warp(read_warp(path, &progress, &source), source, &progress);
  if (offsets.o.topology.empty()) {
    progress.warn(path + ": no vector leads into the volume, the picture is empty");
  }
  return offsets;
}

}  // namespace

ScenePoses::ScenePoses(const Scene& scene, Progress& progress)
    : m_scene(scene), m_progress(progress) {
  if (needs_body(m_scene)) {
    require_no_warp(m_scene, "a body that moves by itself");
    m_session =
        std::make_unique<Session>(m_scene.volume_path, session_options(m_scene), &m_progress);
    add_bodies(m_scene.bodies, *m_session);
    m_state.geometry = m_session->geometry();
    m_grey_lo = m_session->body().material.domain_lo;
    m_grey_hi = m_session->body().material.domain_hi;
  } else if (is_state_file(m_scene.volume_path)) {
    require_no_warp(m_scene, "a state, which has its own");
    require_unused(m_scene.read, m_scene.volume_path);
    m_state = read_state(m_scene.volume_path, &m_progress);
    const MaterialTable material = parse_material(m_state.material_toml, m_scene.volume_path);
    m_grey_lo = material.domain_lo;
    m_grey_hi = material.domain_hi;
  } else {
    open_volume_alone();
  }
}

void ScenePoses::open_volume_alone() {
  m_is_volume = true;
  for (const SceneView& view : m_scene.views) {
    if (view.inverse) continue;
    throw InputError({view.place, "inverse", "a volume that nothing moves", "a state or steps"});
  }
  const auto file = open_volume(m_scene.volume_path, m_scene.read, &m_progress);
  const Geometry& geometry = file->header().geometry;
  const bool is_slice = std::all_of(m_scene.views.begin(), m_scene.views.end(),
                                    [](const SceneView& view) { return view.slice.has_value(); });
  const bool is_lattice =
      !is_slice &&
      (geometry.dims().z == 1 || std::any_of(m_scene.views.begin(), m_scene.views.end(),
                                             [](const SceneView& view) { return view.lattice; }));
  if (is_lattice) require_no_warp(m_scene, "a lattice to draw");
  // The warp is read before the volume: its vectors are gone when the voxels come.
  m_has_warp = !m_scene.warp_path.empty();
  if (m_has_warp) m_deformed.offsets = read_offsets(m_scene.warp_path, geometry, m_progress);
  // A lattice shows every voxel; a picture leaves out the air at the file's minimum.
  const double everything = std::numeric_limits<double>::max();
  Volume volume = is_lattice
                      ? load_elements(*file, -everything, everything, 0, 0, &m_progress).volume
                      : load_volume(*file, &m_progress);
  const std::string void_values = void_values_text(volume.statistics);
  if (!void_values.empty()) {
    m_progress.warn(m_scene.volume_path + ": " + void_values + " treated as void");
  }
  m_grey_lo = volume.statistics.min;
  m_grey_hi = std::max(volume.statistics.max, volume.statistics.min + 1);
  m_state.geometry = volume.geometry;
  m_state.density = std::move(volume.density);
}

const InversionCertificate* ScenePoses::certificate() const {
  return m_has_inverted ? &m_deformed.offsets.certificate : nullptr;
}

/// Forgets the poses; all else of the state stays.
void ScenePoses::forget() {
  take_deformed();
  m_seen.reset();
  m_state.q = {};
  m_state_step = m_displaced_step = m_inverted_step = m_seen_step = -1;
}

/// True if anything reads the displacement of a state that does not move once it is inverted.
bool ScenePoses::reads_displacement_later() const {
  const bool is_flat = m_state.geometry.dims().z == 1;  // and drawn as a lattice
  return m_session || is_flat || !m_scene.path.empty() ||
         std::any_of(m_scene.views.begin(), m_scene.views.end(), reads_displacement);
}

void ScenePoses::take_state(int step) {
  if (m_session && m_state_step != step) m_state = m_session->state();
  m_state_step = step;
}

const Displacement& ScenePoses::displacement(int step) {
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

const Pose& ScenePoses::deformed(int step) {
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

const Pose& ScenePoses::seen(int step) {
  if (m_scene.path.empty()) return deformed(step);
  if (m_seen_step != step) {
    m_seen = send_along(m_scene.path, deformed(step), m_progress);
    m_seen_step = step;
  }
  return *m_seen;
}

const Pose& ScenePoses::moved(int step) {
  if (reads_inverse(m_scene)) return seen(step);
  displacement(step);
  return m_deformed;
}

/// The displacement for a view in which samples solve for themselves.
const Displacement& ScenePoses::without_inverse(const SceneView& view, int step) {
  const Displacement& moved = displacement(step);
  if (has_open_cuts(m_state, moved)) {
    throw InputError({view.place, "inverse", "cuts that have opened", "a body without"});
  }
  return moved;
}

/// True if the view, seen along a path of its own, is all that a state is opened for.
bool ScenePoses::is_all_that_reads(const SceneView& view) const {
  return !m_session && !m_scene.film && m_scene.views.size() == 1 && view.picture.sequence == 0;
}

/// Leaves the certificate.
Pose ScenePoses::take_deformed() {
  Pose deformed = std::exchange(m_deformed, {});
  m_deformed.offsets.certificate = deformed.offsets.certificate;
  return deformed;
}

/// Pose that a view shows, with its inverse; null: the body at rest. The view gets the path
/// of the scene, too.
const Pose* ScenePoses::posed_for(SceneView& view, int step, OwnPose& own) {
  const bool has_own = !view.path.empty();
  if (view.deformed) {
    view.path.insert(view.path.begin(), m_scene.path.begin(), m_scene.path.end());
    if (!has_own) return &seen(step);
    deformed(step);
    own = std::make_unique<const Pose>(is_all_that_reads(view)
                                           ? send_along(view.path, take_deformed(), m_progress)
                                           : send_along(view.path, m_deformed, m_progress));
    return own.get();
  }
  take_state(step);
  if (!has_own) return nullptr;
  own = std::make_unique<const Pose>(
      send_along(view.path, m_state.geometry, m_state.density.bricks(), m_progress));
  return own.get();
}

/// Pose of a volume that moves along the warp and the path; null: as it is.
const Pose* ScenePoses::posed_volume_for(SceneView& view, OwnPose& own) {
  std::vector<OffsetFunction>& path = view.path;
  if (view.deformed) path.insert(path.begin(), m_scene.path.begin(), m_scene.path.end());
  const bool has_warp = m_has_warp && view.deformed;
  if (path.empty()) return has_warp ? &m_deformed : nullptr;
  if (has_warp) {
    own = std::make_unique<const Pose>(Pose{{}, send_along(path, m_deformed.offsets, m_progress)});
  } else {
    const BrickTopology& bricks = m_state.density.bricks();
    // The air that pictures of the volume at rest read belongs to it, too.
    const BrickTopology body =
        view.slice ? bricks : dilate_inside(bricks, kAirRings, m_state.geometry.dims());
    own = std::make_unique<const Pose>(send_along(path, m_state.geometry, body, m_progress));
  }
  return own.get();
}

/// The mesh bodies as they are now, of a session or of a state that nothing moves.
void ScenePoses::add_meshes(SceneView& view) const {
  if (m_session) return add_mesh_bodies(m_session->meshes(), m_state.geometry, view);
  std::vector<DeformableMesh> of_state;
  for (const Value& record : m_state.meshes) of_state.emplace_back(record, m_scene.volume_path);
  add_mesh_bodies(of_state, m_state.geometry, view);
}

PosedView ScenePoses::drawn_after(int step, const SceneView& view) {
  SceneView asked = view;
  OwnPose own;
  const OffsetField* offsets = nullptr;
  const Displacement* moved = nullptr;
  const bool solves = !m_is_volume && view.deformed && !view.inverse;
  if (solves) {
    moved = &without_inverse(view, step);
  } else if (const Pose* pose =
                 m_is_volume ? posed_volume_for(asked, own) : posed_for(asked, step, own)) {
    offsets = &pose->offsets;
    if (!m_has_warp || !view.deformed) moved = &pose->displacement;
  }
  SceneView drawn = effective_view(asked, m_state.geometry, m_state.density.background());
  if (offsets != nullptr && !reads_displacement(drawn)) moved = nullptr;
  add_meshes(drawn);
  const BrickTopology& elements = m_is_volume ? m_state.density.bricks() : m_state.elements;
  return {std::move(drawn),
          {m_state.geometry, m_state.density, elements, offsets, moved, m_grey_lo, m_grey_hi,
           m_is_volume ? kAirRings : 0, m_is_volume ? nullptr : &m_state.elements, &m_state.cuts,
           &m_state.labels},
          std::move(own)};
}

}  // namespace supple::tools
