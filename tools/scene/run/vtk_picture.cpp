#include "tools/scene/run/vtk_picture.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "tools/scene/peers/vtk_peer.h"
#include "volumes/base/parallel.h"
#include "volumes/field/dense/resample.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

/// The grid with its axes along those of the world, as VTK has them: a left-handed one is turned
/// round along k.
class VtkFrame {
 public:
  explicit VtkFrame(const Geometry& source)
      : m_origin(source.origin_lps_mm()),
        m_axes(source.direction()),
        m_dims(source.dims()),
        m_spacing(source.spacing_mm()),
        m_is_turned(source.determinant() < 0) {
    if (!m_is_turned) return;
    m_origin += m_axes[2] * (m_spacing.z * (m_dims.z - 1));
    m_axes[2] = m_axes[2] * -1.0;
  }

  Geometry geometry() const {
    return {m_dims, Vec3d(0), {Vec3d(m_spacing.x, 0, 0), {0, m_spacing.y, 0}, {0, 0, m_spacing.z}}};
  }
  int source_slice(int k) const { return m_is_turned ? m_dims.z - 1 - k : k; }
  Camera from_world(Camera camera) const {
    camera.position_lps_mm = turned(camera.position_lps_mm - m_origin);
    camera.target_lps_mm = turned(camera.target_lps_mm - m_origin);
    camera.up_lps = turned(camera.up_lps);
    return camera;
  }
  Light from_world(Light light) const {
    if (!light.is_of_camera) light.direction = turned(light.direction);
    return light;
  }

 private:
  Vec3d turned(const Vec3d& v) const {
    return {m_axes[0].dot(v), m_axes[1].dot(v), m_axes[2].dot(v)};
  }

  Vec3d m_origin;
  std::array<Vec3d, 3> m_axes;
  Vec3i m_dims;
  Vec3d m_spacing;
  bool m_is_turned;
};

/// VTK draws integers sooner than floats.
ValueType type_of(const DensityGrid& density) {
  using Limits = std::numeric_limits<std::int16_t>;
  std::atomic<bool> fits{true};
  parallel_for(density.bricks().brick_count(), [&](std::size_t b) {
    const float* const values = density.values(b);
    const bool all = std::all_of(values, values + kBrickVoxels, [](float value) {
      return value == std::rint(value) && value >= Limits::min() && value <= Limits::max();
    });
    if (!all) fits = false;
  });
  return fits ? ValueType::int16 : ValueType::float32;
}

ScalarSliceSource slices_of(const PosedVolume& subject) {
  if (subject.offsets != nullptr) {
    return dense_resampled(*subject.offsets, subject.density, subject.geometry,
                           subject.density.background());
  }
  return [&subject](int k, float* out) {
    const Vec3i& dims = subject.geometry.dims();
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        out[std::size_t(j) * dims.x + i] = subject.density.at({i, j, k});
      }
    });
  };
}

/// VTK's pixels are multiplied by their opacity.
FloatImage premultiplied(const Image& image) {
  FloatImage picture(image.width, image.height);
  std::transform(image.rgba.begin(), image.rgba.end(), picture.rgba.begin(),
                 [](std::uint8_t byte) { return float(byte) / 255; });
  return picture;
}

/// Draws on a display of its own; its start has been seen to fail on a busy machine.
void draw_in_window(const Value& job, const VtkPicture& picture, Progress& progress) {
  const VirtualDisplay display;
  VtkPeer vtk(display, &progress);
  vtk.open(job);
  vtk.draw(picture);
  vtk.finish();
}

}  // namespace

void check_vtk_view(const SceneView& view) {
  const auto refuse = [&](bool is_asked, const char* field, const char* beside) {
    if (is_asked) {
      throw InputError({view.place, field, std::string(beside) + " beside caster = \"vtk\"",
                        "caster = \"supple\", or a plain picture"});
    }
  };
  refuse(view.slice || view.lattice, "caster", "slices or a lattice");
  refuse(!view.inverse, "inverse", "samples that solve for themselves");
  refuse(view.half_offsets, "half_offsets", "half_offsets");
  refuse(!view.clips.empty(), "clip", "clips");
  refuse(!view.meshes.empty(), "mesh", "meshes");
  refuse(!view.marks.empty(), "marks", "labels, a grid, arrows or an overlay");
  refuse(view.outline, "outline", "an outline");
  refuse(view.fit == "visible", "fit", "what is visible");
  refuse(!view.picture.aux.empty() || picture_kind(view.image) == PictureKind::exr, "aux",
         "channels beside colours");
  refuse(view.picture.stereo != StereoMode::none, "stereo", "two eyes");
  refuse(view.sampling.interpolation != Interpolation::linear, "sampling", "cubic samples");
  refuse(view.sampling.classification != Classification::post, "classification",
         "pre-integrated colours");
  refuse(view.lighting.has_paths() || view.lighting.exposure_stops != 0, "shadows",
         "shadows, occlusion or exposure");
}

FloatImage draw_by_vtk(const PosedVolume& subject, const SceneView& view, Progress& progress) {
  const TransferFunction look = look_of(view);
  if (look.blend != Blend::composite || !look.gradient_opacity.empty()) {
    throw InputError({view.place, "caster", "vtk beside a maximum or opacities of gradients",
                      "a preset that composites by densities alone"});
  }
  if (!subject.geometry.is_orthogonal()) {
    throw InputError({view.place, "caster", "vtk and a sheared grid", "axes at right angles"});
  }
  progress.stage("starting VTK");
  if (!VtkPeer::is_installed()) {
    throw InputError({view.place, "caster", "vtk without its Python modules or Xvfb",
                      "python3-vtk9 and xvfb installed"});
  }
  progress.stage("rendering");
  const ScratchFolder folder;
  const VtkFrame frame(subject.geometry);
  const std::string volume = folder / "volume.mha", picture = folder / "picture.png";
  const ScalarSliceSource slices = slices_of(subject);
  write_volume(volume, frame.geometry(), type_of(subject.density),
               [&](int k, float* out) { slices(frame.source_slice(k), out); });
  RenderSettings settings = view_settings(view);
  for (Light& light : settings.lighting.lights) light = frame.from_world(light);
  const Value job = vtk_job(volume, frame.from_world(camera_of(subject, view)), look, settings,
                            thread_limit(), true);
  const Vec3d spacing = subject.geometry.spacing_mm();
  const double step_mm = settings.step_voxels * std::min({spacing.x, spacing.y, spacing.z});
  const VtkPicture asked = {step_mm, settings.lighting.model != ShadingModel::none, false, picture};
  try {
    draw_in_window(job, asked, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    draw_in_window(job, asked, progress);
  }
  return premultiplied(read_png(picture));
}

}  // namespace supple::tools
